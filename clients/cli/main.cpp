// hairbake: the command line.
#include <CLI/CLI.hpp>
#include <sstream>

#include "clients/cli/commands.h"
#include "clients/cli/exit_code.h"
#include "clients/cli/messages.h"
#include "clients/cli/output.h"
#include "clients/cli/parse_failure.h"
#include "clients/cli/signal_watch.h"
#include "core/bake.h"

namespace {

int report_failure() {
    const hairbake::Failure failure = hairbake::current_failure();
    const bool defect = failure.code == hairbake::ExitCode::internal;
    hairbake::say_error(defect ? "a defect of hairbake: " + failure.message : failure.message);
    return static_cast<int>(failure.code);
}

/// --help and --version end the parsing with an exception, too.
int end_parsing(const CLI::ParseError& error, const CLI::App& app, std::span<char* const> arguments) {
    if (error.get_exit_code() != static_cast<int>(CLI::ExitCodes::Success)) {
        hairbake::say_error(hairbake::words_for(error, app, arguments));
        return static_cast<int>(hairbake::ExitCode::usage);
    }
    std::ostringstream text, errors;
    app.exit(error, text, errors);
    try {
        hairbake::print_text(text.str());
        return static_cast<int>(hairbake::ExitCode::ok);
    } catch (...) {
        return report_failure();
    }
}

}  // namespace

int main(int argc, char** argv) {
    hairbake::occupy_closed_streams();
    hairbake::block_signals();
    CLI::App app("Bakes irradiance cube maps and per-vertex transmittance for hair.", "hairbake");
    hairbake::Action action;
    int exit_code = static_cast<int>(hairbake::ExitCode::ok);
    app.set_version_flag("--version", "hairbake " + hairbake::version());
    app.require_subcommand(1);
    app.footer(hairbake::exit_code_help());  // every command inherits it; those that talk to a service have their own
    hairbake::add_bake_command(app, action);
    hairbake::add_info_command(app, action);
    hairbake::add_sample_command(app, action);
    hairbake::add_compare_command(app, action, exit_code);
    hairbake::add_render_command(app, action);
    hairbake::add_diff_command(app, action);
    hairbake::add_presets_command(app, action);
    hairbake::add_completion_command(app, action);
    hairbake::add_submit_command(app, action);
    hairbake::add_status_command(app, action);
    hairbake::add_wait_command(app, action);
    hairbake::add_fetch_command(app, action);
    hairbake::add_cancel_command(app, action);
    hairbake::add_rebake_command(app, action);
    hairbake::add_upload_command(app, action);
    hairbake::add_delete_command(app, action);
    app.footer(hairbake::remote_exit_code_help());
    const auto arguments = std::span<char* const>(argv, static_cast<std::size_t>(argc)).subspan(argc > 0 ? 1 : 0);
    if (const std::string mistake = hairbake::words_for_one_dash(app, arguments); !mistake.empty()) {
        hairbake::say_error(mistake);
        return static_cast<int>(hairbake::ExitCode::usage);
    }
    try {
        app.parse(argc, argv);
        action();
        return exit_code;
    } catch (const CLI::ParseError& error) {
        return end_parsing(error, app, arguments);
    } catch (...) {
        return report_failure();
    }
}
