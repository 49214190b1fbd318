#include "core/base/digest.h"

#include <openssl/evp.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <system_error>
#include <vector>

#include "core/base/error.h"

namespace hairbake {

struct Digest::State {
    std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context{EVP_MD_CTX_new(), EVP_MD_CTX_free};
};

namespace {
void expect(int ok) {
    if (ok != 1) throw Error(ErrorKind::internal, "SHA-256 is not available in this OpenSSL");
}

// Looked up once, because each look-up searches the providers under a lock, which costs more than the digest of a short
// text. Never freed, because OpenSSL may unload before our statics are destroyed.
const EVP_MD* sha256() {
    static const EVP_MD* const type = EVP_MD_fetch(nullptr, "SHA256", nullptr);
    return type;
}
}  // namespace

Digest::Digest() : state_(std::make_unique<State>()) {
    if (!state_->context) throw Error(ErrorKind::out_of_resources, "no memory for a SHA-256 context");
    expect(sha256() && EVP_DigestInit_ex(state_->context.get(), sha256(), nullptr));
}
Digest::~Digest() = default;
Digest::Digest(Digest&&) noexcept = default;
Digest& Digest::operator=(Digest&&) noexcept = default;

Digest& Digest::add(std::span<const std::byte> bytes) {
    expect(EVP_DigestUpdate(state_->context.get(), bytes.data(), bytes.size()));
    return *this;
}

Digest& Digest::add(std::string_view text) { return add(std::as_bytes(std::span(text))); }

std::string Digest::hex() {
    std::array<unsigned char, 32> value{};
    expect(EVP_DigestFinal_ex(state_->context.get(), value.data(), nullptr));
    std::string text;
    text.reserve(2 * value.size());
    for (const unsigned char byte : value) {
        constexpr char digits[] = "0123456789abcdef";
        text += digits[byte >> 4];
        text += digits[byte & 15];
    }
    return text;
}

std::string digest_of_file(const std::filesystem::path& file) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), std::fclose);
    const auto fail = [&](const std::string& what, int error) {
        throw Error(ErrorKind::bad_input, file.string() + ": " + what + std::generic_category().message(error), {},
                    error);
    };
    if (!stream) fail("", errno);
    Digest digest;
    std::vector<std::byte> buffer(1 << 20);
    while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), stream.get()))
        digest.add(std::span(buffer.data(), n));
    if (std::ferror(stream.get())) fail("could not be read to its end: ", errno != 0 ? errno : EIO);
    return digest.hex();
}

}  // namespace hairbake
