// Receiving JSON bodies within bounds of memory.
#pragma once

#include <filesystem>
#include <string>

#include "server/http/body_budget.h"
#include "server/http/message.h"

namespace hairbake {

/// A body that has passed the check of its schema. Its share of the memory is given back when it is destroyed: keep it
/// until all values that were parsed from it are gone.
struct JsonBody {
    JsonBody(BodyBudget::Share part, bool is_large) : share(std::move(part)), large(is_large) {}
    JsonBody(JsonBody&&) = default;
    ~JsonBody();

    BodyBudget::Share share;
    bool large;
    std::string text;
};

/// Thread-safe. While a body arrives, its first 64 KiB are in memory and a longer body is in a file, so that slow
/// clients hold no memory. While a body is parsed, it has a share of a budget of 32 MB in all, and others wait: bodies
/// of up to 64 KiB share a quarter of it, so that they do not wait for larger ones.
class JsonBodies {
public:
    /// `folder` takes the files of bodies that are under way. They have no names.
    explicit JsonBodies(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// The request's body, checked by the schema of that name in components.schemas. The router has limited its length.
    /// Throws Refusal as check_json().
    /// Throws Error(out_of_resources) when the disk takes no more of a long body.
    JsonBody read(const HttpRequest& request, const std::string& schema);

private:
    const std::filesystem::path folder_;
    BodyBudget small_{8 << 20}, large_{24 << 20};
};

}  // namespace hairbake
