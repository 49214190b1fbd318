// Inputs of a bake: digested here, sent when the server lacks them, resumed where an earlier attempt stopped.
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

/// Files by their paths. Values that are "name:..." or "sha256:..." already are left alone.
class InputFiles {
public:
    /// Throws Error(usage) for a folder or a pattern: the service takes single files.
    void add(const std::string& value, const std::string& field);
    void add(const BakeRequest& request);

    /// Digests all files, asks which the server lacks, and sends those. Reports the stages "digest" and "upload".
    /// Throws Error(bad_input) for a file that cannot be read or changes meanwhile, RemoteError.
    void send(Server& server);

    /// "sha256:..." of an added file after send(); names and digests as they are.
    std::string reference(const std::string& value) const;
    /// `request` with references instead of paths.
    BakeRequest referenced(BakeRequest request) const;
    /// `text` with the files' paths instead of their references, for people.
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

/// Sends one file by tus 1.0 and returns how many bytes went over the wire. An upload that an earlier process left
/// unfinished goes on where it stopped (its id is kept in ~/.cache/hairbake/uploads, or below XDG_CACHE_HOME).
/// `progress` is told how many bytes the server has.
std::uint64_t send_file(Server& server, const std::string& path, const std::string& digest, std::uint64_t bytes,
                        const std::function<void(std::uint64_t)>& progress);

}  // namespace hairbake
