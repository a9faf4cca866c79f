// Reads one file that somebody else made, and hands over its numbers.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>
#include <string_view>

#include <cpl_conv.h>
#include <cpl_string.h>
#include <fmt/format.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include "core/try.hpp"
#include "core/utf8.hpp"
#include "geo/foreign.hpp"
#include "geo/foreign_child.hpp"
#include "geo/foreign_data.hpp"
#include "geo/gdal.hpp"
#include "geo/mesh_faces.hpp"
#include "geo/raster_source.hpp"
#include "geo/spatial_reference.hpp"

namespace talus::geo {
namespace {

namespace fs = std::filesystem;

constexpr double shown_pixels = 2e8;  // of a picture, at most

/// WKT2; a code's own where it is that one.
std::string text_of(const OGRSpatialReference& reference) {
    const GdalMessages messages;
    if (reference.IsEmpty()) return "";
    const auto exported = [](const OGRSpatialReference& from) {
        const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
        char* text = nullptr;
        std::string wkt = from.exportToWkt(&text, options) == OGRERR_NONE ? text : "";
        CPLFree(text);
        return wkt;
    };
    std::string own = exported(reference);
    if (reference.IsCompound() != 0 || reference.IsVertical() != 0) return own;
    if (const int epsg = to_crs(reference).epsg; epsg != 0) {
        OGRSpatialReference of_code;
        if (of_code.importFromEPSG(epsg) == OGRERR_NONE && same_crs(reference, of_code)) return exported(of_code);
    }
    return own;
}

/// The file, its format found and allowed.
class ForeignReading {
  public:
    ForeignReading(std::string file, ForeignWanted wanted, bool isolated, ForeignOutput& out)
        : file_(std::move(file)), wanted_(std::move(wanted)), isolated_(isolated), out_(out) {}

    Status read() {
        if (wanted_.mesh && is_mesh_file(file_)) return read_mesh();
        GDALDriverH found = GDALIdentifyDriverEx(file_.c_str(), GDAL_OF_RASTER | GDAL_OF_VECTOR, nullptr, nullptr);
        const std::string format = found != nullptr ? GDALGetDriverShortName(found) : "";
        if (is_isolated_format(format) && !isolated_) {
            return Error{fmt::format(
                "{}: a file of the format {} is not read where the kernel lacks Landlock or seccomp; save it as "
                "GeoTIFF or GeoPackage",
                file_, format)};
        }
        if (found != nullptr && !is_plain_format(format) && !is_isolated_format(format)) {
            return Error{fmt::format(
                "{}: a file of the format {} may name other files and is not taken; save it as GeoTIFF or GeoPackage",
                file_, format)};
        }
        forget_other_formats(isolated_);
        if (found == nullptr) return none_of_these();
        format_ = format;
        if (wanted_.vector) {
            if (const auto data = open(GDAL_OF_VECTOR); data && data->GetLayerCount() > 0) return read_layers(*data);
        }
        if (wanted_.raster || wanted_.picture) {
            const GdalMessages messages;
            if (const auto data = open(GDAL_OF_RASTER)) return read_raster(*data);
            if (messages.has_failure()) {
                return Error{fmt::format("{}: {}: {}", file_, wanted_.purpose, messages.failure_or(""))};
            }
        }
        return none_of_these();
    }

  private:
    [[nodiscard]] Error none_of_these() const { return {file_ + ": " + wanted_.purpose}; }

    /// With the driver that was found, and no other.
    [[nodiscard]] GDALDatasetUniquePtr open(unsigned flags) const {
        const char* const drivers[] = {format_.c_str(), nullptr};
        CPLStringList options;
        if (format_ == "GPKG" && (flags & GDAL_OF_VECTOR) != 0) options.SetNameValue("LIST_ALL_TABLES", "NO");
        return GDALDatasetUniquePtr(GDALDataset::Open(file_.c_str(), flags | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR,
                                                      drivers, options.List()));
    }

    Status read_mesh();
    Status read_raster(GDALDataset& data);
    Status read_layers(GDALDataset& data);
    void read_styles(std::vector<ForeignLayer>& layers) const;
    Status read_layer(OGRLayer& layer, const std::vector<Field>& fields, bool swapped);
    [[nodiscard]] Result<std::string> crs_of(const OGRSpatialReference* reference) const {
        const std::string text = reference != nullptr ? text_of(*reference) : "";
        if (!names_files(text)) return text;
        return Error{file_ +
                     ": states a reference system that names a file of a change of datum; state its code alone"};
    }

    const std::string file_;
    const ForeignWanted wanted_;
    const bool isolated_;
    ForeignOutput& out_;
    std::string format_;
};

Status ForeignReading::read_mesh() {
    ForeignMesh mesh;
    std::vector<std::string> files;
    // Of no system: which one it states is compared when the scene is read.
    TALUS_ASSIGN(mesh.buildings, read_mesh_buildings(file_, {}, files));
    TALUS_ASSIGN(mesh.epsg, mesh_epsg(file_));
    std::vector<std::string> parts;
    parts.reserve(files.size());
    for (const std::string& file : files) {
        parts.push_back(fs::path(file).lexically_relative(fs::path(file_).parent_path()).generic_string());
    }
    out_.mesh(mesh, parts);
    return {};
}

/// The type that holds a band's values exactly; unknown: there is none.
GDALDataType type_for(const GDALRasterBand& from, bool masked) {
    GDALRasterBand& band = const_cast<GDALRasterBand&>(from);
    const GDALDataType type = band.GetRasterDataType();
    if (GDALDataTypeIsComplex(type) != 0) return GDT_Unknown;
    if (GDALGetDataTypeSizeBytes(type) == 8) return GDT_Float64;
    if (!masked) return type;
    return type == GDT_Int32 || type == GDT_UInt32 ? GDT_Float64 : GDT_Float32;
}

Status ForeignReading::read_raster(GDALDataset& data) {
    GdalMessages messages;
    const int bands = data.GetRasterCount();
    if (bands == 0) return Error{file_ + ": holds no raster, or several; save the one that is wanted as GeoTIFF"};
    ForeignRaster raster;
    raster.columns = data.GetRasterXSize();
    raster.rows = data.GetRasterYSize();
    const double cells = static_cast<double>(raster.columns) * raster.rows;
    if (cells > wanted_.cells) {
        return Error{
            fmt::format("{}: has {} x {} cells, at most {:.6g} million can be; cut it to the part that matters", file_,
                        raster.columns, raster.rows, wanted_.cells / 1e6)};
    }
    std::array<double, 6> place{};
    if (data.GetGeoTransform(place.data()) == CE_None) {
        raster.place = place;
    } else {
        raster.control_points = data.GetGCPCount() > 0;
    }
    TALUS_ASSIGN(raster.crs, crs_of(data.GetSpatialRef()));
    TALUS_TRY(check_raw_size(file_, data));

    std::vector<GDALRasterBand*> from;
    const int wanted = std::min(bands, wanted_.picture ? 4 : wanted_.bands);
    for (int k = 1; k <= wanted; ++k) from.push_back(data.GetRasterBand(k));
    const GDALColorTable* palette = wanted_.picture ? from[0]->GetColorTable() : nullptr;
    if (palette != nullptr) from.resize(1);
    const auto masked = [&](GDALRasterBand& band) {
        const int flags = band.GetMaskFlags();
        return (flags & (GMF_ALL_VALID | GMF_NODATA)) == 0;
    };
    bool any_mask = false, has_alpha = false;
    GDALDataType type = GDT_Unknown;
    for (GDALRasterBand* band : from) {
        has_alpha = has_alpha || band->GetColorInterpretation() == GCI_AlphaBand;
        any_mask = any_mask || masked(*band);
        const GDALDataType own = type_for(*band, !wanted_.picture && masked(*band));
        if (own == GDT_Unknown) return Error{file_ + ": holds complex numbers"};
        type = type == GDT_Unknown ? own : GDALDataTypeUnion(type, own);
    }
    if (type == GDT_Unknown || GDALGetDataTypeSizeBytes(type) == 8) type = GDT_Float64;
    const bool add_alpha = wanted_.picture && palette == nullptr && any_mask && !has_alpha && type == GDT_Byte;
    for (GDALRasterBand* band : from) {
        ForeignRaster::Band one{type, {}, 1, 0, "", band->GetColorInterpretation()};
        int given = 0;
        if (const double nodata = band->GetNoDataValue(&given); given != 0) one.nodata = nodata;
        if (const double scale = band->GetScale(&given); given != 0) one.scale = scale;
        if (const double offset = band->GetOffset(&given); given != 0) one.offset = offset;
        if (const char* unit = band->GetUnitType(); unit != nullptr) one.unit = unit;
        raster.bands.push_back(std::move(one));
    }
    if (palette != nullptr) {
        type = GDT_Byte;
        raster.bands.assign(4, {GDT_Byte, {}, 1, 0, "", GCI_Undefined});
        raster.bands[3].colour = GCI_AlphaBand;
    }
    if (add_alpha) raster.bands.push_back({GDT_Byte, {}, 1, 0, "", GCI_AlphaBand});
    // A picture is shown at a fraction of its size.
    const int step = wanted_.picture ? std::max(1, static_cast<int>(std::ceil(std::sqrt(cells / shown_pixels)))) : 1;
    const int file_columns = raster.columns;
    if (step > 1) {
        raster.columns /= step;
        raster.rows /= step;
        for (const std::size_t k : {1U, 2U, 4U, 5U}) {
            if (raster.place) (*raster.place)[k] *= step;
        }
    }
    out_.raster(raster);

    const std::size_t size = static_cast<std::size_t>(GDALGetDataTypeSizeBytes(type));
    const auto columns = static_cast<std::size_t>(raster.columns);
    std::vector<char> line(static_cast<std::size_t>(file_columns) * size);
    std::vector<GByte> valid(static_cast<std::size_t>(file_columns)), colours(columns);
    // One of `step` numbers stays; never by GDAL, which would look for overviews.
    const auto thin = [&](auto& numbers, std::size_t width) {
        for (std::size_t c = 1; step > 1 && c < columns; ++c) {
            std::memcpy(numbers.data() + c * width, numbers.data() + c * width * static_cast<std::size_t>(step), width);
        }
    };
    const auto failed = [&] {
        return Error{fmt::format("{}: the file is damaged or cut short: {}", file_,
                                 messages.failure_or("GDAL cannot read all cells"))};
    };
    for (int row = 0; row < raster.rows; ++row) {
        for (GDALRasterBand* band : from) {
            if (band->RasterIO(GF_Read, 0, row * step, file_columns, 1, line.data(), file_columns, 1, type, 0, 0,
                               nullptr) != CE_None ||
                messages.has_failure()) {
                return failed();
            }
            const bool hide = !wanted_.picture && masked(*band);
            if ((hide || (add_alpha && band == from.front())) &&
                band->GetMaskBand()->RasterIO(GF_Read, 0, row * step, file_columns, 1, valid.data(), file_columns, 1,
                                              GDT_Byte, 0, 0, nullptr) != CE_None) {
                return failed();
            }
            for (std::size_t c = 0; hide && c < columns; ++c) {
                if (valid[c] != 0) continue;
                const double none = std::numeric_limits<double>::quiet_NaN();
                const float as_float = std::numeric_limits<float>::quiet_NaN();
                std::memcpy(line.data() + c * size,
                            type == GDT_Float64 ? static_cast<const void*>(&none) : static_cast<const void*>(&as_float),
                            size);
            }
            thin(line, size);
            if (palette == nullptr) out_.cells(line.data(), columns * size);
        }
        thin(valid, 1);
        for (int k = 0; palette != nullptr && k < 4; ++k) {
            for (std::size_t c = 0; c < columns; ++c) {
                GDALColorEntry entry{};
                (void)palette->GetColorEntryAsRGB(static_cast<unsigned char>(line[c]), &entry);
                const std::array<short, 4> parts{entry.c1, entry.c2, entry.c3, entry.c4};
                colours[c] = static_cast<GByte>(parts[static_cast<std::size_t>(k)]);
            }
            out_.cells(colours.data(), columns);
        }
        if (add_alpha) out_.cells(valid.data(), columns);
    }
    return {};
}

Status ForeignReading::read_layers(GDALDataset& data) {
    std::vector<ForeignLayer> layers;
    std::vector<OGRLayer*> from;
    std::vector<bool> swapped;
    for (int k = 0; k < data.GetLayerCount(); ++k) {
        OGRLayer* layer = data.GetLayer(k);
        OGRFeatureDefn& columns = *layer->GetLayerDefn();
        if (columns.GetGeomFieldCount() == 0) continue;
        ForeignLayer one;
        one.name = to_utf8(layer->GetName());
        one.of_geojson = was_geojson(data, *layer);
        const OGRSpatialReference* reference = layer->GetSpatialRef();
        TALUS_ASSIGN(one.crs, crs_of(reference));
        for (int f = 0; f < columns.GetFieldCount(); ++f) {
            const OGRFieldDefn& field = *columns.GetFieldDefn(f);
            const OGRFieldType type = field.GetType();
            one.fields.push_back(
                {to_utf8(field.GetNameRef()), type != OFTInteger && type != OFTInteger64 && type != OFTReal});
        }
        bool other_way = false;
        if (reference != nullptr) {
            OGRSpatialReference usual(*reference);
            usual.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
            other_way = usual.GetDataAxisToSRSAxisMapping() != reference->GetDataAxisToSRSAxisMapping();
        }
        layers.push_back(std::move(one));
        from.push_back(layer);
        swapped.push_back(other_way);
    }
    if (layers.empty()) return Error{file_ + ": holds no layer with geometry"};
    if (wanted_.styles) read_styles(layers);
    out_.layers(layers);
    for (std::size_t k = 0; k < layers.size(); ++k) TALUS_TRY(read_layer(*from[k], layers[k].fields, swapped[k]));
    return {};
}

/// Of the table in which QGIS keeps the styles of a GeoPackage; the default one of a layer, or else its first.
void ForeignReading::read_styles(std::vector<ForeignLayer>& layers) const {
    if (format_ != "GPKG") return;
    const GdalMessages quiet;
    const char* const drivers[] = {"GPKG", nullptr};
    CPLStringList options;
    options.SetNameValue("LIST_ALL_TABLES", "YES");
    const GDALDatasetUniquePtr data(
        GDALDataset::Open(file_.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, drivers, options.List()));
    OGRLayer* table = data ? data->GetLayerByName("layer_styles") : nullptr;
    if (table == nullptr) return;
    const OGRFeatureDefn& columns = *table->GetLayerDefn();
    const int of = columns.GetFieldIndex("f_table_name"), qml = columns.GetFieldIndex("styleQML"),
              first = columns.GetFieldIndex("useAsDefault");
    if (of < 0 || qml < 0) return;
    constexpr int most_styles = 500;
    for (int k = 0; k < most_styles; ++k) {
        const OGRFeatureUniquePtr row(table->GetNextFeature());
        if (!row) return;
        const auto layer = std::find_if(layers.begin(), layers.end(), [&](const ForeignLayer& one) {
            return one.name == to_utf8(row->GetFieldAsString(of));
        });
        if (layer == layers.end()) continue;
        const bool preferred = first >= 0 && row->GetFieldAsInteger(first) != 0;
        if (!layer->symbols.empty() && !preferred) continue;
        if (LayerSymbols symbols = read_qml(row->GetFieldAsString(qml)); !symbols.empty())
            layer->symbols = std::move(symbols);
    }
}

Status ForeignReading::read_layer(OGRLayer& layer, const std::vector<Field>& fields, bool swapped) {
    GdalMessages messages;
    layer.ResetReading();
    for (long number = 1;; ++number) {
        const OGRFeatureUniquePtr feature(layer.GetNextFeature());
        if (messages.has_failure()) {
            return Error{fmt::format("{}: the file is damaged or cut short at feature {}: {}", file_, number,
                                     messages.failure_or(""))};
        }
        if (!feature) break;
        std::unique_ptr<OGRGeometry> geometry;
        if (const OGRGeometry* own = feature->GetGeometryRef()) {
            geometry.reset(own->hasCurveGeometry() != 0 ? own->getLinearGeometry() : own->clone());
            if (!geometry)
                return Error{fmt::format("{}: feature {} has a geometry that cannot be flattened", file_, number)};
            geometry->flattenTo2D();
            geometry->setMeasured(FALSE);
            if (wkbFlatten(geometry->getGeometryType()) > wkbGeometryCollection) {
                return Error{fmt::format("{}: feature {} is a {}; save it as polygons or lines", file_, number,
                                         OGRGeometryTypeToName(geometry->getGeometryType()))};
            }
            if (swapped) geometry->swapXY();
        }
        std::vector<Attribute> values;
        for (std::size_t k = 0; k < fields.size(); ++k) {
            const int field = static_cast<int>(k);
            Attribute value;
            if (feature->IsFieldSetAndNotNull(field) != 0) {
                if (fields[k].is_text) {
                    value = to_utf8(feature->GetFieldAsString(field));
                } else if (const double x = feature->GetFieldAsDouble(field); std::isfinite(x)) {
                    value = x;
                }
            }
            values.push_back(std::move(value));
        }
        out_.feature(geometry.get(), values);
    }
    out_.end_of_features();
    return {};
}

}  // namespace

Status read_foreign_file(const std::string& file, const ForeignWanted& wanted, bool isolated, ForeignOutput& out) {
    return ForeignReading(file, wanted, isolated, out).read();
}

}  // namespace talus::geo
