// Inputs that bake quickly: a small sample groom and sky in a temporary folder.
#pragma once

#include "core/request/request.h"
#include "core/sample/sample.h"
#include "tests/support/temporary_folder.h"

namespace hairbake::test_support {

/// The constructor writes the samples. They are removed with the object.
class SmallInputs {
public:
    SmallInputs() {
        SampleSettings settings;
        settings.style = GroomStyle::wavy;
        settings.vertices = 3000;
        settings.map_width = 64;
        Progress progress;
        write_samples(folder / "samples", settings, progress);
    }

    /// A request that bakes in well under a second.
    BakeRequest request() const {
        BakeRequest request;
        request.hair = (folder / "samples" / "groom.hair").string();
        request.environment = (folder / "samples" / "sky.hdr").string();
        request.transmittance.method = TransmittanceMethod::volume;
        request.transmittance.directions = 16;
        request.transmittance.voxels = 32;
        request.transmittance.reference_vertices = 20;
        request.irradiance.face_size = 4;
        request.irradiance.specular_maps = 3;
        return request;
    }

    TemporaryFolder folder;
};

}  // namespace hairbake::test_support
