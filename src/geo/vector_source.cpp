#include "geo/vector_source.hpp"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/file_name.hpp"
#include "geo/gdal.hpp"
#include "geo/spatial_reference.hpp"

namespace talus::geo {
namespace {

std::string layer_names(GDALDataset& data) {
    std::string names;
    for (int i = 0; i < data.GetLayerCount(); ++i) {
        names += (i == 0 ? "" : ", ") + std::string(data.GetLayer(i)->GetName());
    }
    return names;
}

Result<OGRLayer*> find_layer(const std::string& file, const std::string& name, GDALDataset& data) {
    const int count = data.GetLayerCount();
    if (count == 0) return Error{fmt::format("{}: holds no layer", file)};
    if (!name.empty()) {
        OGRLayer* layer = data.GetLayerByName(name.c_str());
        if (layer == nullptr) {
            return Error{fmt::format("{}: has no layer \"{}\"; its layers: {}", file, name, layer_names(data))};
        }
        return layer;
    }
    if (count > 1) {
        return Error{fmt::format(
            "{}: has {} layers; name one of them with layer = \"...\" in the scene, or as {}|layername=NAME: "
            "{}",
            file, count, file, layer_names(data))};
    }
    return data.GetLayer(0);
}

/// Fills in how to get from the layer's coordinates to the terrain's.
Status find_transformation(const std::string& file, const Crs& terrain_crs, VectorSource& source) {
    const OGRSpatialReference from(*source.layer->GetSpatialRef());
    const OGRSpatialReference to = to_spatial_reference(terrain_crs);
    if (to.IsEmpty() != 0) return {};
    const bool same = same_crs(from, to);
    // The layer's own axis mapping says in which order its file stores the axes; only x east, y north needs no change.
    if (same && from.GetDataAxisToSRSAxisMapping() == to.GetDataAxisToSRSAxisMapping()) return {};

    OGREnvelope envelope;
    const bool has_envelope = source.layer->GetExtent(&envelope, TRUE) == OGRERR_NONE;
    const auto works = [&] {
        if (!source.transformation) return false;
        if (!has_envelope) return true;
        double x = (envelope.MinX + envelope.MaxX) / 2, y = (envelope.MinY + envelope.MaxY) / 2;
        return source.transformation->Transform(1, &x, &y) != 0 && std::isfinite(x) && std::isfinite(y);
    };
    // PROJ falls back to ignoring the datum: first try to find a real transformation.
    GdalMessages messages;
    OGRCoordinateTransformationOptions options;
    options.SetBallparkAllowed(false);
    source.transformation.reset(OGRCreateCoordinateTransformation(&from, &to, options));
    std::string warning;
    if (!works()) {
        source.transformation.reset(OGRCreateCoordinateTransformation(&from, &to));
        if (!works()) {
            constexpr std::size_t longest = 160;  // PROJ may print both systems as WKT
            const std::string reason = messages.failure_or("");
            return Error{
                fmt::format("{}: cannot be brought from {} to {}: {}", file, source.crs.label(), terrain_crs.label(),
                            reason.empty() || reason.size() > longest ? "no transformation is known" : reason)};
        }
        warning = " without a known change of datum: positions may be off by hundreds of metres";
    }
    if (!same) {
        source.reprojection =
            fmt::format("reprojected from {} to {}{}", source.crs.label(), terrain_crs.label(), warning);
    }
    return {};
}

/// A layer on a terrain in local coordinates, of which nobody knows where they lie.
Status take_as_local(const std::string& file, const Crs& terrain_crs, VectorSource& source) {
    const bool undefined = is_undefined(source.layer->GetSpatialRef());
    if (source.crs.local && !undefined) return {};
    // GeoJSON without the member crs reads as WGS 84.
    const bool geojson = was_geojson(*source.data, *source.layer) && source.crs.epsg == 4326;
    if (!undefined && !geojson) {
        return Error{fmt::format("{}: is in {}, the terrain in local coordinates; give the layer in those", file,
                                 source.crs.label())};
    }
    source.crs = terrain_crs;
    source.reprojection = "states no coordinate reference system, taken to be in the terrain's local coordinates";
    return {};
}

}  // namespace

Result<VectorSource> open_layer(const std::string& name, const std::string& layer, const Crs& terrain_crs) {
    TALUS_ASSIGN(const LayerOfFile named, split_layer(name));
    const std::string& file = named.file;
    if (!layer.empty() && !named.layer.empty() && layer != named.layer) {
        return Error{fmt::format("{}: names the layer \"{}\", and layer = \"{}\" another", name, named.layer, layer)};
    }
    VectorSource source;
    TALUS_ASSIGN(source.data, open_dataset(file, GDAL_OF_VECTOR, "vector file"));
    GdalMessages messages;
    TALUS_ASSIGN(source.layer, find_layer(file, layer.empty() ? named.layer : layer, *source.data));

    source.feature_count = source.layer->GetFeatureCount(TRUE);
    if (messages.has_failure()) {
        return Error{fmt::format("{}: the file is damaged or cut short: {}", file, messages.failure_or(""))};
    }
    if (source.feature_count == 0) {
        return Error{fmt::format("{}: layer \"{}\" has no features", file, source.layer->GetName())};
    }
    if (source.layer->GetLayerDefn()->GetGeomFieldCount() == 0) {
        return Error{fmt::format("{}: layer \"{}\" is a table without geometry", file, source.layer->GetName())};
    }
    const OGRSpatialReference* reference = source.layer->GetSpatialRef();
    if (reference != nullptr) source.crs = to_crs(*reference);
    if (!terrain_crs.local && (is_undefined(reference) || source.crs.local)) {
        const char* const fault = is_undefined(reference) ? "states no coordinate reference system"
                                                          : "has local coordinates, which the terrain has not";
        return Error{
            fmt::format("{}: layer \"{}\" {}; give it the code of the one it is in: ogr2ogr -a_srs EPSG:nnnn {} {}",
                        file, source.layer->GetName(), fault, mended_name(file, "_crs", ".gpkg"), shell_quoted(file))};
    }
    TALUS_TRY(terrain_crs.local ? take_as_local(file, terrain_crs, source)
                                : find_transformation(file, terrain_crs, source));
    return Result<VectorSource>(std::move(source));
}

}  // namespace talus::geo
