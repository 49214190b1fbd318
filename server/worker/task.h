// What the daemon asks a worker to do, and what the worker says.
//
// Standard input: one JSON object.
//   {"task": "bake", "request": {..., paths of files}, "folder": "...", "threads": 2, "names": {path: "sha256:..."}}
//       runs the request's one stage and writes `folder`/result: its files and manifest.json
//   {"task": "inspect", "kind": "model" | "environment", "file": path, "folder": "...", "threads": 1, "names": {...}}
//       reads the file; writes `folder`/thumbnail.png
// Standard output: JSON lines.
//   {"phase": "transmittance", "fraction": 0.25}      any number of these
//   {"done": {...}}                                   the last word: facts of inspect, {} of bake
//   {"error": {"kind": "bad_input", "message": "...", "field": ""}}   the last word of a failure
// In messages every path of `names` is replaced by the name that the client knows.
#pragma once

#include <string>

#include "core/base/progress.h"

namespace hairbake {

/// Does what the task `text` (JSON) says; returns the object of "done". Throws Error.
std::string run_task(const std::string& text, BakeProgress& progress);

/// `message` with the paths of the `names` of the task `text` replaced.
std::string with_names(std::string message, const std::string& text);

}  // namespace hairbake
