#include "server/settings.h"

#include <toml++/toml.h>
#include <algorithm>
#include <chrono>
#include <set>
#include <thread>

#include "core/base/error.h"
#include "server/jobs/runner_kinds.h"
#include "server/store/blob_store.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void refuse(const std::string& field, const std::string& message) {
    throw Error(ErrorKind::usage, field + " " + message, field);
}

/// The fields of one table. done() refuses fields that were not read.
class Block {
public:
    Block(const toml::table& table, std::string name) : table_(table), name_(std::move(name)) {}

    template <class T, class Set>
    void read(const char* field, const char* allowed, const Set& set) {
        asked_.insert(field);
        const toml::node* node = table_.get(field);
        if (!node) return;
        const auto value = node->value_exact<T>();
        if (!value) refuse(name_ + "." + field, std::string("is not ") + allowed);
        set(*value);
    }
    void text(const char* field, std::string& target) {
        read<std::string>(field, "a text", [&](const std::string& value) { target = value; });
    }
    void path(const char* field, fs::path& target, const fs::path& base) {
        read<std::string>(field, "a path", [&](const std::string& value) { target = base / value; });
    }
    /// A number in [low, high] units.
    template <class T>
    void number(const char* field, T& target, std::int64_t low, std::int64_t high, std::uint64_t unit = 1) {
        read<std::int64_t>(field, "an integer", [&](std::int64_t value) {
            if (value < low || value > high)
                refuse(name_ + "." + field, "is " + std::to_string(value) + "; allowed is " + std::to_string(low) +
                                                " to " + std::to_string(high));
            target = static_cast<T>(static_cast<std::uint64_t>(value) * unit);
        });
    }
    void ignore(const char* field) { asked_.insert(field); }
    const toml::node* get(const char* field) {
        asked_.insert(field);
        return table_.get(field);
    }
    void done() const {
        for (const auto& [key, value] : table_)
            if (!asked_.count(std::string(key.str())))
                refuse(name_.empty() ? std::string(key.str()) : name_ + "." + std::string(key.str()), "is not a field");
    }

private:
    const toml::table& table_;
    std::string name_;
    std::set<std::string> asked_;
};

template <class Read>
void read_block(const toml::table& file, const char* name, const Read& read) {
    if (!file.contains(name)) return;
    const toml::table* table = file.get_as<toml::table>(name);
    if (!table) refuse(name, "is not a table");
    Block block(*table, name);
    read(block);
    block.done();
}

std::set<Scope> scopes_of(const toml::node* node) {
    std::set<Scope> scopes;
    const toml::array* list = node ? node->as_array() : nullptr;
    if (!list || list->empty()) refuse("token.scopes", "is missing; allowed is a list of read, upload, bake, admin");
    for (const toml::node& item : *list) {
        const auto name = item.value_exact<std::string>();
        const auto scope = name ? find_in(token_scopes, *name) : std::nullopt;
        if (!scope) refuse("token.scopes", "holds another value than the allowed " + list_names(token_scopes));
        scopes.insert(*scope);
    }
    return scopes;
}

double seconds_of(const toml::date_time& time) {
    using namespace std::chrono;
    const sys_days day = year(time.date.year) / month(time.date.month) / std::chrono::day(time.date.day);
    const int offset = time.offset ? time.offset->minutes : 0;
    return static_cast<double>(day.time_since_epoch().count()) * 86400 + time.time.hour * 3600.0 +
           time.time.minute * 60.0 + time.time.second - offset * 60.0;
}

TokenSettings read_token(const toml::table& table) {
    Block block(table, "token");
    TokenSettings token;
    block.text("name", token.name);
    block.text("sha256", token.sha256);
    token.scopes = scopes_of(block.get("scopes"));
    block.read<toml::date_time>("expires", "a date and time",
                                [&](const toml::date_time& value) { token.expires = seconds_of(value); });
    block.done();
    if (token.name.empty()) refuse("token.name", "is missing");
    if (!is_digest(token.sha256))
        refuse("token.sha256", "is not 64 lower-case hexadecimal digits; `hairbaked token new` makes them");
    return token;
}

void read_listen(Block& block, Settings& settings, const fs::path& base) {
    block.read<std::string>("socket", "a path", [&](const std::string& value) { settings.socket = base / value; });
    block.text("address", settings.address);
    block.number("port", settings.port, 0, 65535);
    block.number("threads", settings.threads, 1, 1024);
    block.number("bodies", settings.bodies, 1, 1024);
    block.number("bodies_per_address", settings.bodies_per_address, 1, 1024);
    block.number("body_rate", settings.body_rate, 0, 1'000'000'000);
    block.number("body_window_s", settings.body_window_s, 1, 3600);
    block.number("waiting", settings.waiting, 1, 65536);
    block.text("accel", settings.accel);
}

void read_store(Block& block, Settings& settings, const fs::path& base) {
    block.path("folder", settings.store, base);
    block.text("id", settings.store_id);
    block.number("budget_mb", settings.budget_bytes, 1, 1 << 30, 1 << 20);
    block.number("keep_free_mb", settings.keep_free_bytes, 0, 1 << 30, 1 << 20);
    block.number("blob_mb", settings.blob_bytes, 1, 1 << 20, 1 << 20);
    block.number("upload_lifetime_s", settings.upload_lifetime_s, 1, 366 * 86400);
    block.number("open_uploads", settings.open_uploads, 1, 1'000'000);
    block.number("scrub_s", settings.scrub_s, 0, 366 * 86400);
    block.number("keep_failed_s", settings.keep_failed_s, 1, 3660ll * 86400);
}

void read_workers(Block& block, Settings& settings, const fs::path& base) {
    block.text("runner", settings.runner);
    block.path("program", settings.worker, base);
    block.number("count", settings.workers, 0, 1024);
    block.number("threads", settings.worker_threads, 0, 1024);
    block.number("memory_mb", settings.memory_bytes, 0, 1 << 24, 1 << 20);
    block.number("cpu_s", settings.cpu_seconds, 0, 366 * 86400);
    block.number("wall_s", settings.wall_seconds, 1, 366 * 86400);
    block.number("max_crashes", settings.max_crashes, 0, 1000);
    block.number("crash_wait_s", settings.crash_wait_s, 0, 86400);
}

void read_web(Block& block, Settings& settings, const fs::path& base) {
    block.read<std::string>("folder", "a path", [&](const std::string& value) {
        settings.web = value.empty() ? fs::path() : base / value;
    });
}

Settings read_tables(const toml::table& file, const fs::path& base) {
    struct Table {
        const char* name;
        void (*read)(Block& block, Settings& settings, const fs::path& base);
    };
    constexpr Table tables[]{
        {"listen", read_listen}, {"store", read_store}, {"workers", read_workers}, {"web", read_web}};
    Settings settings;
    Block whole(file, "");
    for (const Table& table : tables) {
        whole.ignore(table.name);
        read_block(file, table.name, [&](Block& block) { table.read(block, settings, base); });
    }
    if (const toml::node* tokens = whole.get("token")) {
        if (!tokens->is_array_of_tables()) refuse("token", "is not a list of tables: [[token]]");
        for (const toml::node& token : *tokens->as_array()) settings.tokens.push_back(read_token(*token.as_table()));
    }
    whole.done();
    return settings;
}

/// The page's folder, as `./dev build` or an installation places it; empty when there is none.
fs::path page_beside(const fs::path& programs) {
    for (const char* place : {"../web", "../share/hairbake/web"})
        if (fs::path folder = (programs / place).lexically_normal(); fs::exists(folder / "index.html")) return folder;
    return {};
}

}  // namespace

Settings read_settings(const fs::path& file) {
    try {
        return read_tables(toml::parse_file(file.string()), fs::absolute(file).parent_path());
    } catch (const toml::parse_error& error) {
        throw Error(ErrorKind::usage, file.string() + " line " + std::to_string(error.source().begin.line) + ": " +
                                          std::string(error.description()));
    } catch (const Error& error) {
        throw Error(ErrorKind::usage, file.string() + ": " + error.what(), error.field());
    }
}

void complete(Settings& settings) {
    const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    if (settings.workers == 0) settings.workers = std::max(1, cores / 2);
    if (settings.worker_threads == 0) settings.worker_threads = std::max(1, cores / settings.workers);
    const fs::path programs = fs::read_symlink("/proc/self/exe").parent_path();
    if (settings.worker.empty()) settings.worker = programs / "hairbake-worker";
    if (!settings.web) settings.web = page_beside(programs);
    if (settings.socket.empty() && settings.address != "127.0.0.1" && settings.address != "::1")
        refuse("listen.address",
               "is " + settings.address + "; allowed is 127.0.0.1 or ::1: put nginx in front to expose it");
    if (!settings.accel.empty() && (!settings.accel.starts_with("/") || !settings.accel.ends_with("/")))
        refuse("listen.accel", "is " + settings.accel + "; allowed is a location that begins and ends with /");
    const std::vector<std::string> runners = runner_names();
    if (std::find(runners.begin(), runners.end(), settings.runner) == runners.end()) {
        std::string allowed;
        for (const std::string& name : runners) allowed += (allowed.empty() ? "" : ", ") + name;
        refuse("workers.runner", "is " + settings.runner + "; allowed is " + allowed);
    }
    if (!settings.store_id.empty() && (settings.store_id.size() != 32 ||
                                       settings.store_id.find_first_not_of("0123456789abcdef") != std::string::npos))
        refuse("store.id", "is " + settings.store_id + "; allowed are 32 hexadecimal digits, as in the file store-id");
    if (std::error_code error; fs::is_directory(settings.worker, error))
        refuse("workers.program", "is the folder " + settings.worker.string() + "; allowed is a program");
    settings.store = fs::absolute(settings.store);
}

}  // namespace hairbake
