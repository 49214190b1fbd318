// The reply to a request for a list: one page of entries, and the cursor of the next page.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace hairbake {

/// `{"<name>": [entry, ..], "next": cursor or null}`. It holds text alone: the values of 1,000 entries would take
/// several times as much memory, in each of many threads. Not thread-safe.
class Page {
public:
    /// A page that has so many bytes ends, also if it has fewer entries than the client allows.
    static constexpr std::size_t longest = 512 << 10;

    /// `most`: entries, at least 1.
    Page(std::string_view name, int most);

    /// Whether add() takes one more entry. When it does not, the page gets the cursor of its last entry as `next`: call
    /// it for each entry that there is.
    bool has_room();

    /// `json` is the entry as text. `cursor` leads to the entries behind it.
    void add(std::string_view json, std::string cursor);

    /// The whole reply. The page is empty afterwards.
    std::string take_text();

private:
    std::string text_;
    std::string cursor_;  ///< of the last entry
    const int most_;
    int count_ = 0;
    bool has_next_ = false;
};

}  // namespace hairbake
