#include "core/output/versions.h"

#include <OpenImageIO/oiioversion.h>
#include <embree3/rtcore_config.h>
#include <openvdb/version.h>

namespace hairbake {

std::string version() { return HAIRBAKE_VERSION; }

std::vector<std::pair<std::string, std::string>> library_versions() {
    return {{"embree", RTC_VERSION_STRING},
            {"openimageio", OIIO_VERSION_STRING},
            {"openvdb", OPENVDB_LIBRARY_VERSION_STRING}};
}

}  // namespace hairbake
