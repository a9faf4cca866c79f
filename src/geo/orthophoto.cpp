#include "geo/orthophoto.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <iterator>
#include <memory>
#include <vector>

#include <cpl_string.h>
#include <cpl_vsi.h>
#include <fmt/format.h>
#include <gdal_utils.h>

#include "core/try.hpp"
#include "geo/gdal.hpp"
#include "geo/overlay.hpp"
#include "geo/spatial_reference.hpp"

namespace talus::geo {
namespace {

struct FreeTranslateOptions {
    void operator()(GDALTranslateOptions* options) const { GDALTranslateOptionsFree(options); }
};
struct FreeWarpOptions {
    void operator()(GDALWarpAppOptions* options) const { GDALWarpAppOptionsFree(options); }
};

CPLStringList list_of(const std::vector<std::string>& words) {
    CPLStringList list;
    for (const std::string& word : words) list.AddString(word.c_str());
    return list;
}

/// As `gdal_translate` and `gdalwarp` with these arguments do it; null on failure.
GDALDatasetUniquePtr translated(GDALDataset& data, const std::string& target, const std::vector<std::string>& words) {
    CPLStringList list = list_of(words);
    const std::unique_ptr<GDALTranslateOptions, FreeTranslateOptions> options(
        GDALTranslateOptionsNew(list.List(), nullptr));
    if (!options) return nullptr;
    return GDALDatasetUniquePtr(
        GDALDataset::FromHandle(GDALTranslate(target.c_str(), GDALDataset::ToHandle(&data), options.get(), nullptr)));
}

GDALDatasetUniquePtr warped(GDALDataset& data, const std::vector<std::string>& words) {
    CPLStringList list = list_of(words);
    const std::unique_ptr<GDALWarpAppOptions, FreeWarpOptions> options(GDALWarpAppOptionsNew(list.List(), nullptr));
    if (!options) return nullptr;
    GDALDatasetH source = GDALDataset::ToHandle(&data);
    return GDALDatasetUniquePtr(GDALDataset::FromHandle(GDALWarp("", nullptr, 1, &source, options.get(), nullptr)));
}

/// Words of warped() for a picture in memory of this part of the ground.
std::vector<std::string> cut_to(const Extent& extent, int columns, int rows) {
    std::vector<std::string> words{"-of", "MEM", "-ts", std::to_string(columns), std::to_string(rows), "-te"};
    for (const double edge : {extent.x_min, extent.y_min, extent.x_max, extent.y_max}) {
        words.push_back(fmt::format("{:.12g}", edge));
    }
    return words;
}

std::string wkt_of(const OGRSpatialReference& reference) {
    char* text = nullptr;
    reference.exportToWkt(&text);
    std::string wkt = text != nullptr ? text : "";
    CPLFree(text);
    return wkt;
}

/// A picture, as a view of its file with bands red, green, blue and perhaps alpha, placed in a CRS.
struct Picture {
    GDALDatasetUniquePtr file, view;
    std::string name;        // of the view, in memory
    std::string target_crs;  // the terrain's, as WKT
    double pixel = 0;        // m, on the ground
    Picture() = default;
    Picture(Picture&&) = default;
    Picture& operator=(Picture&&) = delete;
    ~Picture() {
        view.reset();
        if (!name.empty()) VSIUnlink(name.c_str());
    }
};

/// A unique name for a file in memory.
std::string memory_name(const char* ending) {
    static std::atomic<unsigned> count{0};
    return fmt::format("/vsimem/talus_orthophoto_{}.{}", count++, ending);
}

/// Options that select red, green and blue from the file's bands.
Result<std::vector<std::string>> band_choice(const std::string& file, GDALDataset& data) {
    const int bands = data.GetRasterCount();
    for (int band = 1; band <= std::min(bands, 4); ++band) {
        if (data.GetRasterBand(band)->GetRasterDataType() == GDT_Byte) continue;
        return Error{fmt::format("{}: a picture of 8 bits per band is needed: gdal_translate -ot Byte -scale {} {}",
                                 file, shell_quoted(file), mended_name(file, "_8bit", ".tif"))};
    }
    const bool palette = data.GetRasterBand(1)->GetColorInterpretation() == GCI_PaletteIndex;
    if (palette) return std::vector<std::string>{"-expand", "rgba"};
    const auto is_alpha = [&](int band) {
        return band <= bands && data.GetRasterBand(band)->GetColorInterpretation() == GCI_AlphaBand;
    };
    if (bands >= 3) {
        std::vector<std::string> words{"-b", "1", "-b", "2", "-b", "3"};
        if (is_alpha(4)) words.insert(words.end(), {"-b", "4"});  // else the fourth is infrared or the like
        return words;
    }
    std::vector<std::string> words{"-b", "1", "-b", "1", "-b", "1"};
    if (is_alpha(2)) words.insert(words.end(), {"-b", "2"});
    return words;
}

Result<Picture> open_picture(const std::string& file, const Crs& crs, const Extent& extent) {
    Picture picture;
    TALUS_ASSIGN(picture.file, open_dataset(file, GDAL_OF_RASTER, "picture"));
    GdalMessages messages;
    GDALDataset& data = *picture.file;
    if (data.GetRasterCount() == 0) return Error{fmt::format("{}: holds no raster band", file)};
    std::array<double, 6> place{};
    if (data.GetGeoTransform(place.data()) != CE_None) {
        return Error{
            fmt::format("{}: states no position; put a world file beside it, or: gdal_translate -a_ullr WEST "
                        "NORTH EAST SOUTH {} {}",
                        file, shell_quoted(file), mended_name(file, "_placed", ".tif"))};
    }
    const OGRSpatialReference target = to_spatial_reference(crs);
    OGRSpatialReference own;
    if (const OGRSpatialReference* stated = data.GetSpatialRef()) own = *stated;
    picture.target_crs = wkt_of(target);

    TALUS_ASSIGN(auto words, band_choice(file, data));
    words.insert(words.end(), {"-of", "VRT"});
    const bool takes_target = own.IsEmpty() || (own.IsLocal() != 0 && target.IsLocal() != 0);
    if (takes_target && !target.IsEmpty()) words.insert(words.end(), {"-a_srs", picture.target_crs});
    picture.name = memory_name("vrt");
    picture.view = translated(data, picture.name, words);
    if (!picture.view)
        return Error{
            fmt::format("{}: {}", file, "cannot be read as a picture: " + messages.failure_or("GDAL gave no reason"))};

    // Its position and resolution in the terrain's system.
    std::vector<std::string> ask{"-of", "VRT"};
    if (!target.IsEmpty()) ask.insert(ask.end(), {"-t_srs", picture.target_crs});
    const GDALDatasetUniquePtr placed = warped(*picture.view, ask);
    if (!placed || placed->GetGeoTransform(place.data()) != CE_None) {
        return Error{
            fmt::format("{}: {}", file,
                        "cannot be brought into the terrain's system: " + messages.failure_or("GDAL gave no reason"))};
    }
    picture.pixel = std::min(std::abs(place[1]), std::abs(place[5]));
    const double east = place[0] + place[1] * placed->GetRasterXSize();
    const double south = place[3] + place[5] * placed->GetRasterYSize();
    if (place[0] >= extent.x_max || east <= extent.x_min || south >= extent.y_max || place[3] <= extent.y_min) {
        return Error{
            fmt::format("{}: lies beside the terrain: x {:.1f} to {:.1f}, y {:.1f} to {:.1f}; the terrain has x "
                        "{:.1f} to {:.1f}, y {:.1f} to {:.1f}",
                        file, place[0], east, south, place[3], extent.x_min, extent.x_max, extent.y_min, extent.y_max)};
    }
    return Result<Picture>(std::move(picture));
}

/// `data` encoded by a driver; empty: the driver is missing or fails.
std::string encoded(GDALDataset& data, const char* driver_name, const std::vector<std::string>& settings) {
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(driver_name);
    if (driver == nullptr) return {};
    const std::string name = memory_name("image");
    CPLStringList list = list_of(settings);
    const bool made =
        GDALDatasetUniquePtr(driver->CreateCopy(name.c_str(), &data, 0, list.List(), nullptr, nullptr)) != nullptr;
    std::string bytes;
    vsi_l_offset size = 0;
    if (const GByte* content = made ? VSIGetMemFileBuffer(name.c_str(), &size, 0) : nullptr) {
        bytes.assign(reinterpret_cast<const char*>(content), static_cast<std::size_t>(size));
    }
    VSIUnlink(name.c_str());
    VSIUnlink((name + ".aux.xml").c_str());
    return bytes;
}

}  // namespace

Status check_orthophoto(const std::string& file, const Crs& crs, const Extent& extent) {
    TALUS_TRY(open_picture(file, crs, extent));
    return {};
}

Result<Orthophoto> read_orthophoto(const std::string& file, const Crs& crs, const Extent& extent, int max_pixels) {
    TALUS_ASSIGN(auto picture, open_picture(file, crs, extent));
    const GdalMessages messages;
    const double width = extent.x_max - extent.x_min, height = extent.y_max - extent.y_min;
    const double pixel = std::max(picture.pixel, std::max(width, height) / max_pixels);
    Orthophoto photo;
    photo.columns = std::clamp(static_cast<int>(std::lround(width / pixel)), 1, max_pixels);
    photo.rows = std::clamp(static_cast<int>(std::lround(height / pixel)), 1, max_pixels);
    std::vector<std::string> words = cut_to(extent, photo.columns, photo.rows);
    words.insert(words.end(), {"-r", "bilinear", "-dstalpha"});
    if (!picture.target_crs.empty()) words.insert(words.end(), {"-t_srs", picture.target_crs});
    const GDALDatasetUniquePtr cut = warped(*picture.view, words);
    if (!cut || messages.has_failure()) {
        return Error{
            fmt::format("{}: {}", file, "its pixels cannot be read: " + messages.failure_or("GDAL gave no reason"))};
    }
    photo.type = "image/webp";
    photo.bytes = encoded(*cut, "WEBP", {"QUALITY=80"});
    if (photo.bytes.empty()) {
        photo.type = "image/png";
        photo.bytes = encoded(*cut, "PNG", {});
    }
    if (photo.bytes.empty())
        return Error{fmt::format("{}: {}", file, "cannot be encoded: " + messages.failure_or("GDAL gave no reason"))};
    return photo;
}

namespace {

/// Dark to light: blue, green, yellow (after viridis: Smith and van der Walt 2015).
std::array<GByte, 3> ramp_at(double share) {
    constexpr std::array<std::array<double, 3>, 5> stops{
        {{68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}}};
    // Values near the ends of what a number can hold have no share of their range.
    const double at = std::isfinite(share) ? std::clamp(share, 0.0, 1.0) * (stops.size() - 1) : 0;
    const auto k = std::min<std::size_t>(static_cast<std::size_t>(at), stops.size() - 2);
    std::array<GByte, 3> colour{};
    for (std::size_t c = 0; c < colour.size(); ++c) {
        colour[c] = static_cast<GByte>(
            std::lround(stops[k][c] + (at - static_cast<double>(k)) * (stops[k + 1][c] - stops[k][c])));
    }
    return colour;
}

/// Values over the terrain as colours; its range without the outermost hundredths, so that a single cell does not set
/// it.
Result<PictureOverlay> coloured_values(GDALDataset& file, const OverlayGround& ground, const OverlayLimits& limits) {
    const GdalMessages messages;
    const OGRSpatialReference target = to_spatial_reference(ground.crs);
    const Extent& extent = ground.extent;
    PictureOverlay made;
    const double pixel = std::max(extent.width(), extent.height()) / std::min(limits.pixels, 2048);
    made.columns = std::max(1, static_cast<int>(std::lround(extent.width() / pixel)));
    made.rows = std::max(1, static_cast<int>(std::lround(extent.height() / pixel)));
    std::vector<std::string> words = cut_to(extent, made.columns, made.rows);
    words.insert(words.end(), {"-ot", "Float64", "-dstnodata", "nan"});
    if (!target.IsEmpty() && file.GetSpatialRef() != nullptr) {
        words.insert(words.end(), {"-t_srs", wkt_of(target)});
    } else if (!target.IsEmpty()) {
        words.insert(words.end(), {"-s_srs", wkt_of(target), "-t_srs", wkt_of(target)});
        made.note = "states no coordinate reference system; taken to be in the terrain's";
    }
    const GDALDatasetUniquePtr cut = warped(file, words);
    const auto count = static_cast<std::size_t>(made.columns) * static_cast<std::size_t>(made.rows);
    std::vector<double> values(count);
    if (!cut || cut->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, made.columns, made.rows, values.data(), made.columns,
                                                made.rows, GDT_Float64, 0, 0, nullptr) != CE_None) {
        return Error{"its cells cannot be read: " + messages.failure_or("GDAL gave no reason")};
    }
    std::vector<double> there;
    std::copy_if(values.begin(), values.end(), std::back_inserter(there), [](double v) { return std::isfinite(v); });
    if (there.empty()) return Error{"lies outside the terrain, or has no data on it"};
    std::sort(there.begin(), there.end());
    made.has_range = true;
    made.low = there[there.size() / 100];
    made.high = there[there.size() - 1 - there.size() / 100];
    const double span = made.high > made.low ? made.high - made.low : 1;
    GDALDriver* memory = GetGDALDriverManager()->GetDriverByName("MEM");
    const GDALDatasetUniquePtr picture(
        memory != nullptr ? memory->Create("", made.columns, made.rows, 4, GDT_Byte, nullptr) : nullptr);
    if (!picture) return Error{"cannot be drawn: " + messages.failure_or("GDAL gave no reason")};
    std::vector<GByte> band(count);
    for (int c = 0; c < 4; ++c) {
        for (std::size_t k = 0; k < count; ++k) {
            const bool shown = std::isfinite(values[k]);
            band[k] = c == 3  ? static_cast<GByte>(shown ? 255 : 0)
                      : shown ? ramp_at((values[k] - made.low) / span)[static_cast<std::size_t>(c)]
                              : GByte{0};
        }
        GDALRasterBand& to = *picture->GetRasterBand(c + 1);
        to.SetColorInterpretation(static_cast<GDALColorInterp>(GCI_RedBand + c));
        if (to.RasterIO(GF_Write, 0, 0, made.columns, made.rows, band.data(), made.columns, made.rows, GDT_Byte, 0, 0,
                        nullptr) != CE_None) {
            return Error{"cannot be drawn: " + messages.failure_or("GDAL gave no reason")};
        }
    }
    made.type = "image/png";
    made.bytes = encoded(*picture, "PNG", {});
    if (made.bytes.empty()) return Error{"cannot be encoded: " + messages.failure_or("GDAL gave no reason")};
    return Result<PictureOverlay>(std::move(made));
}

}  // namespace

Result<PictureOverlay> read_picture_overlay(const std::string& file, const OverlayGround& ground,
                                            const OverlayLimits& limits) {
    {
        TALUS_ASSIGN(const auto data, open_dataset(file, GDAL_OF_RASTER, "picture"));
        std::array<double, 6> place{};
        if (data->GetRasterCount() == 0) return Error{"holds no raster band"};
        if (data->GetGeoTransform(place.data()) != CE_None) {
            return Error{"states no position; drop its world file with it, or save it as GeoTIFF"};
        }
        const bool values = data->GetRasterBand(1)->GetRasterDataType() != GDT_Byte;
        if (values && data->GetRasterCount() > 1)
            return Error{"has several bands of more than 8 bits; save it as a picture of 8 bits per band"};
        if (values) return coloured_values(*data, ground, limits);
    }
    TALUS_ASSIGN(auto photo, read_orthophoto(file, ground.crs, ground.extent, limits.pixels));
    PictureOverlay made;
    made.bytes = std::move(photo.bytes);
    made.type = std::move(photo.type);
    made.columns = photo.columns;
    made.rows = photo.rows;
    return Result<PictureOverlay>(std::move(made));
}

}  // namespace talus::geo
