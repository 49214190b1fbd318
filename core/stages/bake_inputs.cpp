#include "core/stages/bake_inputs.h"

#include <algorithm>
#include <utility>

#include "core/base/assert.h"
#include "core/base/bounds.h"
#include "core/base/digest.h"
#include "core/base/error.h"
#include "core/base/file_identity.h"
#include "core/base/naming_file.h"
#include "core/base/short_number.h"
#include "core/environment/environment_files.h"
#include "core/environment/environment_reader.h"
#include "core/hair/hair_file.h"
#include "core/mesh/mesh_file.h"
#include "core/mesh/mesh_fit.h"

namespace hairbake {
namespace {

/// Watches files from their digest to the end of their reading. OpenImageIO reads pictures in an order of its own, so
/// the digest needs another pass over the file. This class finds out whether both passes saw the same bytes.
class UnchangedFiles {
public:
    explicit UnchangedFiles(std::vector<std::filesystem::path> files) : files_(std::move(files)) {
        for (const auto& file : files_) identities_.push_back(identity_of(file));
    }

    /// Throws Error(bad_input) naming the first file that has changed.
    void check() const {
        for (std::size_t i = 0; i < files_.size(); ++i)
            if (identity_of(files_[i]) != identities_[i])
                throw Error(ErrorKind::bad_input,
                            files_[i].string() + " has changed while it was read; bake again when it is whole");
    }

private:
    std::vector<std::filesystem::path> files_;
    std::vector<std::optional<FileIdentity>> identities_;
};

/// The edges that keep a mesh from being a closed surface, in words for a warning.
std::string shell_of(const MeshTopology& topology) {
    return std::to_string(topology.open_edges) + " of its " + std::to_string(topology.edges) +
           " edges lie in one triangle only, " + std::to_string(topology.irregular_edges) +
           " in more than two or in two that disagree about the outside";
}

bool reads(const Stage& stage, std::string_view input) {
    return std::find(stage.inputs.begin(), stage.inputs.end(), input) != stage.inputs.end();
}

bool read(std::span<const Stage* const> stages, std::string_view input) {
    return std::any_of(stages.begin(), stages.end(), [&](const Stage* stage) { return reads(*stage, input); });
}

bool read_setting(std::span<const Stage* const> stages, std::string_view setting) {
    return std::any_of(stages.begin(), stages.end(), [&](const Stage* stage) {
        return std::find(stage->settings.begin(), stage->settings.end(), setting) != stage->settings.end();
    });
}

/// Runs `body`. Its errors about a file get the name of the request's field.
template <class Body>
void naming_field(const char* field, const Body& body) try {
    body();
} catch (const Error& error) {
    throw Error(error.kind(), error.what(), error.field().empty() ? field : error.field(), error.system_error());
}

/// Empty where the file has no transparency, or the request says how opaque the strands are.
std::string transparency_warning(const HairModel& model, const StrandSettings& settings) {
    if (settings.opacity_from_file || settings.opacity != 1) return {};
    const float low = model.transparency.empty() ? model.default_transparency : std::ranges::min(model.transparency);
    const float high = model.transparency.empty() ? model.default_transparency : std::ranges::max(model.transparency);
    if (low == 0 && high == 0) return {};
    return "the hair file's transparency (" + short_number(low) + " to " + short_number(high) +
           ") is not used: strand.opacity is 1; strand.opacity = from_file takes it";
}

HairFacts facts_of(const HairModel& model) {
    const Bounds bounds = bounds_of(model.positions);
    return {model.strand_count(), model.vertex_count(), model.vertex_count() - model.strand_count(), bounds.low,
            bounds.high};
}

MeshFacts facts_of(const MeshFile& file) {
    MeshFacts facts;
    facts.format = file.format;
    facts.positions = file.mesh.positions.size();
    facts.triangles = file.mesh.triangles.size();
    facts.faces = file.faces;
    facts.concave_faces = file.concave_faces;
    facts.crossing_faces = file.crossing_faces;
    facts.turned_triangles = file.turned_triangles;
    facts.topology = topology_of(file.mesh);
    return facts;
}

}  // namespace

void check_headers(const BakeRequest& request, std::span<const Stage* const> stages) {
    if (read(stages, "hair") && request.hair) {
        naming_field("hair", [&] { check_groom(*request.hair); });
        if (request.occluder) naming_field("occluder", [&] { check_mesh(*request.occluder); });
        if (request.receiver) naming_field("receiver", [&] { check_mesh(*request.receiver); });
    }
    if (read(stages, "environment") && request.environment)
        naming_field("environment", [&] { check_environment(*request.environment, request.environment_settings); });
}

void BakeInputs::read_for(std::span<const Stage* const> stages) {
    const bool hair = read(stages, "hair") && request_.hair, sky = read(stages, "environment") && request_.environment;
    check_headers(request_, stages);
    if (hair)
        clock_.run("read_hair", [&](Progress& progress) {
            read_hair_and_meshes(progress);
            if (read_setting(stages, "strand")) strands();
        });
    if (sky) clock_.run("read_environment", [&](Progress& progress) { read_sky(progress); });
}

void BakeInputs::read_hair_and_meshes(Progress& progress) {
    std::vector<std::filesystem::path> files{*request_.hair};
    for (const auto* mesh : {&request_.occluder, &request_.receiver})
        if (*mesh) files.emplace_back(**mesh);
    const UnchangedFiles unchanged(files);
    facts_.digests["hair"] = digest_of_file(*request_.hair);
    if (request_.occluder) facts_.digests["occluder"] = digest_of_file(*request_.occluder);
    if (request_.receiver) facts_.digests["receiver"] = digest_of_file(*request_.receiver);
    progress.check();
    Groom groom = read_groom(*request_.hair, {request_.strand.time});
    facts_.hair = facts_of(groom.model);
    hair_ = std::move(groom.model);
    facts_.hair_extras = groom.extras;
    warnings_.insert(warnings_.end(), groom.warnings.begin(), groom.warnings.end());
    if (std::string warning = transparency_warning(*hair_, request_.strand); !warning.empty())
        warnings_.push_back(std::move(warning));
    if (request_.occluder) read_occluder();
    if (request_.receiver) read_receiver();
    unchanged.check();
}

void BakeInputs::add_mesh_warnings(const char* which, const std::vector<std::string>& warnings) {
    for (const std::string& warning : warnings) warnings_.push_back(std::string("the ") + which + ": " + warning);
}

void BakeInputs::read_occluder() {
    MeshFile file = read_mesh_file(*request_.occluder);
    MeshFacts& facts = facts_.occluder.emplace(facts_of(file));
    const MeshFit fit = fit_of(file.mesh, facts.topology.closed, {hair_->positions, hair_->strand_begin});
    facts.vertices_looked_at = fit.looked_at;
    facts.vertices_inside = fit.inside;
    add_mesh_warnings("occluder", file.warnings);
    add_mesh_warnings("occluder", fit.warnings);
    if (!facts.topology.closed)
        warnings_.push_back("the occluder is not closed (" + shell_of(facts.topology) +
                            "): it is taken as a shell that stops light from both sides");
    occluder_ = std::move(file.mesh);
}

void BakeInputs::read_receiver() {
    MeshFile file = read_mesh_file(*request_.receiver);
    facts_.receiver = facts_of(file);
    if (!receiver_is_occluder()) {  // else its warnings are there already
        add_mesh_warnings("receiver", file.warnings);
        add_mesh_warnings("receiver", place_warnings(file.mesh, {hair_->positions, hair_->strand_begin}));
    }
    receiver_ = std::move(file.mesh);
}

void BakeInputs::read_sky(Progress& progress) {
    const std::string& path = *request_.environment;
    const auto files = find_environment_files(path).files;
    const UnchangedFiles unchanged({files.begin(), files.end()});
    facts_.digests["environment"] = digest_of_environment(path);
    environment_ = read_environment(path, request_.environment_settings, progress);
    unchanged.check();
    warnings_.insert(warnings_.end(), environment_->warnings.begin(), environment_->warnings.end());
}

bool BakeInputs::receiver_is_occluder() const {
    return request_.receiver && request_.occluder && facts_.digests.at("receiver") == facts_.digests.at("occluder");
}

const StrandGeometry& BakeInputs::strands() {
    HAIRBAKE_ASSERT(hair_.has_value());
    if (strands_) return *strands_;
    naming_file(*request_.hair, [&] { strands_ = make_strand_geometry(*hair_, request_.strand); });
    return *strands_;
}

void BakeInputs::release_unless_read_by(std::span<const Stage* const> stages) {
    if (!read(stages, "hair")) strands_.reset();
}

InputFacts BakeInputs::take_facts(bool keep_pixels) {
    if (environment_ && !keep_pixels) environment_->pixels = {};
    facts_.environment = std::move(environment_);
    return std::move(facts_);
}

}  // namespace hairbake
