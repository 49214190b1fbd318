#include "server/http/json_bodies.h"

#include <fcntl.h>
#include <malloc.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>

#include "server/http/body_schema.h"
#include "server/jobs/service.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t most_in_memory = 64 << 10;
constexpr std::size_t times_small = 2, times_large = 5;  // memory of a body while it is parsed, in its bytes

Descriptor nameless_file(const fs::path& folder) {
    const fs::path file = folder / random_name();
    Descriptor descriptor(::open(file.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
    if (!descriptor) throw_store_error(file, errno);
    ::unlink(file.c_str());
    return descriptor;
}

/// A body that arrives.
class ArrivingBody {
public:
    explicit ArrivingBody(const fs::path& folder) : folder_(folder) {}

    void add(std::span<const std::byte> bytes) {
        bytes_ += bytes.size();
        head_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        if (bytes_ <= most_in_memory) return;
        if (!file_) file_ = nameless_file(folder_);
        write_all(file_.get(), std::as_bytes(std::span(head_)), folder_);
        head_.clear();
    }

    std::size_t bytes() const { return bytes_; }

    /// Call it once.
    std::string take_text() {
        if (!file_) return std::move(head_);
        std::string text(bytes_, '\0');
        for (std::size_t done = 0; done < bytes_;) {
            const ssize_t count = ::pread(file_.get(), text.data() + done, bytes_ - done, static_cast<off_t>(done));
            if (count < 0 && errno == EINTR) continue;
            if (count <= 0) throw_store_error(folder_, count < 0 ? errno : EIO);
            done += static_cast<std::size_t>(count);
        }
        return text;
    }

private:
    const fs::path& folder_;
    std::size_t bytes_ = 0;
    std::string head_;  ///< the whole body, while there is no file
    Descriptor file_;
};

}  // namespace

JsonBody::~JsonBody() {
    if (!large || text.empty()) return;  // small, or moved from
    std::string().swap(text);
    ::malloc_trim(0);  // else each arena of the allocator keeps what its largest body needed
}

JsonBody JsonBodies::read(const HttpRequest& request, const std::string& schema) {
    ArrivingBody arriving(folder_);
    request.read_body([&](std::span<const std::byte> bytes) { arriving.add(bytes); });
    const bool is_large = arriving.bytes() > most_in_memory;
    JsonBody body(is_large ? large_.take(times_large * arriving.bytes()) : small_.take(times_small * arriving.bytes()),
                  is_large);
    body.text = arriving.take_text();
    check_json(body.text, schema);
    return body;
}

}  // namespace hairbake
