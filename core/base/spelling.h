// Finds the word that a person may have meant.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hairbake {

/// The one of `candidates` that differs from `word` in the fewest letters (inserted, left out, replaced, or two
/// swapped), the first of several; empty where all differ in more than a third of the word's letters (dashes at the
/// beginning do not count), and in more than one.
std::string closest_word(std::string_view word, const std::vector<std::string>& candidates);

/// " (did you mean X?)", or empty where no candidate is close.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace hairbake
