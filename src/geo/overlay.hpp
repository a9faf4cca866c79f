#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/geometry.hpp"
#include "core/result.hpp"
#include "geo/crs.hpp"
#include "geo/layer_style.hpp"

/// Layers that people lay over the terrain of a session: roads, parcels, geology, a map. They take no part in a run.
/// The files are those that convert_foreign has written again.
namespace talus::geo {

/// Of one layer.
struct OverlayLimits {
    std::size_t features = 20'000, points = 400'000, bytes = 8'000'000;
    int pixels = 3072;  ///< of the longer edge of a picture
};

/// Of the layers of one file together.
struct OverlayFileLimits {
    std::size_t layers = 20, bytes = 24'000'000;
};

/// Where overlays lie.
struct OverlayGround {
    Crs crs;
    Extent extent;  ///< of the terrain
};

/// Features cut to the terrain, in its reference system.
struct VectorOverlay {
    std::string name;
    /// JSON: {"styles": [style], "features": [{"kind": "point" | "line" | "area", "parts": [[x, y, ...]], "name": text,
    /// "attributes": {key: value}, "style": index or -1}]}; x and y in metres from the south-west corner of the
    /// terrain; parts of an area are its rings, inside by the even-odd rule.
    std::string json;
    std::size_t features = 0, outside = 0;  ///< kept; left out, because they lie beside the terrain
    bool styled = false;                    ///< by the file
    std::string note;                       ///< of its reference system; empty: nothing to say
};

/// Every layer of a GeoPackage with features on the terrain; `symbols`: of each layer of the file. Errors name the
/// layer: no features on the terrain in any, beyond the limits, no known transformation.
[[nodiscard]] Result<std::vector<VectorOverlay>> read_vector_overlays(const std::string& file,
                                                                      const std::vector<LayerSymbols>& symbols,
                                                                      const OverlayGround& ground,
                                                                      const OverlayLimits& limits,
                                                                      const OverlayFileLimits& together = {});

/// Whether a text is the `json` of a VectorOverlay within the limits: a saved session may come from anybody. Errors say
/// what is wrong.
[[nodiscard]] Status check_overlay_text(const std::string& text, const OverlayLimits& limits);

/// A picture over the whole terrain, transparent where the file has nothing.
struct PictureOverlay {
    std::string bytes, type;  ///< as of an Orthophoto
    int columns = 0, rows = 0;
    /// Of a raster of values, which a colour ramp shows: those at its ends.
    bool has_range = false;
    double low = 0, high = 0;
    std::string note;
};

/// Pictures as they are, rasters of values by a colour ramp. Errors: as read_orthophoto.
[[nodiscard]] Result<PictureOverlay> read_picture_overlay(const std::string& file, const OverlayGround& ground,
                                                          const OverlayLimits& limits);

}  // namespace talus::geo
