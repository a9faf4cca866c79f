#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include <cpl_conv.h>
#include <cpl_string.h>
#include <fmt/format.h>
#include <ogr_geometry.h>
#include <ogrsf_frmts.h>

#include "geo/gdal.hpp"
#include "geo/spatial_reference.hpp"
#include "geo/vector.hpp"

namespace talus::geo {

namespace {

std::unique_ptr<OGRLinearRing> to_ring(const Ring& ring) {
    auto result = std::make_unique<OGRLinearRing>();
    for (const PlanPoint& p : ring) result->addPoint(p.x, p.y);
    result->closeRings();
    return result;
}

bool is_point(const OutputFeature& feature) {
    return feature.polygon.empty() && feature.line.size() == 1;
}

bool has_measures(const OutputFeature& feature) {
    return !feature.line.empty() && feature.z.size() == feature.line.size() && feature.m.size() == feature.line.size();
}

std::unique_ptr<OGRGeometry> to_geometry(const OutputFeature& feature) {
    if (!feature.polygon.empty()) {
        auto all = std::make_unique<OGRMultiPolygon>();
        for (const Polygon& polygon : feature.polygon) {
            auto part = std::make_unique<OGRPolygon>();
            part->addRingDirectly(to_ring(polygon.outer).release());
            for (const Ring& hole : polygon.holes) part->addRingDirectly(to_ring(hole).release());
            all->addGeometryDirectly(part.release());
        }
        all->flattenTo2D();
        return all;
    }
    if (feature.line.empty()) return nullptr;
    if (is_point(feature)) return std::make_unique<OGRPoint>(feature.line[0].x, feature.line[0].y);
    auto line = std::make_unique<OGRLineString>();
    if (has_measures(feature)) {
        for (std::size_t k = 0; k < feature.line.size(); ++k) {
            line->addPoint(feature.line[k].x, feature.line[k].y, feature.z[k], feature.m[k]);
        }
        return line;
    }
    for (const PlanPoint& p : feature.line) line->addPoint(p.x, p.y);
    line->flattenTo2D();
    return line;
}

OGRwkbGeometryType type_of(const std::vector<OutputFeature>& features) {
    const auto is_polygon = [](const OutputFeature& f) { return !f.polygon.empty(); };
    const auto is_line = [](const OutputFeature& f) { return f.polygon.empty() && f.line.size() > 1; };
    if (features.empty()) return wkbUnknown;
    if (std::all_of(features.begin(), features.end(), is_polygon)) return wkbMultiPolygon;
    if (std::all_of(features.begin(), features.end(), is_line)) {
        return std::all_of(features.begin(), features.end(), has_measures) ? wkbLineStringZM : wkbLineString;
    }
    if (std::all_of(features.begin(), features.end(), is_point)) return wkbPoint;
    return wkbUnknown;
}

bool write_feature(OGRLayer& layer, const OutputFeature& from) {
    OGRFeature feature(layer.GetLayerDefn());
    for (std::size_t i = 0; i < from.values.size(); ++i) {
        const int field = static_cast<int>(i);
        if (const auto* number = std::get_if<double>(&from.values[i]); number && std::isfinite(*number))
            feature.SetField(field, *number);
        if (const auto* text = std::get_if<std::string>(&from.values[i])) feature.SetField(field, text->c_str());
    }
    if (auto geometry = to_geometry(from)) feature.SetGeometryDirectly(geometry.release());
    return layer.CreateFeature(&feature) == OGRERR_NONE;
}

GDALDatasetUniquePtr open_geopackage(const std::string& file) {
    // SQLite would wait for the disk several times per layer. As every other product, the file is in a folder that gets
    // its name when it is complete. SQLite reads the option when it opens the file.
    const CPLConfigOptionSetter no_waiting("OGR_SQLITE_SYNCHRONOUS", "OFF", false);
    VSIStatBufL existing;
    if (VSIStatL(file.c_str(), &existing) == 0) {
        return GDALDatasetUniquePtr(
            GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE | GDAL_OF_VERBOSE_ERROR));
    }
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
    return GDALDatasetUniquePtr(driver != nullptr ? driver->Create(file.c_str(), 0, 0, 0, GDT_Unknown, nullptr)
                                                  : nullptr);
}

}  // namespace

Status write_geopackage_layer(const std::string& file, const std::string& layer, const std::vector<Field>& fields,
                              const std::vector<OutputFeature>& features, const Crs& crs) {
    GdalMessages messages;
    const auto failed = [&] {
        return Error{fmt::format("{}: layer \"{}\" cannot be written: {}", file, layer,
                                 messages.failure_or("GDAL gave no reason"))};
    };
    GDALDatasetUniquePtr data = open_geopackage(file);
    if (!data) return failed();

    OGRSpatialReference reference = to_spatial_reference(crs);
    OGRLayer* target =
        data->CreateLayer(layer.c_str(), reference.IsEmpty() == 0 ? &reference : nullptr, type_of(features), nullptr);
    if (target == nullptr) return failed();
    for (const Field& field : fields) {
        OGRFieldDefn column(field.name.c_str(), field.is_text ? OFTString : OFTReal);
        if (target->CreateField(&column) != OGRERR_NONE) return failed();
    }
    if (data->StartTransaction() != OGRERR_NONE) return failed();
    for (const OutputFeature& feature : features) {
        if (!write_feature(*target, feature)) return failed();
    }
    if (data->CommitTransaction() != OGRERR_NONE) return failed();
    data.reset();  // disk errors may be reported only here
    if (messages.has_failure()) return failed();
    return {};
}

Status write_geopackage_styles(const std::string& file, const std::vector<LayerStyle>& styles) {
    GdalMessages messages;
    const auto failed = [&] {
        return Error{
            fmt::format("{}: its styles cannot be written: {}", file, messages.failure_or("GDAL gave no reason"))};
    };
    GDALDatasetUniquePtr data = open_geopackage(file);
    if (!data) return failed();
    // The columns are those that QGIS itself makes.
    CPLStringList options;
    options.SetNameValue("FID", "id");
    OGRLayer* table = data->CreateLayer("layer_styles", nullptr, wkbNone, options.List());
    if (table == nullptr) return failed();
    for (const char* name : {"f_table_catalog", "f_table_schema", "f_table_name", "f_geometry_column", "styleName",
                             "styleQML", "styleSLD", "description", "owner", "ui"}) {
        OGRFieldDefn column(name, OFTString);
        if (table->CreateField(&column) != OGRERR_NONE) return failed();
    }
    OGRFieldDefn by_default("useAsDefault", OFTInteger), time("update_time", OFTDateTime);
    by_default.SetSubType(OFSTBoolean);
    if (table->CreateField(&by_default) != OGRERR_NONE || table->CreateField(&time) != OGRERR_NONE) return failed();
    for (const LayerStyle& style : styles) {
        OGRFeature feature(table->GetLayerDefn());
        feature.SetField("f_table_catalog", "");
        feature.SetField("f_table_schema", "");
        feature.SetField("f_table_name", style.layer.c_str());
        feature.SetField("f_geometry_column", "geom");
        feature.SetField("styleName", style.layer.c_str());
        feature.SetField("styleQML", style.qml.c_str());
        feature.SetField("useAsDefault", 1);
        if (table->CreateFeature(&feature) != OGRERR_NONE) return failed();
    }
    data.reset();
    if (messages.has_failure()) return failed();
    return {};
}

}  // namespace talus::geo
