// Inputs of a bake: computes their digests, sends files that the server lacks, resumes interrupted uploads.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "clients/cli/remote/server.h"
#include "core/request/request.h"

namespace hairbake {

/// Files by their paths. Values of the form "name:..." or "sha256:..." stay as they are.
class InputFiles {
public:
    /// Adds a file.
    /// Throws Error(usage) for a folder or a pattern: the service takes single files.
    void add(const std::string& value, const std::string& field);
    void add(const BakeRequest& request);

    /// Computes all digests, asks which files the server lacks, and sends those. Reports the phases "digest" and
    /// "upload".
    /// Throws Error(bad_input) for a file that cannot be read or changes meanwhile.
    /// Throws RemoteError.
    void send(Server& server);

    /// "sha256:..." of an added file after send(); names and digests as they are.
    std::string reference(const std::string& value) const;
    /// `request` with references instead of paths.
    BakeRequest referenced(BakeRequest request) const;
    /// `text` with the files' paths in place of their references, for messages.
    std::string with_paths(std::string text) const;

    std::uint64_t sent_bytes() const { return sent_bytes_; }
    std::size_t sent_files() const { return sent_files_; }

private:
    struct File {
        std::string digest, field;
        std::uint64_t bytes = 0;
    };

    std::map<std::string, File> files_;
    std::uint64_t sent_bytes_ = 0;
    std::size_t sent_files_ = 0;
};

/// Sends one file by tus 1.0 and returns the number of sent bytes. Resumes an upload that an earlier process left
/// unfinished (its id is kept in ~/.cache/hairbake/uploads, or below XDG_CACHE_HOME). Calls `progress` with the number
/// of bytes that the server has.
std::uint64_t send_file(Server& server, const std::string& path, const std::string& digest, std::uint64_t bytes,
                        const std::function<void(std::uint64_t)>& progress);

}  // namespace hairbake
