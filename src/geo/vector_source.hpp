#pragma once

#include <memory>
#include <string>

#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include "core/result.hpp"
#include "geo/crs.hpp"

namespace talus::geo {

/// A layer that has features and a CRS, and the transformation to the terrain's CRS.
struct VectorSource {
    GDALDatasetUniquePtr data;
    OGRLayer* layer = nullptr;
    Crs crs;
    std::unique_ptr<OGRCoordinateTransformation> transformation;  ///< none: coordinates need no change
    std::string reprojection;
    GIntBig feature_count = 0;
};

/// Errors: no such layer, or several and none named; damaged; no features or no geometry; no reference system, or one
/// from which there is no way to the terrain's.
[[nodiscard]] Result<VectorSource> open_layer(const std::string& name, const std::string& layer,
                                              const Crs& terrain_crs);

}  // namespace talus::geo
