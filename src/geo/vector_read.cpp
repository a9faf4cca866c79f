#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>
#include <ogr_geometry.h>
#include <ogrsf_frmts.h>

#include "core/lower_case.hpp"
#include "core/try.hpp"
#include "core/utf8.hpp"
#include "geo/closed_line.hpp"
#include "geo/file_name.hpp"
#include "geo/gdal.hpp"
#include "geo/vector.hpp"
#include "geo/vector_source.hpp"

namespace talus::geo {

namespace {

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

Result<ReadFeature> next_feature(const std::string& file, VectorSource& source, GIntBig number) {
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
Status transform(const std::string& file, const VectorSource& source, ReadFeature& read) {
    if (!source.transformation) return {};
    GdalMessages messages;
    if (read.geometry->transform(source.transformation.get()) == OGRERR_NONE) return {};
    return Error{fmt::format("{}: {} cannot be brought into the terrain's CRS: {}", file, read.label,
                             messages.failure_or("it lies outside the area of the CRS"))};
}

/// Refuses polygons whose inside and outside are ambiguous, with the place.
Status check_valid(const std::string& file, const VectorSource& source, const ReadFeature& read) {
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
