// The subcommands of the program, each in a file of its own.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace hairbake {

/// The work of the parsed command.
/// Throws the errors of the command.
using Action = std::function<void()>;

/// Each function adds its subcommand to `app`. When the user gives this subcommand, parsing sets `action`.
void add_bake_command(CLI::App& app, Action& action);
void add_info_command(CLI::App& app, Action& action);
void add_sample_command(CLI::App& app, Action& action);
/// The action sets `exit_code`, which is 0 before: the codes of compare are its own.
void add_compare_command(CLI::App& app, Action& action, int& exit_code);
void add_render_command(CLI::App& app, Action& action);
void add_diff_command(CLI::App& app, Action& action);
void add_presets_command(CLI::App& app, Action& action);
void add_submit_command(CLI::App& app, Action& action);
void add_status_command(CLI::App& app, Action& action);
void add_wait_command(CLI::App& app, Action& action);
void add_fetch_command(CLI::App& app, Action& action);
void add_cancel_command(CLI::App& app, Action& action);
void add_delete_command(CLI::App& app, Action& action);
void add_rebake_command(CLI::App& app, Action& action);
void add_upload_command(CLI::App& app, Action& action);
/// Call it last: the scripts have the commands that `app` has when the action runs.
void add_completion_command(CLI::App& app, Action& action);

}  // namespace hairbake
