// hairbake compare
#include <CLI/CLI.hpp>

#include "clients/cli/commands.h"
#include "clients/cli/exit_code.h"
#include "clients/cli/messages.h"
#include "clients/cli/option_values.h"
#include "clients/cli/output.h"
#include "clients/cli/signal_watch.h"
#include "core/tools/compare.h"

namespace hairbake {
namespace {

constexpr int equal = 0, different = 1, failed = 2;

struct CompareOptions {
    std::string first, second;
    double tolerance = 0;
    bool json = false;
};

int run(const CompareOptions& options) {
    Progress progress;
    const SignalWatch watch(progress, [] {});
    const ComparisonReport report = compare(options.first, options.second, options.tolerance);
    print_text(options.json ? report.json + "\n" : as_table(report.json));
    return report.equal ? equal : different;
}

}  // namespace

void add_compare_command(CLI::App& app, Action& action, int& exit_code) {
    CLI::App* command = app.add_subcommand("compare", "Whether two results are equal, and their differences");
    const auto options = std::make_shared<CompareOptions>();
    command->add_option("first", options->first, "result folder")->required()->type_name("DIR1");
    command->add_option("second", options->second, "result folder")->required()->type_name("DIR2");
    command
        ->add_option("--tolerance", options->tolerance,
                     "largest difference that counts as equal, as a share of the array's largest value, 0 to 1")
        ->transform(number(0, 1))
        ->type_name("X")
        ->capture_default_str();
    command->add_flag("--json", options->json, "as JSON");
    command->footer(
        "Exit codes:\n"
        "  0  equal\n"
        "  1  different\n"
        "  2  an error: a folder is no result, nothing to compare, wrong usage\n"
        "  5  cancelled\n");
    command->callback([options, &action, &exit_code] {
        action = [options, &exit_code] {
            try {
                exit_code = run(*options);
            } catch (...) {
                const Failure failure = current_failure();
                say_error(failure.message);
                exit_code = failure.code == ExitCode::cancelled ? static_cast<int>(failure.code) : failed;
            }
        };
    });
}

}  // namespace hairbake
