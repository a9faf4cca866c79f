// What is uploaded for a new scene: archives unpacked, the file that is meant, written again.
#include <algorithm>
#include <array>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/lower_case.hpp"
#include "core/try.hpp"
#include "geo/zip_archive.hpp"
#include "scene/bundle.hpp"
#include "serve/draft.hpp"
#include "serve/library.hpp"

namespace talus::serve {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t longest_ending = 10;
constexpr double largest_photo = 1e9;  // pixels; it is read at a fraction of its size

/// Files beside another one that say where it lies or hold its parts.
constexpr std::array<std::string_view, 14> companions = {".shx", ".dbf",  ".prj", ".cpg", ".hdr", ".tfw", ".tifw",
                                                         ".jgw", ".jpgw", ".pgw", ".wld", ".j2w", ".mtl", ".bin"};

bool has_ending(const std::string& name, std::string_view ending) {
    return lower_case(fs::path(name).extension().string()) == ending;
}

bool is_companion(const fs::path& file) {
    const std::string ending = lower_case(file.extension().string());
    return std::find(companions.begin(), companions.end(), ending) != companions.end();
}

std::vector<fs::path> files_in(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code error;
    for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
        if (it->is_regular_file(error)) files.push_back(it->path());
    }
    std::sort(files.begin(), files.end());
    return files;
}

/// The file of an archive that its user means: the only one that is no companion. What none of both kinds is, such as
/// a description or a virtual raster beside a raster, is removed.
Result<fs::path> only_file(const std::string& name, const fs::path& folder) {
    constexpr std::array<std::string_view, 19> known = {
        ".tif",  ".tiff", ".asc",  ".img", ".png",     ".jpg",      ".jpeg", ".jp2", ".shp", ".gpkg",
        ".json", ".obj",  ".gltf", ".glb", ".geojson", ".cityjson", ".flt",  ".bil", ".hgt"};
    std::vector<fs::path> found;
    std::error_code ignored;
    for (const fs::path& file : files_in(folder)) {
        const std::string ending = lower_case(file.extension().string());
        if (std::find(known.begin(), known.end(), ending) != known.end()) {
            found.push_back(file);
        } else if (!is_companion(file)) {
            fs::remove(file, ignored);
        }
    }
    if (found.size() == 1) return found.front();
    if (found.empty()) return Error{name + ": there is no raster, no layer and no mesh in it"};
    return Error{fmt::format("{}: there are {} files in it, {} and {}; pack one of them with its companions", name,
                             found.size(), found[0].filename().string(), found[1].filename().string())};
}

/// Of all files below a folder.
std::uint64_t bytes_in(const fs::path& folder) {
    std::uint64_t bytes = 0;
    std::error_code error;
    for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
        if (it->is_regular_file(error)) bytes += it->file_size(error);
    }
    return bytes;
}

geo::ForeignWanted wanted_for(std::string_view role) {
    geo::ForeignWanted wanted;
    wanted.raster = role == "terrain" || role == "release";
    wanted.vector = role == "release" || role == "buildings";
    wanted.mesh = role == "buildings";
    wanted.picture = role == "orthophoto";
    wanted.purpose = role == "buildings"
                         ? "holds no polygons; buildings are a GeoPackage, GeoJSON, zipped Shapefile, or a mesh"
                     : role == "release" ? "is no raster of thickness and no layer of polygons"
                                         : "is no raster; a GeoTIFF is one, and other formats that GDAL reads are";
    return wanted;
}

}  // namespace

std::string upload_name_of(const std::string& name) {
    const std::string lower = lower_case(fs::path(name).filename().string());
    std::string ending = lower.ends_with(".city.json") ? ".city.json" : fs::path(lower).extension().string();
    const std::string stem = file_name_of(lower.substr(0, lower.size() - ending.size()));
    ending = file_name_of(ending.substr(ending.empty() ? 0 : 1));
    if (ending == "city-json") ending = "city.json";
    if (ending.size() > longest_ending) ending.resize(longest_ending);
    return (stem.empty() ? "file" : stem) + (ending.empty() ? "" : "." + ending);
}

std::uint64_t Draft::bytes_left() const {
    const std::uint64_t there = bytes_in(folder_);
    return limits_.bytes > there ? limits_.bytes - there : 0;
}

Result<fs::path> unpack_upload(const std::string& name, const fs::path& upload, const fs::path& to,
                               const geo::ZipLimits& limits) {
    const auto named = [&](const Status& status) {
        return status ? status : Status(Error{with_name(status.error().message, upload, name)});
    };
    if (has_ending(name, ".zip")) {
        TALUS_TRY(named(geo::unpack_zip(upload, to, limits)));
        return only_file(name, to);
    }
    const bool packed = has_ending(name, ".gz");
    const std::string inner = packed ? fs::path(name).stem().string() : name;
    if (is_companion(inner) || has_ending(inner, ".shp")) {
        return Error{name + ": is one of several files that belong together; pack all of them in one ZIP archive"};
    }
    constexpr std::array<std::string_view, 4> archives = {".zip", ".tar", ".gz", ""};
    const auto ends = [&](std::string_view ending) { return has_ending(inner, ending); };
    if (has_ending(name, ".tgz") || (packed && std::any_of(archives.begin(), archives.end(), ends))) {
        return Error{name + ": is not read; give the file in it, alone in .gz (dem.tif.gz) or in a ZIP archive"};
    }
    std::error_code error;
    const fs::path file = to / upload_name_of(inner);
    fs::create_directories(to, error);
    if (!error && packed) {
        TALUS_TRY(named(geo::unpack_gzip(upload, file, {limits.bytes, 1})));
    } else if (!error) {
        fs::rename(upload, file, error);
    }
    if (error) return Error{name + ": cannot be kept; is the disk full?"};
    return file;
}

Result<Draft::Upload> Draft::convert(std::string_view role, const std::string& name, const fs::path& upload,
                                     const fs::path& to, const geo::ForeignReader& reader) const {
    Upload made{name, {}, 0, geo::FileKind::other};
    const std::uint64_t most = bytes_left();
    if (role == "bundle") {
        auto unpacked = scene::unpack_bundle(upload, to, {most, limits_.files}, reader);
        if (!unpacked) return Error{with_name(unpacked.error().message, upload, name)};
        made.file = std::move(unpacked->scene);
    } else {
        const fs::path foreign = folder_ / "foreign";
        TALUS_ASSIGN(const fs::path file, unpack_upload(name, upload, foreign, {most, limits_.files}));
        geo::ForeignWanted wanted = wanted_for(role);
        wanted.cells = role == "orthophoto" ? largest_photo : limits_.cells;
        std::error_code error;
        fs::create_directories(to, error);
        std::string stem = upload_name_of(file.filename().string());
        stem.resize(std::min(stem.size(), stem.find('.')));
        TALUS_ASSIGN(const auto converted, geo::convert_foreign(file, wanted, to / stem, reader));
        made.file = converted.file;
        made.kind = converted.kind;
        fs::remove_all(foreign, error);
    }
    made.bytes = bytes_in(to);
    if (made.bytes <= most) return Result<Upload>(std::move(made));
    return Error{fmt::format("{}: unpacked, the files of this scene are longer than {:.4g} MB", name,
                             static_cast<double>(limits_.bytes) / 1e6)};
}

}  // namespace talus::serve
