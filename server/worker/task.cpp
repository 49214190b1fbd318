#include "server/worker/task.h"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/bake.h"
#include "core/base/parallel.h"
#include "core/request/request_json.h"
#include "core/tools/inspect.h"
#include "server/worker/thumbnail.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

void bake_stage(const Json& task, BakeProgress& progress) {
    BakeRequest request;
    merge_json(request, task.at("request").dump(), "the stage's request");
    BakeResult result = bake(request, task.at("threads").get<int>(), progress);
    write_result(result, fs::path(task.at("folder").get<std::string>()) / "result", progress);
}

Json inspect_input(const Json& task, Progress& progress) {
    const fs::path file = task.at("file").get<std::string>(), folder = task.at("folder").get<std::string>();
    const std::string kind = task.at("kind").get<std::string>();
    Json facts = Json::parse(inspect(file, progress));
    facts.erase("path");
    const std::string expected = kind == "model" ? "hair model" : "environment map";
    if (facts.at("kind") != expected)
        throw Error(ErrorKind::bad_input, file.string() + " is of the kind \"" + facts.at("kind").get<std::string>() +
                                              "\"; allowed is a " + expected);
    if (kind == "model")
        write_model_thumbnail(file, folder / "thumbnail.png");
    else
        write_environment_thumbnail(file, folder / "thumbnail.png", progress);
    return facts;
}

}  // namespace

std::string run_task(const std::string& text, BakeProgress& progress) {
    const Json task = Json::parse(text);
    if (task.at("task") == "bake") {
        bake_stage(task, progress);
        return "{}";
    }
    if (task.at("task") != "inspect") throw Error(ErrorKind::internal, "unknown task " + task.at("task").dump());
    Json facts;
    with_threads(task.at("threads").get<int>(), [&] { facts = inspect_input(task, progress); });
    return facts.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string with_names(std::string message, const std::string& text) {
    const Json task = Json::parse(text, nullptr, false);
    if (!task.is_object() || !task.contains("names")) return message;
    for (const auto& [path, name] : task["names"].items())
        for (std::size_t at = 0; (at = message.find(path, at)) != std::string::npos;) {
            const std::string words = name.get<std::string>();
            message.replace(at, path.size(), words);
            at += words.size();
        }
    return message;
}

}  // namespace hairbake
