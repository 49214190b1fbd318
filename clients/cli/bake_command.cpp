// hairbake bake
#include <CLI/CLI.hpp>
#include <algorithm>

#include "clients/cli/commands.h"
#include "clients/cli/common_flags.h"
#include "clients/cli/exit_code.h"
#include "clients/cli/messages.h"
#include "clients/cli/output.h"
#include "clients/cli/progress_display.h"
#include "clients/cli/request_flags.h"
#include "clients/cli/signal_watch.h"
#include "core/bake.h"
#include "core/request/unused_fields.h"

namespace hairbake {
namespace {

struct BakeFlags {
    RequestFlags request;
    std::string folder, progress = "auto";
    int threads = 0;
};

std::string summary(const BakeResult& result, const std::string& folder) {
    char text[256];
    std::string line;
    const auto add = [&](const char* more) { line += std::string(line.empty() ? " " : ", ") + more; };
    for (const StagePart& part : result.parts) {
        double seconds = 0;
        for (const Phase& phase : part.stage->phases)
            if (phase.name != "reference") seconds += result.measured.timings_s.at(std::string(phase.name));
        if (const VertexArray* average = find_array(part.arrays, average_transmittance_kind())) {
            std::snprintf(text, sizeof text, "transmittance of %zu vertices in %.2f s", average->rows(), seconds);
            add(text);
        }
        const auto* facts = std::get_if<TransmittanceFacts>(&part.facts);
        if (facts && facts->error_bar && facts->error_bar->outside.vertices > 0) {
            std::snprintf(text, sizeof text, " (RMSE %.4f, bias %+.4f)", facts->error_bar->outside.rmse,
                          facts->error_bar->outside.bias);
            line += text;
        }
        if (part.maps) {
            const int n = part.maps->face_size;
            std::snprintf(text, sizeof text, "%zu maps of %dx%dx6 in %.2f s", part.maps->cube_count(), n, n, seconds);
            add(text);
        }
    }
    std::snprintf(text, sizeof text, "; peak memory %.0f MB", double(result.measured.peak_memory_bytes) / 1e6);
    return folder + ":" + line + text;
}

void tell_done(const BakeResult& result, const BakeFlags& options) {
    const std::vector<std::string> said = request_warnings(result.request);  // by make_request()
    for (const std::string& warning : result.warnings)
        if (std::find(said.begin(), said.end(), warning) == said.end()) say_warning(warning);
    print_line(options.progress == "json" ? R"({"event":"done","folder":)" + json_string(options.folder) + R"(,"id":)" +
                                                json_string(result.id) + "}"
                                          : summary(result, options.folder));
}

void run_bake(const BakeFlags& options) {
    const BakeRequest request = make_request(options.request);
    warn_of_threads(options.threads);
    BakeResult result;
    {
        const auto progress = make_progress_display(options.progress, planned_phases(stages_of(request), request));
        const SignalWatch watch(*progress, [&] { discard_staging(options.folder); });
        check_request_file(options.request, options.folder);
        check_bake(request, options.folder);
        result = bake(request, stages_of(request), {.threads = options.threads, .tell_paths = true}, *progress);
        write_result(result, options.folder, *progress);
    }
    tell_done(result, options);
}

void run(const BakeFlags& options) {
    with_json_failures(options.progress, [&] { run_bake(options); });
}

}  // namespace

void add_bake_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("bake", "Bake transmittance and irradiance maps into a result folder");
    const auto options = std::make_shared<BakeFlags>();
    command->add_option("--hair", options->request.hair, "hair model; alone: transmittance only")->type_name("FILE");
    add_request_flags(
        *command, options->request,
        "HDR environment: a picture, or a cube's six faces as a folder or sky_{face}.hdr; alone: irradiance "
        "maps only");
    command->add_option("--out", options->folder, "result folder: new, empty or an earlier result")
        ->required()
        ->type_name("DIR");
    add_threads_flag(*command, options->threads);
    add_progress_flag(*command, options->progress);
    command->footer(request_flags_help() + "\n" + command->get_footer());
    command->callback([options, &action] { action = [options] { run(*options); }; });
}

}  // namespace hairbake
