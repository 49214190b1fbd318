#include "clients/cli/remote/result_warnings.h"

#include <nlohmann/json.hpp>

#include "clients/cli/messages.h"

namespace hairbake {

std::vector<std::string> warnings_in(const std::string& manifest) {
    constexpr std::size_t most = 100;
    const Server::Json json = Server::Json::parse(manifest, nullptr, false);
    std::vector<std::string> warnings;
    if (!json.is_object() || !json.contains("warnings") || !json["warnings"].is_array()) return warnings;
    for (const Server::Json& warning : json["warnings"])
        if (warning.is_string() && warnings.size() < most) warnings.push_back(plain(warning.get<std::string>()));
    return warnings;
}

std::vector<std::string> warnings_of_bake(Server& server, const std::string& id) {
    HttpCall call;
    call.path = "/v1/bakes/" + id + "/files/manifest.json";
    const HttpAnswer answer = server.ask(call);
    return answer.status == 200 ? warnings_in(answer.body) : std::vector<std::string>();
}

void say_bake_warnings(const std::string& id, const std::vector<std::string>& warnings) {
    for (const std::string& warning : warnings) say_warning(id.empty() ? warning : "bake " + id + ": " + warning);
}

}  // namespace hairbake
