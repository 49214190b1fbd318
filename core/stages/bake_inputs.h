// The input files of a bake: each is read once, before the first stage runs, and shared by the stages.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/environment/environment_map.h"
#include "core/hair/hair_model.h"
#include "core/hair/strand_geometry.h"
#include "core/mesh/triangle_mesh.h"
#include "core/request/request.h"
#include "core/result/bake_result.h"
#include "core/stages/phase_clock.h"

namespace hairbake {

/// Checks the inputs that the stages name, as far as the request has them, by their headers alone.
/// Throws the errors that reading would throw, with the name of the request's field.
void check_headers(const BakeRequest& request, std::span<const Stage* const> stages);

/// Not thread-safe. Every reading function may throw Error(bad_input) naming the file, also where the file changes
/// while it is read: its digest would then be that of other bytes than the bake saw.
class BakeInputs {
public:
    /// All arguments must outlive this object.
    BakeInputs(const BakeRequest& request, PhaseClock& clock) : request_(request), clock_(clock) {}

    /// Reads the files that the stages name, as far as the request has them, in the phases read_hair and
    /// read_environment. Before that it checks the headers of all, so that a fault of the last one is known at once.
    /// Makes the strands, too, where a stage reads their settings: they may lack a width.
    void read_for(std::span<const Stage* const> stages);

    // The results of read_for(). An input that the request does not name is null, or fails a precondition.
    const HairModel& hair() const { return *hair_; }
    const TriangleMesh* occluder() const { return occluder_ ? &*occluder_ : nullptr; }
    const TriangleMesh* receiver() const { return receiver_ ? &*receiver_ : nullptr; }
    /// Whether receiver and occluder are one file.
    bool receiver_is_occluder() const;
    const EnvironmentMap& environment() const { return *environment_; }

    /// The hair's polylines, made from the model at the first call.
    const StrandGeometry& strands();

    const InputDigests& digests() const { return facts_.digests; }
    /// Warnings about what was read since the last call.
    std::vector<std::string> take_warnings() { return std::exchange(warnings_, {}); }

    /// Frees the inputs that none of the `stages` reads and that the result does not need.
    void release_unless_read_by(std::span<const Stage* const> stages);

    /// Facts of what was read. The environment's pixels are kept in them only when `keep_pixels` is set. The
    /// environment is gone from this object afterwards.
    InputFacts take_facts(bool keep_pixels);
    std::optional<HairModel> take_hair() { return std::move(hair_); }

private:
    void read_hair_and_meshes(Progress& progress);
    void read_occluder();
    void read_receiver();
    /// which: "occluder" or "receiver"
    void add_mesh_warnings(const char* which, const std::vector<std::string>& warnings);
    void read_sky(Progress& progress);

    const BakeRequest& request_;
    PhaseClock& clock_;
    InputFacts facts_;
    std::vector<std::string> warnings_;
    std::optional<HairModel> hair_;
    std::optional<StrandGeometry> strands_;
    std::optional<TriangleMesh> occluder_, receiver_;
    std::optional<EnvironmentMap> environment_;
};

}  // namespace hairbake
