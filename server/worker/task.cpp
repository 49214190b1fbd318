#include "server/worker/task.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/bake.h"
#include "core/base/parallel.h"
#include "core/request/request_json.h"
#include "core/request/stages.h"
#include "core/tools/inspect.h"
#include "server/worker/thumbnail.h"
#include "server/worker/trial.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

std::vector<const Stage*> stages_in(const Json& task) {
    std::vector<const Stage*> found;
    for (const Json& name : task.at("stages")) {
        found.push_back(find_stage(name.get<std::string>()));
        if (!found.back()) throw Error(ErrorKind::internal, "this worker has no stage " + name.dump());
    }
    return found;
}

void bake_stages(const Json& task, const fs::path& folder, BakeProgress& progress) {
    BakeRequest request;
    merge_json(request, task.at("request").dump(), "the stage's request");
    const BakeOptions options{.threads = task.at("threads").get<int>()};
    BakeResult result = bake(request, stages_in(task), options, progress);
    write_result(result, folder / "result", progress);
}

Json inspect_input(const Json& task, const fs::path& folder, Progress& progress) {
    const fs::path file = task.at("file").get<std::string>();
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

std::string run_task(const std::string& text, const fs::path& folder, BakeProgress& progress) {
    const Json task = Json::parse(text);
    if (task.at("task") == "bake") {
        bake_stages(task, folder, progress);
        return "{}";
    }
    if (task.at("task") == "trial") {
        run_trial(folder, task.at("threads").get<int>(), progress);
        return Json{{"versions", versions_text()}}.dump();
    }
    if (task.at("task") != "inspect") throw Error(ErrorKind::internal, "unknown task " + task.at("task").dump());
    Json facts;
    with_threads(task.at("threads").get<int>(), [&] { facts = inspect_input(task, folder, progress); });
    return facts.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string with_names(std::string message, const std::string& text, const fs::path& folder) {
    const Json task = Json::parse(text, nullptr, false);
    Json names = task.is_object() ? task.value("names", Json::object()) : Json::object();
    names[(folder / "result").string() + "/"] = "the result's file ";  // before the folder, which it contains
    names[folder.string()] = "the work folder";
    for (const auto& [path, name] : names.items())
        for (std::size_t at = 0; (at = message.find(path, at)) != std::string::npos;) {
            const std::string words = name.get<std::string>();
            message.replace(at, path.size(), words);
            at += words.size();
        }
    return message;
}

}  // namespace hairbake
