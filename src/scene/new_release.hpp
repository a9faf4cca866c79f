#pragma once

#include <filesystem>
#include <string>

#include "core/result.hpp"
#include "geo/vector.hpp"
#include "params/spec.hpp"

/// Some features of a layer as the release of a new scene.
namespace talus::scene {

/// Keeps the features that `which` names: "12", the number that GIS programs show (fid), or "NAME=VALUE", the name of
/// an attribute in any case. Errors: none is, no such attribute.
[[nodiscard]] Status choose_features(const std::string& file, const std::string& which, geo::PolygonLayer& layer);

/// Writes them as release.gpkg into the folder, and names that as the release's file.
[[nodiscard]] Status write_features(const geo::PolygonLayer& layer, const geo::Crs& crs,
                                    const std::filesystem::path& folder, params::ReleaseSpec& release);

}  // namespace talus::scene
