#include "clients/cli/remote/result_manifest.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "clients/cli/remote/server.h"

namespace hairbake {
namespace {

constexpr std::size_t most_files = 4096, longest_name = 200;
constexpr std::uint64_t longest_file = std::uint64_t(1) << 40;

[[noreturn]] void distrust(const std::string& what) {
    throw RemoteError(ExitCode::refused, "the server's manifest cannot be trusted: " + plain(what));
}

bool is_plain_name(const std::string& name) {
    const auto fits = [](unsigned char c) { return std::isalnum(c) || c == '.' || c == '_' || c == '-'; };
    return !name.empty() && name.size() <= longest_name && name[0] != '.' && name != "manifest.json" &&
           std::all_of(name.begin(), name.end(), fits);
}

bool is_digest(const std::string& text) {
    return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

}  // namespace

std::vector<ListedFile> listed_files(const std::string& manifest) {
    const Server::Json json = parse_json(manifest);
    if (!json.is_object() || !json.contains("files") || !json["files"].is_array()) distrust("it lists no files");
    if (json["files"].size() > most_files) distrust("it lists more than 4096 files");
    std::vector<ListedFile> files;
    std::set<std::string> names;
    for (const Server::Json& entry : json["files"]) {
        const ListedFile file{entry.at("name").get<std::string>(), entry.at("sha256").get<std::string>(),
                              entry.at("bytes").get<std::uint64_t>()};
        if (!is_plain_name(file.name)) distrust("a file is called \"" + file.name + "\"");
        if (!names.insert(file.name).second) distrust(file.name + " is listed twice");
        if (!is_digest(file.digest)) distrust("the digest of " + file.name + " is \"" + file.digest + "\"");
        if (file.bytes > longest_file) distrust(file.name + " has " + std::to_string(file.bytes) + " bytes");
        files.push_back(file);
    }
    return files;
}

}  // namespace hairbake
