#include "core/base/spelling.h"

#include <algorithm>

namespace hairbake {
namespace {

/// Restricted edit distance (optimal string alignment).
std::size_t distance(std::string_view a, std::string_view b) {
    std::vector<std::vector<std::size_t>> cost(a.size() + 1, std::vector<std::size_t>(b.size() + 1, 0));
    for (std::size_t i = 0; i <= a.size(); ++i) cost[i][0] = i;
    for (std::size_t j = 0; j <= b.size(); ++j) cost[0][j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i)
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = cost[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            cost[i][j] = std::min({replaced, cost[i - 1][j] + 1, cost[i][j - 1] + 1});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
        }
    return cost[a.size()][b.size()];
}

}  // namespace

std::string closest_word(std::string_view word, const std::vector<std::string>& candidates) {
    constexpr std::size_t longest = 200;  // a longer word is no slip of the fingers
    std::string best;
    const auto letters = static_cast<std::size_t>(word.size() - std::min(word.find_first_not_of('-'), word.size()));
    std::size_t least = std::max<std::size_t>(1, letters / 3) + 1;
    if (word.empty() || word.size() > longest) return {};
    for (const std::string& candidate : candidates)
        if (const std::size_t d = distance(word, candidate); d < least) {
            best = candidate;
            least = d;
        }
    return best;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates) {
    const std::string best = closest_word(word, candidates);
    return best.empty() ? "" : " (did you mean " + best + "?)";
}

}  // namespace hairbake
