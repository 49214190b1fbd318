#include "clients/cli/remote/outcome.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

#include "clients/cli/messages.h"
#include "clients/cli/output.h"
#include "clients/cli/remote/fetch.h"
#include "clients/cli/remote/result_warnings.h"

namespace hairbake {
namespace {

using Json = Server::Json;
using Clock = std::chrono::steady_clock;
constexpr std::size_t most_asked = 100;  ///< bakes whose manifest is asked for, where the result is not fetched

void tell_done(const ConnectionFlags& flags, const EndedBake& bake, const std::string& folder, const Fetched& fetched,
               double seconds, const std::string& remark) {
    if (flags.json()) {
        Json line{{"event", "done"}, {"id", bake.id}};
        if (!folder.empty()) line.update({{"folder", folder}, {"received_bytes", fetched.received}});
        line["warnings"] = fetched.warnings;
        return print_line(line.dump(-1, ' ', false, Json::error_handler_t::replace));
    }
    char took[40];
    std::snprintf(took, sizeof took, " done in %.1f s", seconds);
    std::string line = bake.id + took + remark;
    if (!folder.empty())
        line += "; " + folder + ": " + std::to_string(fetched.files) + " files, " + in_megabytes(fetched.bytes) + ", " +
                in_megabytes(fetched.received) + " of it received";
    print_line(line);
}

void tell_not_done(const ConnectionFlags& flags, const EndedBake& bake) {
    if (flags.json())
        print_line(Json{{"event", bake.state}, {"id", bake.id}, {"field", bake.field}, {"message", bake.message}}.dump(
            -1, ' ', false, Json::error_handler_t::replace));
}

std::string reason(const EndedBake& bake) {
    std::string text = "bake " + bake.id + (bake.state == "failed" ? " failed" : " was cancelled");
    if (!bake.message.empty()) text += ": " + bake.message;
    if (!bake.field.empty() && bake.message.find(bake.field) == std::string::npos) text += " (" + bake.field + ")";
    return text;
}

/// Throws RemoteError when some are not done.
void judge(const ConnectionFlags& flags, const std::vector<EndedBake>& bakes) {
    std::vector<const EndedBake*> lost;
    for (const EndedBake& bake : bakes)
        if (bake.state != "done") lost.push_back(&bake);
    if (lost.empty()) return;
    bool failed = false;
    for (const EndedBake* bake : lost) {
        failed = failed || bake->state == "failed";
        tell_not_done(flags, *bake);
        if (lost.size() > 1) say_warning(reason(*bake));
    }
    const ExitCode code = failed ? ExitCode::bake_failed : ExitCode::bake_cancelled;
    if (lost.size() == 1) throw RemoteError(code, reason(*lost[0]), lost[0]->field);
    throw RemoteError(code, std::to_string(lost.size()) + " of " + std::to_string(bakes.size()) + " bakes " +
                                (failed ? "failed" : "were cancelled"));
}

/// `text` as one word of a shell command.
std::string quoted(const std::string& word) {
    const auto plain = [](unsigned char c) { return std::isalnum(c) || std::strchr("_-./:@%+=,", c); };
    if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
    std::string text = "'";
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
}

void tell_how_to_go_on(const ConnectionFlags& flags, const ServerOptions& options, const std::string& which) {
    std::string rest = which + " --server " + quoted(options.url);
    if (!flags.token_file.empty()) rest += " --token-file " + quoted(flags.token_file);
    if (!flags.ca_file.empty()) rest += " --ca-file " + quoted(flags.ca_file);
    say_note("the bake continues on the server; \"hairbake wait " + rest + "\" resumes the wait. \"hairbake cancel " +
             rest + "\" cancels it.");
}

}  // namespace

std::string in_megabytes(std::uint64_t bytes) {
    char text[40];
    std::snprintf(text, sizeof text, "%.1f MB", static_cast<double>(bytes) / 1e6);
    return text;
}

void await_bakes(const ConnectionFlags& flags, const ServerOptions& options, const Awaited& awaited) {
    const Clock::time_point start = Clock::now();
    std::vector<EndedBake> bakes;
    std::vector<Fetched> fetched;
    std::size_t asked = 0;  // manifests, for their warnings alone
    bool ended = false;
    try {
        run_phase(flags, options, {{"bake", 20}, {"fetch", 3}}, [&](Server& server) {
            bakes = awaited.wait(server);
            ended = true;
            for (EndedBake& bake : bakes) {
                bake.message = awaited.words(bake.message);
                const std::string folder = bake.state == "done" ? awaited.folder(bake.id) : "";
                if (!folder.empty()) check_outside(folder, awaited.inputs);
                Fetched& here = fetched.emplace_back();
                if (!folder.empty())
                    here = fetch_result(server, bake.id, folder);
                else if (bake.state == "done" && asked++ < most_asked)
                    here.warnings = warnings_of_bake(server, bake.id);
                for (std::string& warning : here.warnings) warning = awaited.words(warning);
            }
        });
    } catch (const Error& error) {
        if (!ended && error.kind() == ErrorKind::cancelled) tell_how_to_go_on(flags, options, awaited.which);
        throw;
    }
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    for (std::size_t i = 0; i < bakes.size(); ++i) {
        if (bakes[i].state != "done") continue;
        say_bake_warnings(bakes.size() > 1 ? bakes[i].id : "", fetched[i].warnings);
        tell_done(flags, bakes[i], awaited.folder(bakes[i].id), fetched[i], seconds, awaited.remark);
    }
    if (asked > most_asked)
        say_note("the warnings of the first " + std::to_string(most_asked) +
                 " bakes are shown; \"hairbake wait ID\" shows others");
    judge(flags, bakes);
}

}  // namespace hairbake
