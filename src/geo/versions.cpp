#include "geo/versions.hpp"

#include <gdal.h>
#include <ogr_srs_api.h>

namespace talus::geo {

std::string gdal_version() {
    return GDALVersionInfo("RELEASE_NAME");
}

std::string proj_version() {
    // Asking writes to PROJ's default context, from which every thread copies its own: it is asked once, before others
    // work.
    static const std::string version = [] {
        int major = 0, minor = 0, patch = 0;
        OSRGetPROJVersion(&major, &minor, &patch);
        return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
    }();
    return version;
}

}  // namespace talus::geo
