// What the daemon asks a worker to do, and what the worker says. Both are files of the work folder.
//
// task.json: one JSON object.
//   {"task": "bake", "stages": ["transmittance"], "request": {..., paths of files}, "threads": 2, "names": {path:
//   "sha256:..."}}
//       runs these stages of the request; writes the folder result: the stages' files and manifest.json
//   {"task": "inspect", "kind": "model" | "environment", "file": path, "threads": 1, "names": {...}}
//       reads the file; writes thumbnail.png
//   {"task": "trial", "threads": 1}
//       bakes a small sample of its own (trial.h): tells whether this machine can bake at all
// words.jsonl: JSON lines.
//   {"begin": {}}                                     the first word: from now on the task's files may be at fault
//   {"phase": "transmittance", "fraction": 0.25}      progress, any number of these
//   {"done": {...}}                                   the last word: the facts of inspect; {} for bake;
//                                                     versions_text() as "versions" for trial
//   {"error": {"kind": "bad_input", "message": "...", "field": "", "machine": false}}   the last word of a failure
// "machine" is true when the machine is at fault and not the input: a call of the system failed, as on a full disk.
// In messages every path of `names` is replaced by the name that the client knows, and the work folder by "the work
// folder", with its result by "the result's file ".
#pragma once

#include <filesystem>
#include <string>

#include "core/base/progress.h"

namespace hairbake {

/// Does what the task `text` (JSON) says and writes the result to `folder`; returns the object of "done".
/// Throws Error.
std::string run_task(const std::string& text, const std::filesystem::path& folder, BakeProgress& progress);

/// `message` with the paths of the `names` of the task `text`, and `folder`, replaced.
std::string with_names(std::string message, const std::string& text, const std::filesystem::path& folder);

}  // namespace hairbake
