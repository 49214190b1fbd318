// hairbake: the command line.
#include <CLI/CLI.hpp>

#include "clients/cli/commands.h"
#include "clients/cli/exit_code.h"
#include "clients/cli/messages.h"
#include "clients/cli/signal_watch.h"
#include "core/bake.h"

namespace {

int report_failure() {
    const hairbake::Failure failure = hairbake::current_failure();
    const bool defect = failure.code == hairbake::ExitCode::internal;
    hairbake::say_error(defect ? "a defect of hairbake: " + failure.message : failure.message);
    return static_cast<int>(failure.code);
}

}  // namespace

int main(int argc, char** argv) {
    hairbake::block_signals();
    CLI::App app("Bakes irradiance cube maps and per-vertex transmittance for hair.", "hairbake");
    hairbake::Action action;
    app.set_version_flag("--version", "hairbake " + hairbake::version());
    app.require_subcommand(1);
    app.footer(hairbake::exit_code_help());  // every command inherits it; those that talk to a service have their own
    hairbake::add_bake_command(app, action);
    hairbake::add_info_command(app, action);
    hairbake::add_sample_command(app, action);
    hairbake::add_compare_command(app, action);
    hairbake::add_render_command(app, action);
    hairbake::add_diff_command(app, action);
    hairbake::add_presets_command(app, action);
    hairbake::add_submit_command(app, action);
    hairbake::add_status_command(app, action);
    hairbake::add_wait_command(app, action);
    hairbake::add_fetch_command(app, action);
    hairbake::add_cancel_command(app, action);
    hairbake::add_rebake_command(app, action);
    hairbake::add_upload_command(app, action);
    hairbake::add_delete_command(app, action);
    app.footer(hairbake::remote_exit_code_help());
    try {
        app.parse(argc, argv);
        action();
        return static_cast<int>(hairbake::ExitCode::ok);
    } catch (const CLI::ParseError& error) {
        const bool asked = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success);  // --help, --version
        app.exit(error);
        return static_cast<int>(asked ? hairbake::ExitCode::ok : hairbake::ExitCode::usage);
    } catch (...) {
        return report_failure();
    }
}
