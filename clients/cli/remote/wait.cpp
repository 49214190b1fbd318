#include "clients/cli/remote/wait.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace hairbake {
namespace {

using Json = Server::Json;
constexpr double first_poll_s = 0.1, longest_poll_s = 2;

bool has_ended(const std::string& state) { return state == "done" || state == "failed" || state == "cancelled"; }

EndedBake ended(const Json& view) {
    EndedBake bake{id_in(view, "id"), view.at("state").get<std::string>(), "", ""};
    if (view.contains("error") && view["error"].is_object()) {
        bake.message = plain(view["error"].value("message", ""));
        bake.field = plain(view["error"].value("field", ""));
    }
    return bake;
}

/// Polls one address. The server does not send an unchanged answer again.
class Poll {
public:
    Poll(Server& server, std::string path) : server_(server), path_(std::move(path)) {}

    const Json& look() {
        HttpCall call;
        call.path = path_;
        if (!tag_.empty()) call.headers.push_back("If-None-Match: " + tag_);
        const HttpAnswer answer = server_.ask(call);
        if (answer.status == 304) return view_;
        if (answer.status != 200) refuse(answer);
        view_ = parse_json(answer.body);
        tag_ = answer.header("etag");
        return view_;
    }

private:
    Server& server_;
    const std::string path_;
    std::string tag_;
    Json view_;
};

/// Pauses between rounds of polling, longer each time.
class Rhythm {
public:
    explicit Rhythm(Progress& progress) : progress_(progress) {}
    void pause_now() {
        pause(pause_s_, progress_);
        pause_s_ = std::min(1.3 * pause_s_, longest_poll_s);
    }

private:
    Progress& progress_;
    double pause_s_ = first_poll_s;
};

template <class Take>
void list_batch(Server& server, const std::string& batch, const std::string& state, Take&& take) {
    std::string path = "/v1/bakes?limit=1000&batch=" + batch;
    if (!state.empty()) path += "&state=" + state;
    std::string cursor;
    do {
        const Json page = server.json("GET", cursor.empty() ? path : path + "&cursor=" + cursor);
        for (const Json& view : page.at("bakes")) take(view);
        cursor = page.at("next").is_null() ? "" : id_in(page, "next");
    } while (!cursor.empty());
}

}  // namespace

std::vector<EndedBake> wait_for_bakes(Server& server, const std::vector<std::string>& ids) {
    std::vector<EndedBake> all(ids.size());
    std::vector<Poll> polls;
    polls.reserve(ids.size());
    for (const std::string& id : ids) polls.emplace_back(server, "/v1/bakes/" + id);
    server.progress().enter("bake");
    for (Rhythm rhythm(server.progress());; rhythm.pause_now()) {
        double fraction = 0;
        std::size_t ready = 0;
        for (std::size_t i = 0; i < ids.size(); ++i) {
            if (all[i].id.empty()) {
                const Json& view = polls[i].look();
                if (has_ended(view.at("state").get<std::string>()))
                    all[i] = ended(view);
                else
                    fraction += std::clamp(view.value("fraction", 0.0), 0.0, 1.0);
            }
            if (!all[i].id.empty()) ++ready;
        }
        server.progress().report((fraction + static_cast<double>(ready)) / static_cast<double>(ids.size()));
        if (ready == ids.size()) return all;
    }
}

std::vector<EndedBake> wait_for_batch(Server& server, const std::string& batch) {
    Poll poll(server, "/v1/batches/" + batch);
    server.progress().enter("bake");
    for (Rhythm rhythm(server.progress());; rhythm.pause_now()) {
        const Json& view = poll.look();
        const auto total = view.at("bakes").get<double>();
        const Json& states = view.at("states");
        const double live = states.at("queued").get<double>() + states.at("running").get<double>();
        server.progress().report(total > 0 ? std::clamp(1 - live / total, 0.0, 1.0) : 1);
        if (live <= 0) break;
    }
    std::vector<EndedBake> all;
    list_batch(server, batch, "", [&](const Json& view) { all.push_back(ended(view)); });
    return all;
}

std::vector<std::string> bakes_of_batch(Server& server, const std::string& batch, const std::string& state) {
    std::vector<std::string> ids;
    list_batch(server, batch, state, [&](const Json& view) { ids.push_back(id_in(view, "id")); });
    return ids;
}

}  // namespace hairbake
