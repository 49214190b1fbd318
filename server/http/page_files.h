// The files of the web page, read once at the start: no path of a request reaches the file system.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "server/http/message.h"

namespace hairbake {

class PageFiles {
public:
    /// Reads all .html, .css, .js, .svg and .png files of the folder that clients/web/stage.mjs makes. An empty path
    /// means no page. In index.html, "{assets}" becomes the address of the other files, which holds their digest.
    /// Throws Error(usage) when there is no index.html.
    explicit PageFiles(const std::filesystem::path& folder);

    /// index.html, with Cache-Control: no-cache; 404 when there is no page.
    HttpReply index(const HttpRequest& request) const;

    /// A file under /assets/{version}/{path...}, with Cache-Control: immutable; 404 for another version.
    HttpReply asset(const HttpRequest& request) const;

private:
    struct File {
        std::string type, text, digest;
    };
    const File* find(const std::string& path) const;

    std::map<std::string, File> files_;  ///< by path in the folder
    std::string version_;
};

}  // namespace hairbake
