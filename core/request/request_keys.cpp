#include "core/request/request_keys.h"

#include <algorithm>

#include "core/base/digest.h"
#include "core/request/request_json.h"

namespace hairbake {

std::string transmittance_key(const TransmittanceInputs& digests, const BakeRequest& request) {
    return Digest()
        .add("hairbake transmittance " + std::to_string(transmittance_algorithm) + "\n")
        .add(digests.hair + "\n" + digests.occluder + "\n" + digests.receiver + "\n")
        .add(canonical_transmittance_settings(request))
        .hex();
}

std::string irradiance_key(const std::string& environment_digest, const BakeRequest& request) {
    return Digest()
        .add("hairbake irradiance " + std::to_string(irradiance_algorithm) + "\n")
        .add(environment_digest + "\n" + canonical_irradiance_settings(request))
        .hex();
}

std::string bake_id(const std::string& transmittance_key, const std::string& irradiance_key,
                    const BakeRequest& request) {
    std::vector<std::string> outputs = request.outputs;
    std::sort(outputs.begin(), outputs.end());
    Digest digest;
    digest.add("hairbake bake " + std::to_string(output_format) + "\n");
    digest.add(transmittance_key + "\n" + irradiance_key + "\n");
    for (const std::string& output : outputs) digest.add(output + "\n");
    return digest.hex();
}

}  // namespace hairbake
