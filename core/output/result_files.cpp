#include "core/output/result_files.h"

#include <iterator>

#include "core/output/format_table.h"
#include "core/output/glb_file.h"
#include "core/output/preview.h"

namespace hairbake {

void check_outputs(const BakeRequest& request, const HairModel& hair) {
    if (request.wants("glb")) check_glb_size(hair.vertex_count(), hair.strand_count(), request);
}

std::vector<WrittenFile> write_files(BakeResult& result, const std::filesystem::path& folder, Progress& progress) {
    std::vector<WrittenFile> files;
    const OutputContext context{result, folder, progress, result.warnings};
    const double steps = static_cast<double>(result.parts.size() * std::size(format_writers)) + 1;
    double done = 0;
    for (const StagePart& part : result.parts)
        for (const FormatWriter& writer : format_writers) {
            progress.check();
            progress.report(done++ / steps);
            if (!writer.format.empty() && !result.request.wants(std::string(writer.format))) continue;
            for (WrittenFile& file : writer.write(context, part)) files.push_back(std::move(file));
        }
    progress.check();
    files.push_back(write_preview(result, folder, result.warnings));
    return files;
}

}  // namespace hairbake
