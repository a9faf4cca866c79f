#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <ogr_geometry.h>
#include <ogrsf_frmts.h>

#include "core/lower_case.hpp"
#include "core/try.hpp"
#include "core/utf8.hpp"
#include "geo/closed_line.hpp"
#include "geo/file_name.hpp"
#include "geo/gdal.hpp"
#include "geo/spatial_reference.hpp"
#include "geo/vector.hpp"

namespace talus::geo {

namespace {

/// A layer that has features and a CRS, and the transformation to the terrain's CRS.
struct Source {
    GDALDatasetUniquePtr data;
    OGRLayer* layer = nullptr;
    Crs crs;
    std::unique_ptr<OGRCoordinateTransformation> transformation;  ///< none: coordinates need no change
    std::string reprojection;
    GIntBig feature_count = 0;
};

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
Status find_transformation(const std::string& file, const Crs& terrain_crs, Source& source) {
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
Status take_as_local(const std::string& file, const Crs& terrain_crs, Source& source) {
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

Result<Source> open_layer(const std::string& name, const std::string& layer, const Crs& terrain_crs) {
    TALUS_ASSIGN(const LayerOfFile named, split_layer(name));
    const std::string& file = named.file;
    if (!layer.empty() && !named.layer.empty() && layer != named.layer) {
        return Error{fmt::format("{}: names the layer \"{}\", and layer = \"{}\" another", name, named.layer, layer)};
    }
    Source source;
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
    return Result<Source>(std::move(source));
}

/// "feature 3 (fid 2)": the place in the layer, and the number that GIS programs show.
std::string feature_label(GIntBig number, const OGRFeature& feature) {
    return fmt::format("feature {} (fid {})", number, feature.GetFID());
}

/// `encoding_assumed` becomes true where text is not UTF-8, as that of a .dbf without .cpg.
std::map<std::string, Attribute> attributes_of(const OGRFeature& feature, bool& encoding_assumed) {
    std::map<std::string, Attribute> attributes;
    const auto text = [&](const char* written) {
        std::string valid = to_utf8(written);
        encoding_assumed = encoding_assumed || valid != written;
        return valid;
    };
    for (int i = 0; i < feature.GetFieldCount(); ++i) {
        const OGRFieldDefn* field = feature.GetFieldDefnRef(i);
        Attribute value;
        if (feature.IsFieldSetAndNotNull(i) != 0) {
            switch (field->GetType()) {
                case OFTInteger:
                case OFTInteger64:
                case OFTReal:
                    if (const double number = feature.GetFieldAsDouble(i); std::isfinite(number)) value = number;
                    break;
                default:
                    value = text(feature.GetFieldAsString(i));
            }
        }
        attributes[text(field->GetNameRef())] = value;
    }
    return attributes;
}

/// The feature's attribute "name", in any case; empty: it has none.
std::string name_of(const OGRFeature& feature) {
    bool ignored = false;
    for (const auto& [key, value] : attributes_of(feature, ignored)) {
        const auto* text = std::get_if<std::string>(&value);
        if (lower_case(key) == "name" && text != nullptr) return *text;
    }
    return "";
}

/// A flat copy: no curves, heights or measures.
std::unique_ptr<OGRGeometry> flat(const OGRGeometry& geometry) {
    std::unique_ptr<OGRGeometry> copy(geometry.hasCurveGeometry() != 0 ? geometry.getLinearGeometry()
                                                                       : geometry.clone());
    if (copy) {
        copy->flattenTo2D();
        copy->setMeasured(FALSE);
    }
    return copy;
}

std::vector<PlanPoint> points_of(const OGRSimpleCurve& curve) {
    std::vector<PlanPoint> points;
    for (int i = 0; i < curve.getNumPoints(); ++i) {
        const PlanPoint p{curve.getX(i), curve.getY(i)};
        if (points.empty() || p.x != points.back().x || p.y != points.back().y) points.push_back(p);
    }
    return points;
}

Ring ring_of(const OGRLinearRing& ring) {
    Ring points = points_of(ring);
    while (points.size() > 1 && points.front().x == points.back().x && points.front().y == points.back().y) {
        points.pop_back();
    }
    return points;
}

/// Collects the polygons of a geometry; false if it holds anything else.
bool collect_polygons(const OGRGeometry& geometry, std::vector<Polygon>& polygons) {
    switch (wkbFlatten(geometry.getGeometryType())) {
        case wkbPolygon: {
            const OGRPolygon& from = *geometry.toPolygon();
            Polygon polygon;
            polygon.outer = ring_of(*from.getExteriorRing());
            for (int i = 0; i < from.getNumInteriorRings(); ++i) {
                polygon.holes.push_back(ring_of(*from.getInteriorRing(i)));
            }
            polygons.push_back(std::move(polygon));
            return true;
        }
        case wkbMultiPolygon:
        case wkbGeometryCollection: {
            bool all = true;
            for (const OGRGeometry* part : *geometry.toGeometryCollection()) {
                all = all && (part->IsEmpty() != 0 || collect_polygons(*part, polygons));
            }
            return all;
        }
        default:
            return false;
    }
}

/// Collects the lines of a geometry, in order; false if it holds anything else.
bool collect_lines(const OGRGeometry& geometry, std::vector<std::vector<PlanPoint>>& lines) {
    switch (wkbFlatten(geometry.getGeometryType())) {
        case wkbLineString:
            lines.push_back(points_of(*geometry.toLineString()));
            return true;
        case wkbMultiLineString:
        case wkbGeometryCollection: {
            bool all = true;
            for (const OGRGeometry* part : *geometry.toGeometryCollection()) {
                all = all && (part->IsEmpty() != 0 || collect_lines(*part, lines));
            }
            return all;
        }
        default:
            return false;
    }
}

/// Reads the next feature with its flat geometry, still in the layer's CRS. `geometry` is null after the last.
struct ReadFeature {
    OGRFeatureUniquePtr feature;
    std::unique_ptr<OGRGeometry> geometry;
    std::string label;
};

Result<ReadFeature> next_feature(const std::string& file, Source& source, GIntBig number) {
    GdalMessages messages;
    ReadFeature read;
    read.feature.reset(source.layer->GetNextFeature());
    if (messages.has_failure()) {
        return Error{fmt::format("{}: the file is damaged or cut short at feature {}: {}", file, number,
                                 messages.failure_or(""))};
    }
    if (!read.feature) return Result<ReadFeature>(std::move(read));
    read.label = feature_label(number, *read.feature);
    const OGRGeometry* geometry = read.feature->GetGeometryRef();
    if (geometry == nullptr || geometry->IsEmpty() != 0) {
        return Error{fmt::format("{}: {} has no geometry; draw it or delete the feature", file, read.label)};
    }
    read.geometry = flat(*geometry);
    if (!read.geometry) {
        return Error{fmt::format("{}: {} has a geometry that cannot be flattened", file, read.label)};
    }
    return Result<ReadFeature>(std::move(read));
}

Error wrong_geometry(const std::string& file, const ReadFeature& read, const std::string& wanted) {
    return {fmt::format("{}: {} is a {}, {} is needed", file, read.label,
                        OGRGeometryTypeToName(wkbFlatten(read.feature->GetGeometryRef()->getGeometryType())), wanted)};
}

/// Transforms a geometry to the terrain's CRS.
Status transform(const std::string& file, const Source& source, ReadFeature& read) {
    if (!source.transformation) return {};
    GdalMessages messages;
    if (read.geometry->transform(source.transformation.get()) == OGRERR_NONE) return {};
    return Error{fmt::format("{}: {} cannot be brought into the terrain's CRS: {}", file, read.label,
                             messages.failure_or("it lies outside the area of the CRS"))};
}

/// Refuses polygons whose inside and outside are ambiguous, with the place.
Status check_valid(const std::string& file, const Source& source, const ReadFeature& read) {
    if (!OGRGeometryFactory::haveGEOS()) {
        return Error{fmt::format("{}: this GDAL was built without GEOS, polygons cannot be checked", file)};
    }
    GdalMessages messages;
    if (read.geometry->IsValid() != 0) return {};
    return Error{fmt::format("{}: {} is not a valid polygon: {} ({}); mend it: ogr2ogr -makevalid {} {}", file,
                             read.label, messages.warning_or(messages.failure_or("self-intersection")),
                             source.crs.label(), mended_name(file, "_valid", ".gpkg"), shell_quoted(file))};
}

bool same_place(const PlanPoint& a, const PlanPoint& b) {
    constexpr double tolerance = 1e-3;  // m
    return std::hypot(a.x - b.x, a.y - b.y) <= tolerance;
}

/// Joins parts that follow each other end to end, each either way round.
Result<std::vector<PlanPoint>> join(const std::string& file, const std::string& label,
                                    std::vector<std::vector<PlanPoint>> parts) {
    std::vector<PlanPoint> line = std::move(parts.front());
    for (std::size_t i = 1; i < parts.size(); ++i) {
        std::vector<PlanPoint>& part = parts[i];
        // Only the first part may still be reversed: the second decides which of its ends is the inner one.
        if (i == 1 && !same_place(line.back(), part.front()) && !same_place(line.back(), part.back())) {
            std::reverse(line.begin(), line.end());
        }
        if (!same_place(line.back(), part.front())) std::reverse(part.begin(), part.end());
        if (!same_place(line.back(), part.front())) {
            return Error{fmt::format("{}: {} has parts that are not connected: part {} does not begin at {:.2f} {:.2f}",
                                     file, label, i + 1, line.back().x, line.back().y)};
        }
        line.insert(line.end(), part.begin() + 1, part.end());
    }
    return line;
}

}  // namespace

Result<PolygonLayer> read_polygons(const std::string& file, const std::string& layer, const Crs& terrain_crs) {
    TALUS_ASSIGN(auto source, open_layer(file, layer, terrain_crs));
    PolygonLayer result;
    result.reprojection = source.reprojection;
    source.layer->ResetReading();
    const OGRSpatialReference* const reference = source.layer->GetSpatialRef();
    const bool geographic = !terrain_crs.local && reference != nullptr && reference->IsGeographic() != 0;
    for (GIntBig number = 1;; ++number) {
        TALUS_ASSIGN(auto read, next_feature(file, source, number));
        if (!read.feature) break;
        auto closed = polygon_of_line(*read.geometry, geographic);
        if (!closed) return Error{fmt::format("{}: {} {}", file, read.label, closed.error().message)};
        if (*closed) {
            read.geometry = std::move(*closed);
            ++result.closed_lines;
        }
        read.geometry->closeRings();
        PolygonFeature feature;
        feature.fid = read.feature->GetFID();
        if (!collect_polygons(*read.geometry, feature.parts) || feature.parts.empty()) {
            return wrong_geometry(file, read, "a polygon");
        }
        TALUS_TRY(check_valid(file, source, read));
        TALUS_TRY(transform(file, source, read));
        feature.parts.clear();
        collect_polygons(*read.geometry, feature.parts);
        feature.attributes = attributes_of(*read.feature, result.encoding_assumed);
        result.features.push_back(std::move(feature));
    }
    if (result.features.empty()) {
        return Error{fmt::format("{}: layer \"{}\" has no features", file, source.layer->GetName())};
    }
    return result;
}

Result<LineLayer> read_lines(const std::string& file, const std::string& layer, const Crs& terrain_crs) {
    TALUS_ASSIGN(auto source, open_layer(file, layer, terrain_crs));
    LineLayer result;
    result.reprojection = source.reprojection;
    source.layer->ResetReading();
    for (GIntBig number = 1;; ++number) {
        TALUS_ASSIGN(auto read, next_feature(file, source, number));
        if (!read.feature) break;
        TALUS_TRY(transform(file, source, read));
        std::vector<std::vector<PlanPoint>> parts;
        if (!collect_lines(*read.geometry, parts) || parts.empty()) return wrong_geometry(file, read, "a line");
        TALUS_ASSIGN(auto line, join(file, read.label, std::move(parts)));
        if (line.size() < 2) {
            return Error{fmt::format("{}: {} has a single point, a line needs two", file, read.label)};
        }
        result.features.push_back({std::move(line), name_of(*read.feature)});
    }
    if (result.features.empty()) {
        return Error{fmt::format("{}: layer \"{}\" has no features", file, source.layer->GetName())};
    }
    return result;
}

Result<SingleLine> read_line(const std::string& file, const std::string& layer, const Crs& terrain_crs) {
    TALUS_ASSIGN(LineLayer lines, read_lines(file, layer, terrain_crs));
    if (lines.features.size() == 1) {
        return SingleLine{std::move(lines.features.front().points), lines.reprojection};
    }
    return Error{
        fmt::format("{}: has {} lines, one is needed; take it out with the number that GIS programs show: "
                    "ogr2ogr -fid N {} {}{}",
                    file, lines.features.size(), mended_name(file, "_one", ".gpkg"), shell_quoted(file),
                    layer.empty() ? "" : " " + shell_quoted(layer))};
}

}  // namespace talus::geo
