// The folder of one task: how the daemon and a worker exchange files.
//
//   task.json     written by the daemon: what to do
//   words.jsonl   written by the worker: progress and its last word, one JSON object a line
//   result/, thumbnail.png   written by the worker: the result
// server/worker/task.h describes their contents.
#pragma once

#include <filesystem>
#include <string>

namespace hairbake {

/// Removes the folder in its destructor unless leave() was called.
class WorkFolder {
public:
    /// Makes a new folder of a random name in `parent`, with task.json in it. Reserves disk space for the worker's
    /// words, so that a worker can say that the disk is full.
    /// Throws Error(out_of_resources) when the disk takes no more.
    WorkFolder(const std::filesystem::path& parent, const std::string& task_json);

    /// The existing folder `path`, of an earlier daemon's task.
    explicit WorkFolder(std::filesystem::path path);

    ~WorkFolder();
    WorkFolder(const WorkFolder&) = delete;
    WorkFolder& operator=(const WorkFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path words() const { return path_ / "words.jsonl"; }

    /// The folder stays: its worker goes on without this daemon.
    void leave() { is_left_ = true; }

private:
    std::filesystem::path path_;
    bool is_left_ = false;
};

}  // namespace hairbake
