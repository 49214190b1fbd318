// hairbaked: the service. serve() starts its parts in order.
#include <malloc.h>
#include <signal.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <thread>

#include "core/base/digest.h"
#include "core/base/error.h"
#include "server/http/access.h"
#include "server/http/body_places.h"
#include "server/http/http_server.h"
#include "server/http/json_bodies.h"
#include "server/http/metrics.h"
#include "server/http/router.h"
#include "server/http/routes.h"
#include "server/jobs/service.h"
#include "server/settings.h"
#include "server/store/database.h"
#include "server/store/file_system.h"
#include "server/store/store_folder.h"
#include "server/store/store_identity.h"

namespace {

using namespace hairbake;

constexpr const char* usage = R"(hairbaked [--config FILE]   serve; without a file, the defaults hold
hairbaked store accept [--config FILE]
                            take folder and database of the store as they are; files that the database does not know
                            move to lost+found at the next start
hairbaked token new         print a new token and the lines for the configuration
hairbaked routes            print the routes: method, address, scope, limit of the body in bytes, media types
hairbaked --version         print the version
hairbaked --help            print this text
)";

/// A log message, escaped for a JSON string.
class JsonMessage : public spdlog::custom_flag_formatter {
public:
    void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& target) override {
        for (const char c : message.payload) {
            char escaped[8] = {c, 0};
            if (c == '"' || c == '\\')
                std::snprintf(escaped, sizeof escaped, "\\%c", c);
            else if (static_cast<unsigned char>(c) < 0x20)
                std::snprintf(escaped, sizeof escaped, "\\u%04x", c);
            target.append(escaped, escaped + std::strlen(escaped));
        }
    }
    std::unique_ptr<custom_flag_formatter> clone() const override { return std::make_unique<JsonMessage>(); }
};

/// Log lines on standard error, each a JSON object.
void set_up_log() {
    auto formatter = std::make_unique<spdlog::pattern_formatter>();
    formatter->add_flag<JsonMessage>('*').set_pattern(
        R"({"time":"%Y-%m-%dT%H:%M:%S.%e%z","level":"%l","thread":%t,"message":"%*"})");
    auto log = spdlog::stderr_logger_mt("hairbaked");
    log->set_formatter(std::move(formatter));
    spdlog::set_default_logger(log);
}

int print_new_token() {
    const std::string token = new_token();
    std::printf(
        "token (shown only now): %s\n\n[[token]]\nname = \"unnamed\"\nsha256 = \"%s\"\nscopes = [\"read\", \"upload\", "
        "\"bake\"]\n",
        token.c_str(), Digest().add(token).hex().c_str());
    return 0;
}

/// Prints the table of routes; the service is made on an empty store and answers nothing.
int print_routes() {
    spdlog::set_level(spdlog::level::off);  // of the service on a store that is gone at the end
    char folder[] = "/tmp/hairbaked-routes-XXXXXX";
    if (!::mkdtemp(folder)) throw Error(ErrorKind::internal, "no folder can be made in /tmp");
    struct Remove {
        std::filesystem::path path;
        ~Remove() { std::filesystem::remove_all(path); }
    } const remove{folder};
    Settings settings;
    settings.store = folder;
    complete(settings);
    Service service(settings);
    JsonBodies bodies(settings.store);
    Access access({});
    Metrics metrics;
    for (const Route& route : all_routes(service, bodies, access, metrics)) {
        std::string types;
        for (const std::string& type : route.types) types += " " + type;
        std::printf("%s %s %s %llu%s\n", route.method.c_str(), route.pattern.c_str(), name_of(route.scope).c_str(),
                    static_cast<unsigned long long>(route.body_limit), types.c_str());
    }
    return 0;
}

Settings settings_of(const char* file) {
    Settings settings = file ? read_settings(file) : Settings();
    complete(settings);
    return settings;
}

/// Calls `open`, which works on the store. A failure that the next start would meet again becomes Error(bad_input), so
/// that systemd does not start the daemon again and again.
template <class Open>
auto opening(const Settings& settings, const Open& open) {
    const std::string failed = "the store " + settings.store.string() + " cannot be opened: ";
    const std::string database = (settings.store / "hairbake.db").string();
    const auto stop = [&](const char* found, const std::string& advice) -> Error {
        return {ErrorKind::bad_input, failed + found + ". " + advice};
    };
    const std::string check =
        "Check owner, mode and kind of this file. If all are right, the database " + database + " may be spoiled. ";
    try {
        return open();
    } catch (const SpoiledDatabase& error) {
        throw Error(ErrorKind::bad_input, failed + error.what());
    } catch (const Error& error) {
        if (error.kind() == ErrorKind::internal) throw stop(error.what(), check + advice_for_broken_database);
        if (error.kind() == ErrorKind::out_of_resources) throw Error(error.kind(), failed + error.what());
        throw;
    } catch (const std::filesystem::filesystem_error& error) {
        throw Error(ErrorKind::bad_input, failed + error_text(error));
    } catch (const std::logic_error& error) {  // a row holds another value than it may
        throw stop(error.what(), check + advice_for_broken_database);
    }
}

/// For a store whose start was stopped: see StoreIdentity.
int accept_store(const Settings& settings) {
    ::umask(027);
    const StoreFolder folder(settings.store, settings.store_id, StoreUse::accept);
    Database database(folder.database(), folder.hooks_to_accept());
    StoreIdentity::accept(folder.path(), database);
    std::printf("The folder %s and its database are one store now. Start the daemon.\n", settings.store.c_str());
    return 0;
}

sigset_t stop_signals() {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGINT);
    sigaddset(&set, SIGTERM);
    return set;
}

/// Blocks the stop signals in this thread and all later ones, so that wait_for_signal() receives them.
void prepare_signals() {
    signal(SIGINT, SIG_DFL);  // a shell starts background jobs with SIGINT ignored
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
    const sigset_t set = stop_signals();
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

void wait_for_signal() {
    const sigset_t set = stop_signals();
    int received = 0;
    while (sigwait(&set, &received) != 0) {
    }
}

/// Ends the process after `patience` without waiting for slow clients and workers. Everything that was acknowledged is
/// on the disk already.
void end_hard_after(std::chrono::seconds patience) {
    signal(SIGALRM, [](int) { _exit(0); });  // no thread: the system may give none
    alarm(static_cast<unsigned>(patience.count()));
}

#ifdef HAIRBAKE_PLANTED_RACE
/// A data race that a run under ThreadSanitizer must find.
void race() {
    static volatile long long requests = 0;
    requests = requests + 1;
}
#endif

HttpReply answer(const Router& router, Metrics& metrics, HttpRequest& request) {
#ifdef HAIRBAKE_PLANTED_RACE
    if (std::getenv("HAIRBAKE_PLANTED_RACE")) race();
#endif
    const auto start = std::chrono::steady_clock::now();
    HttpReply reply = router.answer(request);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    metrics.count(request.method, reply.status, seconds);
    spdlog::debug("{} {} by {} in {:.1f} ms", request.method, reply.status, request.caller, seconds * 1000);
    return reply;
}

/// Gives the memory of a large body back to the system when it is freed. By itself the allocator raises these bounds
/// with the largest block that was freed, and then each thread's arena keeps as much.
void give_back_freed_memory() {
    ::mallopt(M_MMAP_THRESHOLD, 128 << 10);
    ::mallopt(M_TRIM_THRESHOLD, 128 << 10);
}

/// Each connection takes a descriptor, and the usual soft limit is lower than the number of connections that may wait.
void allow_many_files() {
    rlimit limit{};
    if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
    limit.rlim_cur = limit.rlim_max;
    ::setrlimit(RLIMIT_NOFILE, &limit);
}

int serve(const Settings& settings) {
    ::umask(027);
    allow_many_files();
    give_back_freed_memory();
    prepare_signals();
    const std::unique_ptr<Service> opened = opening(settings, [&] { return std::make_unique<Service>(settings); });
    Service& service = *opened;
    Access access(settings.tokens);
    Metrics metrics;
    JsonBodies bodies(service.incoming_folder());
    BodyPlaces places(settings.bodies, settings.bodies_per_address);
    const Router router(all_routes(service, bodies, access, metrics), access, places);
    HttpServer http_server(
        {settings.socket,
         settings.address,
         settings.port,
         settings.threads,
         settings.waiting,
         settings.accel,
         {settings.body_rate, std::chrono::milliseconds(static_cast<std::int64_t>(settings.body_window_s * 1000))}},
        [&](HttpRequest& request) { return answer(router, metrics, request); });
    std::atomic<bool> stopping = false;
    std::jthread serving([&] {
        http_server.join();
        if (stopping) return;
        spdlog::critical("no connection can be accepted any more; the daemon ends, so that systemd starts it again");
        _exit(1);  // everything that was acknowledged is on the disk
    });
    std::printf("hairbaked listens on %s\n", http_server.address().c_str());
    std::fflush(stdout);
    wait_for_signal();
    spdlog::info("stopping");
    stopping = true;
    end_hard_after(std::chrono::seconds(4));
    http_server.stop();
    service.stop();
    serving.join();
    return 0;
}

/// Also after other words: "hairbaked store accept --help".
bool asks_for_help(int argc, char** argv) {
    return std::any_of(argv + 1, argv + argc,
                       [](const std::string_view word) { return word == "--help" || word == "-h"; });
}

}  // namespace

int main(int argc, char** argv) {
    set_up_log();
    try {
        if (argc > 1 && asks_for_help(argc, argv)) return std::fputs(usage, stdout) < 0 ? 1 : 0;
        const std::string first = argc > 1 ? argv[1] : "";
        if (argc == 3 && first == "token" && !std::strcmp(argv[2], "new")) return print_new_token();
        if (argc == 2 && first == "routes") return print_routes();
        if (argc == 2 && first == "--version") return std::printf("hairbaked %s\n", HAIRBAKE_VERSION), 0;
        if (first == "store" && (argc == 3 || (argc == 5 && !std::strcmp(argv[3], "--config"))) &&
            !std::strcmp(argv[2], "accept")) {
            const Settings settings = settings_of(argc == 5 ? argv[4] : nullptr);
            return opening(settings, [&] { return accept_store(settings); });
        }
        if (argc != 1 && !(argc == 3 && first == "--config")) {
            std::fputs(usage, stderr);
            return 2;
        }
        return serve(settings_of(argc == 3 ? argv[2] : nullptr));
    } catch (const Error& error) {
        std::fprintf(stderr, "hairbaked: %s\n", error.what());
        return error.kind() == ErrorKind::usage ? 2 : error.kind() == ErrorKind::bad_input ? 3 : 1;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "hairbaked: %s\n", error_text(error).c_str());
        return 1;
    }
}
