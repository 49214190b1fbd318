// What a worker says: reads the file words.jsonl while it grows. server/worker/task.h describes the words.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "server/store/file_system.h"

namespace hairbake {

/// A worker's last word.
struct LastWord {
    std::optional<ErrorKind> error;        ///< nothing: the worker was successful
    bool is_trouble = false;               ///< the machine is at fault, and not the input
    std::string facts = "{}";              ///< JSON: the facts of an inspection
    std::string message = {}, field = {};  ///< of the error
};

/// For one thread. A worker is not believed: lines that are no JSON, unknown words and values of the wrong type are
/// ignored, and the memory used does not grow with what the worker writes.
class WorkerWords {
public:
    using OnProgress = std::function<void(std::string_view phase, double fraction)>;

    /// `file` need not exist yet.
    WorkerWords(std::filesystem::path file, OnProgress on_progress);

    /// Reads what was written since the last call, at most 4 MiB. Returns whether there may be more to read now.
    bool read_more();

    /// The latest last word so far.
    const std::optional<LastWord>& last_word() const { return last_word_; }

    /// Whether the worker has said anything: it reached its task.
    bool has_begun() const { return has_begun_; }

    /// The system's error number of the last attempt to read more, or 0.
    int trouble() const { return trouble_; }

    /// Whether the worker wrote a line of more than 1 MiB or more than 64 MiB in all. Then nothing more is read.
    bool is_babbling() const { return is_babbling_; }

private:
    void read_line(const std::string& line);

    const std::filesystem::path file_;
    const OnProgress on_progress_;
    Descriptor descriptor_;
    std::string pending_;  ///< the beginning of a line
    std::uint64_t total_ = 0;
    bool has_begun_ = false, is_babbling_ = false;
    int trouble_ = 0;
    std::optional<LastWord> last_word_;
};

}  // namespace hairbake
