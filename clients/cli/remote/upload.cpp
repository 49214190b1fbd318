#include "clients/cli/remote/upload.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <set>
#include <system_error>

#include "clients/cli/remote/upload_memory.h"
#include "core/base/digest.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

bool is_reference(const std::string& value) { return value.starts_with("name:") || value.starts_with("sha256:"); }

bool is_stored(Server& server, const std::string& digest) {
    const HttpAnswer answer = server.ask({.method = "HEAD", .path = "/v1/blobs/" + digest});
    if (answer.status == 404) return false;
    if (answer.status != 200) refuse(answer);
    return true;
}

std::string base64(const std::string& text) {
    constexpr char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string result;
    for (std::size_t i = 0; i < text.size(); i += 3) {
        const std::size_t here = std::min<std::size_t>(3, text.size() - i);
        unsigned bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (k < here ? static_cast<unsigned char>(text[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) result += k <= here ? letters[bits >> (18 - 6 * k) & 63] : '=';
    }
    return result;
}

std::optional<std::uint64_t> number(const std::string& text) {
    std::uint64_t value = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (problem != std::errc() || end != text.data() + text.size()) return {};
    return value;
}

/// One upload of one file.
class TusUpload {
public:
    TusUpload(Server& server, const std::string& path, const std::string& digest, std::uint64_t bytes)
        : server_(server), path_(path), digest_(digest), bytes_(bytes), memory_(server.url(), digest) {}

    std::uint64_t run(const std::function<void(std::uint64_t)>& progress) {
        Patience patience = server_.patience();
        std::uint64_t furthest = 0;
        std::string id = memory_.recall();
        for (int begun = 0;;) try {
                if (id.empty()) {
                    if (++begun > 3)
                        throw RemoteError(ExitCode::refused, "the server loses the upload of " + path_ + " each time");
                    id = create();
                    memory_.keep(id);
                }
                const std::optional<std::uint64_t> offset = offset_of(id);
                if (offset && *offset > furthest) {
                    furthest = *offset;
                    patience.renew();
                }
                if (offset && append(id, *offset, progress)) break;
                id.clear();  // the upload is gone: it is complete, or it has expired
                memory_.forget();
                if (is_stored(server_, digest_)) break;
            } catch (const ConnectionLost& lost) {
                patience.wait(lost);
            }
        memory_.forget();
        return sent_;
    }

private:
    HttpAnswer call(const std::string& method, const std::string& path, std::vector<std::string> headers) {
        headers.emplace_back("Tus-Resumable: 1.0.0");
        return server_.once({.method = method, .path = path, .headers = std::move(headers)});
    }

    std::string create() {
        const HttpAnswer answer =
            call("POST", "/v1/uploads",
                 {"Upload-Length: " + std::to_string(bytes_), "Upload-Metadata: sha256 " + base64(digest_)});
        if (answer.status != 201) refuse(answer);
        const std::string location = answer.header("location");
        std::string id = location.substr(location.rfind('/') + 1);
        if (!is_id(id)) throw RemoteError(ExitCode::refused, "the server gives no valid address for the upload");
        return id;
    }

    /// The offset, or nothing if there is no such upload.
    std::optional<std::uint64_t> offset_of(const std::string& id) {
        const HttpAnswer answer = call("HEAD", "/v1/uploads/" + id, {});
        if (answer.status == 404 || answer.status == 410) return {};
        if (answer.status != 200) refuse(answer);
        const auto offset = number(answer.header("upload-offset"));
        if (!offset || *offset > bytes_)
            throw RemoteError(ExitCode::refused, "the server states a wrong offset for the upload of " + path_);
        return offset;
    }

    /// Sends the rest of the file. False if the upload is gone.
    bool append(const std::string& id, std::uint64_t offset, const std::function<void(std::uint64_t)>& progress) {
        const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path_.c_str(), "rb"), std::fclose);
        if (!file || ::fseeko(file.get(), static_cast<off_t>(offset), SEEK_SET) != 0)
            throw Error(ErrorKind::bad_input, path_ + ": " + std::generic_category().message(errno));
        std::uint64_t position = offset;
        HttpCall call;
        call.method = "PATCH";
        call.path = "/v1/uploads/" + id;
        call.headers = {"Tus-Resumable: 1.0.0", "Content-Type: application/offset+octet-stream",
                        "Upload-Offset: " + std::to_string(offset)};
        call.source_bytes = bytes_ - offset;
        call.source = [&](std::span<std::byte> room) {
            const std::size_t wanted = std::min<std::uint64_t>(room.size(), bytes_ - position);
            const std::size_t count = std::fread(room.data(), 1, wanted, file.get());
            if (count < wanted) throw Error(ErrorKind::bad_input, path_ + ": became shorter while it was sent");
            position += count;
            sent_ += count;
            progress(position);
            return count;
        };
        const HttpAnswer answer = server_.once(call);
        if (answer.status == 404 || answer.status == 410) return false;
        // Another process sends the same file, or the server has not yet closed the lost connection.
        if (answer.status == 409)
            throw ConnectionLost(server_.url() + ": another request is writing the upload of " + path_);
        if (answer.status != 204) refuse(answer);
        return true;
    }

    Server& server_;
    const std::string path_, digest_;
    const std::uint64_t bytes_;
    const UploadMemory memory_;
    std::uint64_t sent_ = 0;
};

}  // namespace

std::uint64_t send_file(Server& server, const std::string& path, const std::string& digest, std::uint64_t bytes,
                        const std::function<void(std::uint64_t)>& progress) {
    return TusUpload(server, path, digest, bytes).run(progress);
}

void InputFiles::add(const std::string& value, const std::string& field) {
    if (is_reference(value)) return;
    std::error_code error;
    const bool folder = fs::is_directory(value, error);
    if (field == "environment" && (folder || value.find("{face}") != std::string::npos))
        throw Error(ErrorKind::usage,
                    field + " is " + value +
                        ", a cube of six files; the service takes one file: a cross, a strip or a " +
                        "lat-long picture",
                    field);
    if (folder) throw Error(ErrorKind::usage, field + " is " + value + ", a folder; allowed is a file", field);
    const std::uint64_t bytes = fs::file_size(value, error);
    if (error) throw Error(ErrorKind::bad_input, value + ": " + error.message(), field);
    files_[value] = {"", field, bytes};
}

void InputFiles::add(const BakeRequest& request) {
    if (request.hair) add(*request.hair, "hair");
    if (request.environment) add(*request.environment, "environment");
    if (request.occluder) add(*request.occluder, "occluder");
    if (request.receiver) add(*request.receiver, "receiver");
}

void InputFiles::send(Server& server) {
    double total = 0, done = 0;
    for (const auto& [path, file] : files_) total += static_cast<double>(file.bytes);
    const auto report = [&](double bytes) {
        server.progress().check();
        server.progress().report(total > 0 ? std::min(1.0, bytes / total) : 1);
    };
    server.progress().enter("digest");
    for (auto& [path, file] : files_) {
        report(done);
        file.digest = digest_of_file(path);
        done += static_cast<double>(file.bytes);
    }
    report(done);
    done = 0;
    server.progress().enter("upload");
    std::set<std::string> there;
    for (const auto& [path, file] : files_) {
        if (there.insert(file.digest).second && !is_stored(server, file.digest)) {
            sent_bytes_ += send_file(server, path, file.digest, file.bytes,
                                     [&](std::uint64_t bytes) { report(done + static_cast<double>(bytes)); });
            ++sent_files_;
        }
        done += static_cast<double>(file.bytes);
        report(done);
    }
}

std::string InputFiles::reference(const std::string& value) const {
    const auto file = files_.find(value);
    return file == files_.end() ? value : "sha256:" + file->second.digest;
}

BakeRequest InputFiles::referenced(BakeRequest request) const {
    for (std::optional<std::string>* value :
         {&request.hair, &request.environment, &request.occluder, &request.receiver})
        if (*value) *value = reference(**value);
    return request;
}

std::string InputFiles::with_paths(std::string text) const {
    for (const auto& [path, file] : files_) {
        const std::string reference = "sha256:" + file.digest;
        for (std::size_t at = 0; (at = text.find(reference, at)) != std::string::npos; at += path.size())
            text.replace(at, reference.size(), path);
    }
    return text;
}

}  // namespace hairbake
