#include "server/jobs/page.h"

#include <nlohmann/json.hpp>
#include <utility>

namespace hairbake {

Page::Page(std::string_view name, int most) : text_("{\"" + std::string(name) + "\":["), most_(most) {}

bool Page::has_room() {
    has_next_ = count_ >= most_ || text_.size() >= longest;
    return !has_next_;
}

void Page::add(std::string_view json, std::string cursor) {
    if (count_++ > 0) text_ += ',';
    text_ += json;
    cursor_ = std::move(cursor);
}

std::string Page::take_text() {
    text_ += "],\"next\":" + (has_next_ ? nlohmann::json(cursor_).dump() : "null") + "}";
    return std::move(text_);
}

}  // namespace hairbake
