#include "server/jobs/worker_words.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <nlohmann/json.hpp>

#include "core/base/error_kind_names.h"
#include "core/base/json_nesting.h"
#include "core/base/short_text.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::size_t longest_line = 1 << 20, piece_bytes = 64 << 10, longest_text = 4000, longest_facts = 64 << 10;
constexpr std::uint64_t most_bytes = 64 << 20;
constexpr int pieces_at_once = 64;

/// "" when the member is missing or no text. A longer text is cut: it goes into the database and many replies.
std::string text(const Json& object, const char* name) {
    const auto found = object.find(name);
    if (found == object.end() || !found->is_string()) return {};
    const auto& whole = found->get_ref<const std::string&>();
    return shortened(whole, longest_text);
}

}  // namespace

WorkerWords::WorkerWords(std::filesystem::path file, OnProgress on_progress)
    : file_(std::move(file)), on_progress_(std::move(on_progress)) {}

bool WorkerWords::read_more() {
    if (is_babbling_) return false;
    trouble_ = 0;
    if (!descriptor_) {
        OpenedFile opened = open_file(file_, O_RDONLY);
        trouble_ = opened.file ? 0 : opened.error != 0 ? opened.error : EINVAL;  // EINVAL: it is no file
        descriptor_ = std::move(opened.file);
    }
    if (!descriptor_) return false;
    std::string piece(piece_bytes, '\0');
    for (int i = 0; i < pieces_at_once; ++i) {
        const ssize_t count = ::read(descriptor_.get(), piece.data(), piece.size());
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) trouble_ = errno;
        if (count <= 0) return false;
        total_ += static_cast<std::uint64_t>(count);
        pending_.append(piece, 0, static_cast<std::size_t>(count));
        std::size_t begin = 0;
        for (std::size_t end = 0; (end = pending_.find('\n', begin)) != std::string::npos; begin = end + 1)
            read_line(pending_.substr(begin, end - begin));
        pending_.erase(0, begin);
        is_babbling_ = pending_.size() >= longest_line || total_ > most_bytes;
        if (is_babbling_) return false;
    }
    return true;
}

void WorkerWords::read_line(const std::string& line) {
    if (nested_deeper_than(line, deepest_json)) return;
    const Json words = Json::parse(line, nullptr, false);
    if (!words.is_object()) return;
    has_begun_ = has_begun_ || words.contains("begin") || words.contains("phase") || words.contains("done");
    if (words.contains("phase")) {
        const auto fraction = words.find("fraction");
        on_progress_(text(words, "phase"),
                     fraction != words.end() && fraction->is_number() ? fraction->get<double>() : 0);
    } else if (words.contains("done")) {
        std::string facts = words["done"].dump();
        if (facts.size() > longest_facts) return;
        last_word_ = LastWord();
        last_word_->facts = std::move(facts);
    } else if (words.contains("error") && words["error"].is_object()) {
        const Json& error = words["error"];
        last_word_ = LastWord{.error = find_in(error_kind_names, text(error, "kind")).value_or(ErrorKind::internal),
                              .is_trouble = error.value("machine", Json()) == true,
                              .message = text(error, "message"),
                              .field = text(error, "field")};
    }
}

}  // namespace hairbake
