// The request's fields for people: unit, allowed values and default of each.
#pragma once

#include <string>
#include <vector>

namespace hairbake {

struct FieldFacts {
    std::string path;                ///< "transmittance.directions"
    std::string unit;                ///< "degrees"; empty for none
    std::string allowed;             ///< "1 to 4096", "one of exact, sh"
    std::string standard;            ///< the default: "100", "auto", "none"
    std::string description;         ///< a sentence or two
    std::vector<std::string> words;  ///< that are allowed: names, or true and false; of a list, those of its items
    bool is_list = false;
};

/// All fields, in the order of to_json(), as the request's schema states them.
std::vector<FieldFacts> field_facts();

/// The facts of the field of this path, which exists.
FieldFacts facts_of_field(const std::string& path);

/// "1 to 4096 (directions); default 100".
std::string range_text(const FieldFacts& facts);

}  // namespace hairbake
