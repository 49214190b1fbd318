// The stages of a bake: their inputs and settings, the keys of their results, and the phases of their time.
//
// A stage is the unit of work that has a key, is queued, stored and used again. It is a function of input files and
// settings, never of another stage's files. A new stage is a row of the table in stages.cpp and a row of the table in
// core/stages/stage_table.cpp.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/request/request.h"

namespace hairbake {

/// The version of the files that a result holds; part of every bake's id. docs/contributing.md tells when to raise it.
inline constexpr int output_format = 1;

/// A part of a bake's time, as progress and timings name it.
struct Phase {
    std::string_view name;
    double share;  ///< of the whole, in any unit
};

struct Stage {
    std::string_view name;
    /// Part of the key. Raised when the stage's numbers change, so that no stored result is mistaken for a new one.
    int algorithm;
    std::span<const std::string_view>
        inputs;  ///< fields of the request that name the stage's files, in the key's order
    std::span<const std::string_view> settings;  ///< blocks and fields of the request that it reads
    std::span<const Phase> phases;               ///< of the stage itself, without the reading of inputs
    bool (*asked_for)(const BakeRequest&);
    bool of_first_version;  ///< has a line in every bake's id, also where it does not run
    /// The block whose fields stand at the top level in the key's text of settings, as in the first version; empty for
    /// none.
    std::string_view bare_block;
};

/// All stages, in the order in which a bake runs them.
std::span<const Stage> stages();

/// The outputs in which the stage writes files, as the request's schema lists them (outputs, x-stages).
const std::vector<std::string>& formats_of(const Stage& stage);

/// The numbers on which keys depend, for people: "transmittance 2, irradiance 2, output format 1". Programs of which
/// this text differs make other keys.
std::string versions_text();

/// Null where there is no stage of this name.
const Stage* find_stage(std::string_view name);

/// Whether the stage reads the field of this path ("transmittance.voxels"), an input or a setting. It reads no outputs.
bool reads_field(const Stage& stage, std::string_view path);

/// The stages that the request asks for, in the order of stages().
std::vector<const Stage*> stages_of(const BakeRequest& request);

/// SHA-256 (hex) of input files by the field of the request that names them ("hair"). Fields without a file are absent.
using InputDigests = std::map<std::string, std::string, std::less<>>;

/// Keys of stages by the stage's name.
using StageKeys = std::map<std::string, std::string, std::less<>>;

/// SHA-256 of exactly what the stage reads: its name and algorithm, the digests of its files, and its settings. Paths
/// of files are in no key. Fields of later versions are left out at the value that means the first version's behaviour.
/// Of the block `fiber`, only the chosen model's parameters count.
std::string stage_key(const Stage& stage, const InputDigests& digests, const BakeRequest& request);

/// SHA-256 of the keys of the stages that run, the set of outputs, and output_format.
std::string bake_id(const StageKeys& keys, const BakeRequest& request);

/// The request that runs this stage alone: the stage's inputs and settings, and the outputs in which it writes files,
/// sorted by name. All other fields have their defaults. Requests that differ only in fields that the stage does not
/// read give the same request.
BakeRequest request_alone(const Stage& stage, const BakeRequest& request);

/// The phases of a bake of these stages, in order: all inputs are read first, so that a fault in one is known before
/// the work; "write" is last. Shares sum to 1 and are rough.
std::vector<Phase> planned_phases(std::span<const Stage* const> stages, const BakeRequest& request);

/// The finished share of the whole, in [0, 1], at `fraction` of the phase `name`; 0 for a phase that is not planned.
double fraction_of_whole(std::span<const Phase> phases, std::string_view name, double fraction);

}  // namespace hairbake
