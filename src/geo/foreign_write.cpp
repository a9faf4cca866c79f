// What the child process handed over, checked and written as the files that this program opens.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <string_view>

#include <cpl_string.h>
#include <fmt/format.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include "core/lower_case.hpp"
#include "core/try.hpp"
#include "core/visible_text.hpp"
#include "geo/foreign_data.hpp"
#include "geo/gdal.hpp"
#include "geo/json_text.hpp"

namespace talus::geo {
namespace {

using nlohmann::json;

constexpr std::size_t longest_header = std::size_t{64} << 20, longest_sentence = 2000, longest_text = 4000;
constexpr std::size_t most_layers = 200, most_fields = 2000;
constexpr std::uint64_t most_features = 5'000'000;
constexpr std::uint32_t most_points = 20'000'000;
constexpr int deepest_geometry = 8;

const Error malformed{"cannot be read: its data are malformed; it is damaged or malicious"};

/// Reads no more than there is.
class Input {
  public:
    Input(std::FILE* file, std::uint64_t bytes) : file_(file), left_(bytes) {}

    [[nodiscard]] std::uint64_t left() const { return left_; }
    [[nodiscard]] bool take(void* to, std::uint64_t count) {
        if (count > left_ || std::fread(to, 1, count, file_) != count) return false;
        left_ -= count;
        return true;
    }
    template <class T>
    [[nodiscard]] bool take(T& value) {
        return take(&value, sizeof value);
    }
    Result<std::string> line() {
        std::string text;
        for (int c = 0; left_ > 0 && (c = std::getc(file_)) != EOF;) {
            --left_;
            if (c == '\n') return text;
            text.push_back(static_cast<char>(c));
            if (text.size() > longest_header) break;
        }
        return malformed;
    }

  private:
    std::FILE* file_;
    std::uint64_t left_;
};

/// The child writes numbers as texts, because some of them are not finite.
std::optional<double> number_in(const json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_string()) return {};
    const auto& text = found->get_ref<const std::string&>();
    double value = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
    if (read.ec != std::errc() || read.ptr != text.data() + text.size()) return {};
    return value;
}

std::string text_in(const json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_string()) return {};
    std::string text = found->get<std::string>().substr(0, 100'000);
    text.erase(std::remove_if(text.begin(), text.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }),
               text.end());
    return text;
}

/// A whole number from 0 to `most`; empty: it is none.
std::optional<std::uint64_t> count_in(const json& object, const char* key, std::uint64_t most) {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_number_unsigned()) return {};
    const auto count = found->get<std::uint64_t>();
    return count <= most ? std::optional(count) : std::nullopt;
}

Result<OGRSpatialReference> reference_of(const std::string& wkt) {
    OGRSpatialReference reference;
    reference.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    if (wkt.empty()) return reference;
    if (names_files(wkt)) return Error{"states a reference system that names a file of a change of datum"};
    if (reference.importFromWkt(wkt.c_str()) != OGRERR_NONE) return malformed;
    return reference;
}

Result<ForeignRaster> read_raster(const json& head, double most_cells, int most_bands) {
    if (!head.is_object()) return malformed;
    ForeignRaster raster;
    const auto columns = count_in(head, "columns", 1U << 30U), rows = count_in(head, "rows", 1U << 30U);
    const json bands = head.value("bands", json());
    if (!columns || !rows || *columns < 1 || *rows < 1 || !bands.is_array() || bands.empty() ||
        bands.size() > static_cast<std::size_t>(most_bands) ||
        static_cast<double>(*columns) * static_cast<double>(*rows) > most_cells) {
        return malformed;
    }
    raster.columns = static_cast<int>(*columns);
    raster.rows = static_cast<int>(*rows);
    for (const json& written : bands) {
        if (!written.is_object()) return malformed;
        ForeignRaster::Band band;
        band.type = GDALGetDataTypeByName(text_in(written, "type").c_str());
        constexpr std::array known = {GDT_Byte, GDT_Int16, GDT_UInt16, GDT_Int32, GDT_UInt32, GDT_Float32, GDT_Float64};
        if (std::find(known.begin(), known.end(), band.type) == known.end()) return malformed;
        if (!raster.bands.empty() && band.type != raster.bands[0].type) return malformed;
        band.nodata = number_in(written, "nodata");
        band.scale = number_in(written, "scale").value_or(1);
        band.offset = number_in(written, "offset").value_or(0);
        band.unit = text_in(written, "unit").substr(0, 100);
        band.colour = static_cast<int>(count_in(written, "colour", GCI_Max).value_or(0));
        raster.bands.push_back(std::move(band));
    }
    if (const json place = head.value("place", json()); place.is_array() && place.size() == 6) {
        raster.place.emplace();
        for (std::size_t k = 0; k < 6; ++k) {
            const auto number = number_in({{"v", place[k]}}, "v");
            if (!number || !std::isfinite(*number)) return malformed;
            (*raster.place)[k] = *number;
        }
    }
    raster.control_points = head.value("control_points", json(false)) == true;
    raster.crs = text_in(head, "crs");
    return raster;
}

Status write_raster(Input& in, const json& head, const std::string& file, double most_cells, int most_bands) {
    TALUS_ASSIGN(const ForeignRaster raster, read_raster(head, most_cells, most_bands));
    TALUS_ASSIGN(const OGRSpatialReference reference, reference_of(raster.crs));
    const GDALDataType type = raster.bands[0].type;
    const std::size_t width = static_cast<std::size_t>(raster.columns) * GDALGetDataTypeSizeBytes(type);
    if (in.left() != static_cast<std::uint64_t>(raster.rows) * raster.bands.size() * width) return malformed;
    const GdalMessages messages;
    CPLStringList options;
    options.SetNameValue("COMPRESS", "DEFLATE");
    options.SetNameValue("ZLEVEL", "1");
    options.SetNameValue("BIGTIFF", "IF_SAFER");
    const bool colours = type == GDT_Byte && raster.bands.size() >= 3;
    if (colours) options.SetNameValue("PHOTOMETRIC", "RGB");
    if (colours && raster.bands.size() == 4 && raster.bands[3].colour == GCI_AlphaBand) {
        options.SetNameValue("ALPHA", "YES");
    }
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
    GDALDatasetUniquePtr data(driver->Create(file.c_str(), raster.columns, raster.rows,
                                             static_cast<int>(raster.bands.size()), type, options.List()));
    const auto failed = [&] { return Error{"cannot be kept: " + messages.failure_or("is the disk full?")}; };
    if (!data) return failed();
    if (raster.place) {
        auto place = *raster.place;
        data->SetGeoTransform(place.data());
    } else if (raster.control_points) {
        GDAL_GCP corner{};
        GDALInitGCPs(1, &corner);
        data->SetGCPs(1, &corner, static_cast<const OGRSpatialReference*>(nullptr));
        GDALDeinitGCPs(1, &corner);
    }
    if (!reference.IsEmpty()) data->SetSpatialRef(&reference);
    for (std::size_t k = 0; k < raster.bands.size(); ++k) {
        const ForeignRaster::Band& band = raster.bands[k];
        GDALRasterBand& to = *data->GetRasterBand(static_cast<int>(k) + 1);
        if (band.nodata) to.SetNoDataValue(*band.nodata);
        if (band.scale != 1 || band.offset != 0) {
            to.SetScale(band.scale);
            to.SetOffset(band.offset);
        }
        if (!band.unit.empty()) to.SetUnitType(band.unit.c_str());
        if (!colours && band.colour == GCI_AlphaBand) to.SetColorInterpretation(GCI_AlphaBand);
    }
    std::vector<char> line(width);
    for (int row = 0; row < raster.rows; ++row) {
        for (int band = 1; band <= data->GetRasterCount(); ++band) {
            if (!in.take(line.data(), width)) return malformed;
            if (data->GetRasterBand(band)->RasterIO(GF_Write, 0, row, raster.columns, 1, line.data(), raster.columns, 1,
                                                    type, 0, 0, nullptr) != CE_None) {
                return failed();
            }
        }
    }
    data.reset();
    return messages.has_failure() ? Status(failed()) : Status();
}

/// A curve's points; false: there are more than fit, or one is not finite.
bool read_points(Input& in, OGRSimpleCurve& curve) {
    std::uint32_t count = 0;
    if (!in.take(count) || count > most_points || count * std::uint64_t{16} > in.left()) return false;
    curve.setNumPoints(static_cast<int>(count), FALSE);
    for (std::uint32_t k = 0; k < count; ++k) {
        double x = 0, y = 0;
        if (!in.take(x) || !in.take(y) || !std::isfinite(x) || !std::isfinite(y)) return false;
        curve.setPoint(static_cast<int>(k), x, y);
    }
    return true;
}

/// Empty: malformed. `none`: the feature has no geometry.
std::unique_ptr<OGRGeometry> read_geometry(Input& in, int depth, bool& none) {
    std::uint32_t type = 0, count = 0;
    if (!in.take(type) || depth > deepest_geometry) return nullptr;
    none = type == 0;
    if (type == wkbPoint) {
        double x = 0, y = 0;
        if (!in.take(x) || !in.take(y) || !std::isfinite(x) || !std::isfinite(y)) return nullptr;
        return std::make_unique<OGRPoint>(x, y);
    }
    if (type == wkbLineString) {
        auto line = std::make_unique<OGRLineString>();
        return read_points(in, *line) ? std::move(line) : nullptr;
    }
    if (type == wkbPolygon) {
        auto polygon = std::make_unique<OGRPolygon>();
        if (!in.take(count) || count * std::uint64_t{4} > in.left()) return nullptr;
        for (std::uint32_t k = 0; k < count; ++k) {
            auto ring = std::make_unique<OGRLinearRing>();
            if (!read_points(in, *ring)) return nullptr;
            polygon->addRingDirectly(ring.release());
        }
        return polygon;
    }
    if (type < wkbMultiPoint || type > wkbGeometryCollection) return nullptr;
    std::unique_ptr<OGRGeometry> made(OGRGeometryFactory::createGeometry(static_cast<OGRwkbGeometryType>(type)));
    if (!made || !in.take(count) || count * std::uint64_t{4} > in.left()) return nullptr;
    for (std::uint32_t k = 0; k < count; ++k) {
        bool ignored = false;
        auto part = read_geometry(in, depth + 1, ignored);
        if (!part || made->toGeometryCollection()->addGeometryDirectly(part.get()) != OGRERR_NONE) return nullptr;
        (void)part.release();
    }
    return made;
}

bool read_value(Input& in, OGRFeature& feature, int field, bool is_text) {
    std::uint8_t kind = 0;
    std::uint32_t size = 0;
    if (!in.take(kind) || kind > 2) return false;
    if (kind == 1) {
        double number = 0;
        if (is_text || !in.take(number)) return false;
        feature.SetField(field, number);
    } else if (kind == 2) {
        if (!is_text || !in.take(size) || size > longest_text) return false;
        std::string text(size, ' ');
        if (!in.take(text.data(), size)) return false;
        text.erase(std::remove(text.begin(), text.end(), '\0'), text.end());
        if (CPLIsUTF8(text.c_str(), -1) == 0) {
            char* plain = CPLForceToASCII(text.c_str(), -1, '?');
            text = plain;
            CPLFree(plain);
        }
        feature.SetField(field, text.c_str());
    }
    return true;
}

Result<ForeignLayer> read_layer(const json& written) {
    if (!written.is_object()) return malformed;
    ForeignLayer layer;
    layer.name = text_in(written, "name").substr(0, 200);
    layer.crs = text_in(written, "crs");
    layer.of_geojson = written.value("geojson", json(false)) == true;
    const json fields = written.value("fields", json());
    layer.symbols = symbols_of(written.value("symbols", json()));
    if (layer.name.empty() || !fields.is_array() || fields.size() > most_fields) return malformed;
    for (const json& field : fields) {
        if (!field.is_object()) return malformed;
        layer.fields.push_back({text_in(field, "name").substr(0, 200), field.value("text", json(false)) == true});
    }
    return layer;
}

/// A name that none of `taken` is, which it joins; SQL does not tell capitals from small letters.
std::string free_name(const std::string& wanted, std::set<std::string>& taken) {
    std::string name = wanted;
    for (int k = 2; !taken.insert(lower_case(name)).second; ++k) name = fmt::format("{}_{}", wanted, k);
    return name;
}

Status write_layer(Input& in, GDALDataset& data, const ForeignLayer& from, std::set<std::string>& names,
                   const GdalMessages& messages) {
    const auto failed = [&] { return Error{"cannot be kept: " + messages.failure_or("is the disk full?")}; };
    TALUS_ASSIGN(OGRSpatialReference reference, reference_of(from.crs));
    std::set<std::string> columns;
    std::vector<std::string> field_names;
    for (const Field& field : from.fields) {
        field_names.push_back(free_name(field.name.empty() ? "field" : field.name, columns));
    }
    CPLStringList options;
    options.SetNameValue("FID", free_name("fid", columns).c_str());
    options.SetNameValue("GEOMETRY_NAME", free_name("geom", columns).c_str());
    options.SetNameValue("SPATIAL_INDEX", "NO");
    if (from.of_geojson) options.SetNameValue("DESCRIPTION", geojson_mark);
    OGRLayer* layer = data.CreateLayer(free_name(from.name, names).c_str(), reference.IsEmpty() ? nullptr : &reference,
                                       wkbUnknown, options.List());
    if (layer == nullptr) return failed();
    for (std::size_t k = 0; k < from.fields.size(); ++k) {
        OGRFieldDefn column(field_names[k].c_str(), from.fields[k].is_text ? OFTString : OFTReal);
        if (layer->CreateField(&column) != OGRERR_NONE) return failed();
    }
    for (std::uint64_t k = 0;; ++k) {
        std::uint8_t more = 0;
        if (!in.take(more) || k > most_features) return malformed;
        if (more == 0) return {};
        OGRFeature feature(layer->GetLayerDefn());
        bool none = false;
        auto geometry = read_geometry(in, 0, none);
        if (!geometry && !none) return malformed;
        if (geometry) feature.SetGeometryDirectly(geometry.release());
        for (std::size_t field = 0; field < from.fields.size(); ++field) {
            if (!read_value(in, feature, static_cast<int>(field), from.fields[field].is_text)) return malformed;
        }
        if (layer->CreateFeature(&feature) != OGRERR_NONE) return failed();
    }
}

Status write_layers(Input& in, const json& head, const std::string& file, std::vector<LayerSymbols>& symbols) {
    if (!head.is_array() || head.empty() || head.size() > most_layers) return malformed;
    const GdalMessages messages;
    const auto failed = [&] { return Error{"cannot be kept: " + messages.failure_or("is the disk full?")}; };
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
    GDALDatasetUniquePtr data(driver ? driver->Create(file.c_str(), 0, 0, 0, GDT_Unknown, nullptr) : nullptr);
    if (!data || data->StartTransaction() != OGRERR_NONE) return failed();
    std::set<std::string> names;
    for (const json& written : head) {
        TALUS_ASSIGN(const ForeignLayer layer, read_layer(written));
        TALUS_TRY(write_layer(in, *data, layer, names, messages));
        symbols.push_back(layer.symbols);
    }
    if (in.left() != 0) return malformed;
    if (data->CommitTransaction() != OGRERR_NONE) return failed();
    data.reset();
    return messages.has_failure() ? Status(failed()) : Status();
}

Status write_mesh(Input& in, const json& parts_read, const std::string& file, std::vector<std::string>& parts) {
    if (!parts_read.is_array() || parts_read.size() > 100 || in.left() > longest_header) return malformed;
    for (const json& part : parts_read) {
        if (!part.is_string()) return malformed;
        parts.push_back(part.get<std::string>());
    }
    std::string text(in.left(), ' ');
    if (!in.take(text.data(), text.size())) return malformed;
    const auto mesh = read_foreign_mesh(text);
    if (!mesh) return malformed;
    std::ofstream out(file, std::ios::binary);
    out << to_text(*mesh);
    out.close();
    return out ? Status() : Status(Error{"cannot be kept; is the disk full?"});
}

}  // namespace

Status write_again(std::FILE* in, std::uint64_t bytes, const std::string& stem, double most_cells, int most_bands,
                   std::string& file, std::vector<std::string>& parts, std::vector<LayerSymbols>& layers) {
    prepare_gdal();
    Input input(in, bytes);
    TALUS_ASSIGN(const std::string line, input.line());
    const auto head = parse_json(line);
    if (!head || !head->is_object() || head->size() != 1) return malformed;
    const json::const_iterator only = head->cbegin();
    const std::string& what = only.key();
    const json& content = only.value();
    if (what == "error" && content.is_string()) {
        return Error{visible(content.get<std::string>().substr(0, longest_sentence))};
    }
    const char* ending = what == "raster" ? ".tif" : what == "layers" ? ".gpkg" : what == "mesh" ? ".roofs.json" : "";
    if (*ending == 0) return malformed;
    file = stem + ending;
    Status written = what == "raster"   ? write_raster(input, content, file, most_cells, most_bands)
                     : what == "layers" ? write_layers(input, content, file, layers)
                                        : write_mesh(input, content, file, parts);
    if (written) return {};
    std::error_code ignored;
    for (const char* more : {"", ".aux.xml", "-journal", "-wal", "-shm"}) std::filesystem::remove(file + more, ignored);
    return written;
}

}  // namespace talus::geo
