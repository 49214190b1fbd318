#include "clients/cli/remote/fetch.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>

#include "clients/cli/remote/result_manifest.h"
#include "clients/cli/remote/result_warnings.h"
#include "core/bake.h"
#include "core/base/digest.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

/// ".NAME.hairbake-fetch" beside the result folder, for one process at a time.
class PartFolder {
public:
    explicit PartFolder(const fs::path& folder) {
        fs::path result = fs::weakly_canonical(fs::absolute(folder)).lexically_normal();
        if (!result.has_filename()) result = result.parent_path();
        path_ = result.parent_path() / std::string(".").append(result.filename().string()).append(".hairbake-fetch");
        fs::create_directories(path_);
        descriptor_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
        if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), path_.string());
        if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
        ::close(descriptor_);
        throw Error(ErrorKind::usage, "another hairbake is fetching into " + folder.string(), "out");
    }
    ~PartFolder() {
        std::error_code ignored;
        fs::remove(path_, ignored);  // when it is empty
        ::close(descriptor_);
    }
    PartFolder(const PartFolder&) = delete;
    PartFolder& operator=(const PartFolder&) = delete;

    fs::path file(const std::string& digest) const { return path_ / digest; }
    const fs::path& path() const { return path_; }

private:
    fs::path path_;
    int descriptor_;
};

using Stream = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

void write_all(std::FILE* stream, std::span<const std::byte> bytes, const fs::path& file) {
    if (std::fwrite(bytes.data(), 1, bytes.size(), stream) != bytes.size())
        throw std::system_error(errno, std::generic_category(), file.string());
}

/// Size of the file; 0 when there is no plain file.
std::uint64_t size_of(const fs::path& file) {
    std::error_code error;
    if (!fs::is_regular_file(fs::symlink_status(file, error))) return 0;
    const std::uint64_t bytes = fs::file_size(file, error);
    return error ? 0 : bytes;
}

bool holds(const fs::path& file, const ListedFile& listed) {
    std::error_code error;
    return fs::is_regular_file(fs::symlink_status(file, error)) && size_of(file) == listed.bytes &&
           digest_of_file(file) == listed.digest;
}

/// The fetch of one bake's files.
class Fetch {
public:
    Fetch(Server& server, const std::string& id, const fs::path& folder)
        : server_(server), address_("/v1/bakes/" + id + "/files/"), folder_(folder), parts_(folder) {}

    Fetched run() {
        const std::string manifest = fetch_manifest();
        const std::vector<ListedFile> files = listed_files(manifest);
        for (const ListedFile& file : files) result_.bytes += file.bytes;
        check_room();
        server_.progress().enter("fetch");
        for (const ListedFile& file : files) {
            fetch_file(file);
            done_ += file.bytes;
            report(0);
        }
        move_in(manifest, files);
        result_.files = files.size() + 1;
        result_.warnings = warnings_in(manifest);
        result_.bytes += manifest.size();
        result_.received += manifest.size();
        return result_;
    }

private:
    std::string fetch_manifest() {
        HttpCall call;
        call.path = address_ + "manifest.json";
        const HttpAnswer answer = server_.ask(call);
        if (answer.status != 200) refuse(answer);
        if (answer.header("etag") != std::string("\"").append(Digest().add(answer.body).hex()).append("\""))
            throw RemoteError(ExitCode::refused,
                              "the received manifest does not have the digest that the server states");
        return answer.body;
    }

    void check_room() {
        std::error_code error;
        const fs::space_info space = fs::space(parts_.path(), error);
        if (error || space.available >= result_.bytes) return;
        throw Error(ErrorKind::out_of_resources, folder_.string() + ": the result needs " +
                                                     std::to_string(result_.bytes) + " bytes; there is room for " +
                                                     std::to_string(space.available));
    }

    void report(std::uint64_t here) {
        server_.progress().check();
        const double total = static_cast<double>(result_.bytes);
        server_.progress().report(total > 0 ? static_cast<double>(done_ + here) / total : 1);
    }

    void fetch_file(const ListedFile& file) {
        const fs::path part = parts_.file(file.digest);
        if (holds(part, file)) return;
        if (std::error_code error; holds(folder_ / file.name, file)) {
            fs::copy_file(folder_ / file.name, part, fs::copy_options::overwrite_existing, error);
            if (!error) return;
        }
        const bool resumed = size_of(part) > 0;
        fill(part, file);
        if (holds(part, file)) return;
        std::error_code ignored;
        fs::remove(part, ignored);
        if (resumed) return fetch_file(file);  // the part from an earlier fetch may have been wrong
        throw RemoteError(ExitCode::refused, "the received " + file.name + " does not have the digest " + file.digest +
                                                 " of the manifest");
    }

    /// Receives until the part is as long as listed.
    void fill(const fs::path& part, const ListedFile& file) {
        std::error_code ignored;
        if (!fs::is_regular_file(fs::symlink_status(part, ignored)) || size_of(part) > file.bytes)
            fs::remove_all(part, ignored);
        const Stream stream(std::fopen(part.c_str(), "ab"), std::fclose);
        if (!stream) throw std::system_error(errno, std::generic_category(), part.string());
        Patience patience = server_.patience();
        for (std::uint64_t have = size_of(part); have < file.bytes;) {
            const std::uint64_t before = have;
            try {
                receive(stream.get(), part, file, have);
                if (have < file.bytes) throw ConnectionLost(server_.url() + ": " + file.name + " ended early");
            } catch (const ConnectionLost& lost) {
                if (have > before) patience.renew();
                patience.wait(lost);
            }
        }
        if (std::fflush(stream.get()) != 0) throw std::system_error(errno, std::generic_category(), part.string());
    }

    /// Receives one answer; `have` grows with the written bytes.
    void receive(std::FILE* stream, const fs::path& part, const ListedFile& file, std::uint64_t& have) {
        bool begun = false;
        HttpCall call;
        call.path = address_ + file.name;
        if (have > 0)
            call.headers = {"Range: bytes=" + std::to_string(have) + "-", "If-Range: \"" + file.digest + "\""};
        call.most_bytes = std::max<std::uint64_t>(file.bytes, 64 << 10);  // a refusal has a body too
        call.sink = [&](const HttpAnswer& head, std::span<const std::byte> bytes) {
            if (!begun) begin(stream, part, head, have);
            begun = true;
            if (bytes.size() > file.bytes - have)
                throw RemoteError(ExitCode::refused, file.name + " is longer than its manifest says");
            write_all(stream, bytes, part);
            have += bytes.size();
            result_.received += bytes.size();
            report(have);
        };
        const HttpAnswer answer = server_.once(call);
        if (answer.status == 416) return restart(stream, part, have);
        if (answer.status != 200 && answer.status != 206) refuse(answer);
    }

    /// Whether the answer begins where the part ends. A whole answer replaces the part.
    void begin(std::FILE* stream, const fs::path& part, const HttpAnswer& head, std::uint64_t& have) {
        if (head.status != 206) return restart(stream, part, have);
        const std::string expected = "bytes " + std::to_string(have) + "-";
        if (!head.header("content-range").starts_with(expected))
            throw RemoteError(ExitCode::refused, "the server sends another range than the requested one");
    }

    static void restart(std::FILE* stream, const fs::path& part, std::uint64_t& have) {
        std::fflush(stream);
        if (::ftruncate(::fileno(stream), 0) != 0)  // it is open for appending
            throw std::system_error(errno, std::generic_category(), part.string());
        have = 0;
    }

    /// Puts the complete folder in place.
    void move_in(const std::string& manifest, const std::vector<ListedFile>& files) {
        ResultFolder result(folder_);
        for (const ListedFile& file : files) {
            std::error_code error;
            fs::create_hard_link(parts_.file(file.digest), result.path() / file.name, error);
            if (error) fs::copy_file(parts_.file(file.digest), result.path() / file.name);
        }
        const fs::path path = result.path() / "manifest.json";
        const Stream stream(std::fopen(path.c_str(), "wb"), std::fclose);
        if (!stream) throw std::system_error(errno, std::generic_category(), path.string());
        write_all(stream.get(), std::as_bytes(std::span(manifest)), path);
        if (std::fflush(stream.get()) != 0) throw std::system_error(errno, std::generic_category(), path.string());
        result.commit();
        std::error_code ignored;
        fs::remove_all(parts_.path(), ignored);
    }

    Server& server_;
    const std::string address_;
    const fs::path folder_;
    const PartFolder parts_;
    Fetched result_;
    std::uint64_t done_ = 0;  ///< bytes of whole files
};

}  // namespace

Fetched fetch_result(Server& server, const std::string& id, const fs::path& folder) {
    check_result_folder(folder);
    return Fetch(server, id, folder).run();
}

}  // namespace hairbake
