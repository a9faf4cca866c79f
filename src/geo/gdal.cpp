#include "geo/gdal.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <mutex>

#include <cpl_conv.h>
#include <cpl_error.h>
#include <fmt/format.h>
#include <ogrsf_frmts.h>

#include "core/try.hpp"
#include "core/utf8.hpp"
#include "geo/file_name.hpp"
#include "geo/versions.hpp"

namespace talus::geo {

namespace {

std::string one_line(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
    while (!text.empty() && (text.back() == ' ' || text.back() == '.')) text.pop_back();
    return to_utf8(text);  // a message can quote the file
}

bool has_extension(const std::string& file, const std::string& extension) {
    return std::filesystem::path(file).extension() == extension;
}

}  // namespace

void prepare_gdal() {
    static std::once_flag once;
    std::call_once(once, [] {
        // GdalMessages works per thread; this covers messages from GDAL's own threads.
        CPLSetErrorHandler(CPLQuietErrorHandler);
        CPLSetConfigOption("CPL_VSIL_GZIP_WRITE_PROPERTIES", "NO");  // no file beside an input
        GDALAllRegister();
        (void)proj_version();  // see there
    });
}

GdalMessages::GdalMessages() {
    prepare_gdal();
    CPLErrorReset();
    CPLPushErrorHandlerEx(collect, this);
}

GdalMessages::~GdalMessages() {
    CPLPopErrorHandler();
}

void GdalMessages::collect(CPLErr level, CPLErrorNum, const char* message) {
    auto& self = *static_cast<GdalMessages*>(CPLGetErrorHandlerUserData());
    if (level >= CE_Failure && self.failure_.empty()) self.failure_ = one_line(message);
    if (level == CE_Warning) self.warning_ = one_line(message);
}

std::string GdalMessages::failure_or(const std::string& otherwise) const {
    return failure_.empty() ? otherwise : failure_;
}

std::string GdalMessages::warning_or(const std::string& otherwise) const {
    return warning_.empty() ? otherwise : warning_;
}

void GdalMessages::clear() {
    failure_.clear();
    warning_.clear();
}

GDALDatasetUniquePtr open_as_identified(const std::string& file, unsigned flags) {
    prepare_gdal();
    GDALDriverH found = GDALIdentifyDriverEx(file.c_str(), flags & (GDAL_OF_RASTER | GDAL_OF_VECTOR), nullptr, nullptr);
    const char* const driver[] = {found != nullptr ? GDALGetDriverShortName(found) : nullptr, nullptr};
    return GDALDatasetUniquePtr(GDALDataset::Open(file.c_str(), flags | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR,
                                                  found != nullptr ? driver : nullptr));
}

std::vector<Subdataset> subdatasets(GDALDataset& data) {
    std::vector<Subdataset> found;
    for (char** item = data.GetMetadata("SUBDATASETS"); item != nullptr && *item != nullptr; ++item) {
        const std::string entry = *item;
        const auto equals = entry.find("_NAME=");
        if (equals == std::string::npos) continue;
        Subdataset one{entry.substr(equals + 6), ""};
        one.layer = one.name.substr(one.name.rfind(':') + 1);
        while (one.layer.starts_with('/')) one.layer.erase(0, 1);  // paths in HDF5
        found.push_back(std::move(one));
    }
    return found;
}

namespace {

/// The raster of a container that `layer` names; one that is alone may be named too.
Result<GDALDatasetUniquePtr> open_raster_layer(const LayerOfFile& named, const std::string& gdal_name,
                                               GDALDatasetUniquePtr data) {
    std::string names;
    for (const Subdataset& one : subdatasets(*data)) {
        if (one.layer == named.layer) {
            if (GDALDatasetUniquePtr chosen = open_as_identified(one.name, GDAL_OF_RASTER)) {
                return Result<GDALDatasetUniquePtr>(std::move(chosen));
            }
            return Error{fmt::format("{}: the raster \"{}\" in it cannot be read", named.file, named.layer)};
        }
        names += (names.empty() ? "" : ", ") + one.layer;
    }
    if (!names.empty()) {
        return Error{fmt::format("{}: has no raster \"{}\"; its rasters: {}", named.file, named.layer, names)};
    }
    std::string own = std::filesystem::path(named.file).stem().string();
    const std::string driver = data->GetDriver() != nullptr ? data->GetDriver()->GetDescription() : "";
    if (driver == "GPKG") {
        GDALDatasetUniquePtr chosen = open_as_identified("GPKG:" + gdal_name + ":" + named.layer, GDAL_OF_RASTER);
        if (chosen) return Result<GDALDatasetUniquePtr>(std::move(chosen));
        if (const char* table = data->GetMetadataItem("IDENTIFIER")) own = table;
    } else if (GDALRasterBand* band = data->GetRasterCount() > 0 ? data->GetRasterBand(1) : nullptr) {
        if (const char* variable = band->GetMetadataItem("NETCDF_VARNAME")) own = variable;
    }
    if (own == named.layer) return Result<GDALDatasetUniquePtr>(std::move(data));
    return Error{fmt::format("{}: has no raster \"{}\"; it holds one, \"{}\"", named.file, named.layer, own)};
}

}  // namespace

Result<GDALDatasetUniquePtr> open_dataset(const std::string& name, unsigned flags, const std::string& kind) {
    GdalMessages messages;
    if (name.empty()) return Error{fmt::format("no file name given for a {}", kind)};

    TALUS_ASSIGN(const LayerOfFile named, split_layer(name));
    const std::string& file = named.file;
    TALUS_ASSIGN(const std::string gdal_name, name_for_gdal(file, flags, kind));
    messages.clear();
    // GDAL also accepts names that are not paths, such as NETCDF:"file.nc":band or /vsizip/...; only a name that GDAL
    // cannot open is examined as a path, to explain the failure.
    GDALDatasetUniquePtr data = open_as_identified(gdal_name, flags);
    if (data && !named.layer.empty() && (flags & GDAL_OF_RASTER) != 0) {
        return open_raster_layer(named, gdal_name, std::move(data));
    }
    if (data) return Result<GDALDatasetUniquePtr>(std::move(data));

    std::error_code failed;
    const auto status = std::filesystem::status(file, failed);
    const bool special = file.rfind("/vsi", 0) == 0;
    if (!special && status.type() == std::filesystem::file_type::not_found) {
        return Error{fmt::format("{}: no such file", file)};
    }
    if (!special && failed) return Error{fmt::format("{}: {}", file, failed.message())};
    if (std::filesystem::is_directory(status)) {
        return Error{fmt::format("{}: is a folder, not a {} file", file, kind)};
    }
    if (std::filesystem::is_regular_file(status)) {
        if (std::filesystem::file_size(file, failed) == 0) return Error{fmt::format("{}: is empty (0 bytes)", file)};
        VSILFILE* readable = VSIFOpenL(file.c_str(), "rb");
        if (readable == nullptr) return Error{fmt::format("{}: may not be read (permission)", file)};
        VSIFCloseL(readable);
    }
    return Error{fmt::format("{}: cannot be read as a {}: {}", file, kind,
                             messages.failure_or("GDAL does not know the format"))};
}

bool was_geojson(GDALDataset& data, OGRLayer& layer) {
    if (EQUAL(data.GetDriver()->GetDescription(), "GeoJSON")) return true;
    const char* const description = layer.GetMetadataItem("DESCRIPTION");
    return description != nullptr && std::string_view(description) == geojson_mark;
}

std::string shell_quoted(const std::string& file) {
    const bool plain = std::all_of(file.begin(), file.end(), [](unsigned char c) {
        return std::isalnum(c) != 0 || std::string("_-./+:,@%").find(static_cast<char>(c)) != std::string::npos;
    });
    if (plain && !file.empty()) return file;
    std::string quoted = "'";
    for (const char c : file) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

std::string mended_name(const std::string& file, const std::string& suffix, const std::string& extension) {
    std::filesystem::path path(file);
    const std::string stem =
        path.stem().string() + (has_extension(file, extension) && suffix.empty() ? "_new" : suffix);
    return shell_quoted((path.parent_path() / (stem + extension)).string());
}

}  // namespace talus::geo
