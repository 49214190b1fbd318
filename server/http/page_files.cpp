#include "server/http/page_files.h"

#include <fstream>
#include <iterator>

#include "core/base/digest.h"
#include "core/base/error.h"
#include "server/http/problem.h"
#include "server/http/replies.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

const std::string index_name = "index.html", mark = "{assets}";

/// The media type of a page's file; empty for other files, which are not served.
std::string page_type(const std::string& ending) {
    static const std::map<std::string, std::string> types{{".html", "text/html; charset=utf-8"},
                                                          {".css", "text/css; charset=utf-8"},
                                                          {".js", "text/javascript; charset=utf-8"},
                                                          {".svg", "image/svg+xml"},
                                                          {".png", "image/png"}};
    const auto found = types.find(ending);
    return found == types.end() ? "" : found->second;
}

std::string read_file(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (!stream) throw Error(ErrorKind::usage, "web.folder: " + file.string() + " cannot be read", "web.folder");
    return text;
}

/// Scripts and styles only from this server, none inline; pictures also from the browser's memory. No other page may
/// frame this one, and no referrer is sent.
HttpReply secured(HttpReply reply) {
    return reply
        .with(
            "Content-Security-Policy",
            "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; "
            "worker-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'")
        .with("Cross-Origin-Opener-Policy", "same-origin")
        .with("Cross-Origin-Resource-Policy", "same-origin")
        .with("Permissions-Policy", "camera=(), geolocation=(), microphone=()")
        .with("Referrer-Policy", "no-referrer")
        .with("X-Frame-Options", "DENY");
}

HttpReply absent() { return problem(404, "not-found", "there is nothing at this address"); }

}  // namespace

PageFiles::PageFiles(const fs::path& folder) {
    if (folder.empty()) return;
    if (!fs::exists(folder / index_name))
        throw Error(ErrorKind::usage, "web.folder is " + folder.string() + ", which has no index.html", "web.folder");
    Digest all;
    std::map<std::string, fs::path> paths;  // sorted, so that the digest does not depend on the file system
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) paths[entry.path().lexically_relative(folder).generic_string()] = entry.path();
    for (const auto& [name, path] : paths) {
        const std::string type = page_type(path.extension().string());
        if (type.empty()) continue;
        std::string text = read_file(path);
        std::string digest = Digest().add(text).hex();
        all.add(name + "\n" + digest + "\n");
        files_[name] = {type, std::move(text), std::move(digest)};
    }
    version_ = all.hex().substr(0, 16);
    File& index = files_.at(index_name);
    std::string& text = index.text;
    for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos;)
        text.replace(at, mark.size(), "/assets/" + version_);
    index.digest = Digest().add(text).hex();
}

const PageFiles::File* PageFiles::find(const std::string& path) const {
    const auto found = files_.find(path);
    return found == files_.end() ? nullptr : &found->second;
}

HttpReply PageFiles::index(const HttpRequest& request) const {
    const File* file = find(index_name);
    if (!file) return absent();
    return secured(text_reply(request, file->text, file->digest, file->type).with("Cache-Control", "no-cache"));
}

HttpReply PageFiles::asset(const HttpRequest& request) const {
    const File* file = request.parameters.at("version") == version_ ? find(request.parameters.at("path")) : nullptr;
    if (!file || file->type.starts_with("text/html")) return absent();
    return secured(text_reply(request, file->text, file->digest, file->type)
                       .with("Cache-Control", "public, max-age=31536000, immutable"));
}

}  // namespace hairbake
