// Keys of the two stages and of the whole bake: digests of exactly what each reads.
#pragma once

#include <string>

#include "core/request/request.h"

namespace hairbake {

/// Part of the stage keys: raised when a stage's algorithm changes its numbers, so that no stored result is mistaken
/// for a new one.
inline constexpr int transmittance_algorithm = 2;
inline constexpr int irradiance_algorithm = 2;
inline constexpr int output_format = 1;

/// SHA-256 of the files that the transmittance stage reads; empty where there is none.
struct TransmittanceInputs {
    std::string hair, occluder, receiver;
};

/// SHA-256 of the digests of the stage's files, the strand and transmittance settings and the algorithm's version;
/// knows nothing of the lighting or of where the files lie.
std::string transmittance_key(const TransmittanceInputs& digests, const BakeRequest& request);

/// SHA-256 of the environment file's digest, the irradiance settings and the algorithm's version; knows nothing of
/// the hair.
std::string irradiance_key(const std::string& environment_digest, const BakeRequest& request);

/// SHA-256 of the two stage keys (empty for a stage that does not run), the set of outputs and their version.
std::string bake_id(const std::string& transmittance_key, const std::string& irradiance_key,
                    const BakeRequest& request);

}  // namespace hairbake
