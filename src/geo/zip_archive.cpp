#include "geo/zip_archive.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <string_view>
#include <system_error>

#include <cpl_string.h>
#include <fmt/format.h>

#include "core/lower_case.hpp"
#include "core/try.hpp"
#include "geo/gdal.hpp"

namespace talus::geo {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t block_size = std::size_t{1} << 20;
constexpr std::size_t longest_name = 255;

/// Formats of one file, or of files of one name, that name no others.
constexpr std::array<std::string_view, 26> archived_formats = {
    "GTiff",  "COG",  "AAIGrid", "GPKG", "GeoJSON", "ESRI Shapefile", "FlatGeobuf",  "CSV",       "KML",
    "LIBKML", "HFA",  "PNG",     "JPEG", "XYZ",     "netCDF",         "HDF5",        "SRTMHGT",   "USGSDEM",
    "EHdr",   "ENVI", "SAGA",    "GSAG", "GSBG",    "GS7BG",          "JP2OpenJPEG", "GeoJSONSeq"};

struct CloseArchived {
    void operator()(VSILFILE* file) const { VSIFCloseL(file); }
};
using File = std::unique_ptr<VSILFILE, CloseArchived>;

std::string inside(const fs::path& archive, const std::string& name = "") {
    // Braces around the archive's name: it may hold any characters, and need not end in .zip.
    return "/vsizip/{" + fs::absolute(archive).string() + "}" + (name.empty() ? "" : "/" + name);
}

/// What is wrong with a name in an archive; empty: nothing.
std::string wrong_name(const std::string& name) {
    if (name.size() > longest_name) return "is longer than 255 bytes";
    for (const unsigned char c : name) {
        if (c < 0x20 || c == 0x7f || c == '\\' || c == ':') return "has a character that no file name may have here";
    }
    const fs::path path(name);
    if (name.empty() || path.is_absolute()) return "is not a relative path";
    for (const fs::path& part : path) {
        if (part == ".." || part == ".") return "leads out of the folder";
    }
    return "";
}

struct Member {
    std::string name;
    bool folder;
};

Result<std::vector<Member>> members(const fs::path& archive, const ZipLimits& limits) {
    std::error_code failed;
    if (!fs::exists(archive, failed)) return Error{archive.string() + ": no such file"};
    const GdalMessages messages;
    std::vector<Member> all;
    const std::unique_ptr<VSIDIR, decltype(&VSICloseDir)> folder(VSIOpenDir(inside(archive).c_str(), -1, nullptr),
                                                                 &VSICloseDir);
    if (!folder) return Error{archive.string() + ": is not a ZIP archive, or it is damaged"};
    while (const VSIDIREntry* entry = VSIGetNextDirEntry(folder.get())) {
        const std::string name = entry->pszName;
        if (const std::string wrong = wrong_name(name); !wrong.empty()) {
            return Error{fmt::format("{}: the name \"{}\" in it {}", archive.string(), name, wrong)};
        }
        all.push_back({name, VSI_ISDIR(entry->nMode) != 0});
        if (all.size() > limits.files) {
            return Error{fmt::format("{}: holds more than {} files", archive.string(), limits.files)};
        }
    }
    if (all.empty()) return Error{archive.string() + ": is not a ZIP archive, or it is empty"};
    return all;
}

/// Copies what is unpacked while it is read, and adds its bytes to `written`. `name`: of the archive, and of the file
/// in it.
Status copy_unpacked(VSILFILE* in, const GdalMessages& messages, const fs::path& to, const ZipLimits& limits,
                     std::uint64_t& written, const std::string& archive, const std::string& name) {
    std::ofstream out(to, std::ios::binary);
    std::string block(block_size, '\0');
    while (const std::size_t count = VSIFReadL(block.data(), 1, block.size(), in)) {
        written += count;
        if (written > limits.bytes) {
            return Error{fmt::format("{}: holds more than {:.3g} GB unpacked", archive,
                                     static_cast<double>(limits.bytes) / 1e9)};
        }
        if (!out.write(block.data(), static_cast<std::streamsize>(count))) break;
    }
    out.close();
    if (!out) return Error{fmt::format("{}: cannot be written; is the disk full?", to.string())};
    if (messages.has_failure()) {
        return Error{fmt::format("{}: {}is damaged: {}", archive, name, messages.failure_or(""))};
    }
    return {};
}

/// Adds to `written` the bytes of one file.
Status unpack_member(const fs::path& archive, const Member& member, const fs::path& folder, const ZipLimits& limits,
                     std::uint64_t& written) {
    const fs::path to = folder / member.name;
    std::error_code failed;
    fs::create_directories(member.folder ? to : to.parent_path(), failed);
    if (failed) return Error{fmt::format("{}: cannot be made: {}", to.string(), failed.message())};
    if (member.folder) return {};
    const GdalMessages messages;
    const File in(VSIFOpenL(inside(archive, member.name).c_str(), "rb"));
    if (!in) return Error{fmt::format("{}: \"{}\" in it cannot be read", archive.string(), member.name)};
    return copy_unpacked(in.get(), messages, to, limits, written, archive.string(),
                         fmt::format("\"{}\" in it ", member.name));
}

Status pack(VSILFILE* out, const ZipEntry& entry) {
    if (entry.file.empty()) {
        if (VSIFWriteL(entry.text.data(), 1, entry.text.size(), out) == entry.text.size()) return {};
        return Error{"cannot be written; is the disk full?"};
    }
    std::ifstream in(entry.file, std::ios::binary);
    if (!in) return Error{fmt::format("{} cannot be read", entry.file.string())};
    std::string block(block_size, '\0');
    while (in.read(block.data(), static_cast<std::streamsize>(block.size())), in.gcount() > 0) {
        const auto count = static_cast<std::size_t>(in.gcount());
        if (VSIFWriteL(block.data(), 1, count, out) != count) return Error{"cannot be written; is the disk full?"};
    }
    return in.bad() ? Status(Error{fmt::format("{} cannot be read to its end", entry.file.string())}) : Status();
}

}  // namespace

Status unpack_gzip(const fs::path& file, const fs::path& to, const ZipLimits& limits) {
    prepare_gdal();
    const auto unpack = [&]() -> Status {
        const GdalMessages messages;
        const File in(VSIFOpenL(("/vsigzip/" + fs::absolute(file).string()).c_str(), "rb"));
        if (!in) return Error{file.string() + ": is not a gzip file, or it is damaged"};
        std::uint64_t written = 0;
        TALUS_TRY(copy_unpacked(in.get(), messages, to, limits, written, file.string(), ""));
        return written > 0 ? Status() : Status(Error{file.string() + ": is damaged, or there is nothing in it"});
    };
    Status unpacked = unpack();
    std::error_code ignored;
    if (!unpacked) fs::remove(to, ignored);
    return unpacked;
}

Status unpack_zip(const fs::path& archive, const fs::path& folder, const ZipLimits& limits) {
    prepare_gdal();
    TALUS_ASSIGN(const auto all, members(archive, limits));
    std::uint64_t written = 0;
    for (const Member& member : all) {
        Status unpacked = unpack_member(archive, member, folder, limits, written);
        if (unpacked) continue;
        std::error_code ignored;
        fs::remove_all(folder, ignored);
        return unpacked;
    }
    return {};
}

Status write_zip(const fs::path& archive, const std::vector<ZipEntry>& entries) {
    prepare_gdal();
    const GdalMessages messages;
    std::error_code ignored;
    fs::remove(archive, ignored);  // otherwise the entries are added to those in it
    // The outer handle keeps the archive open between its files.
    File whole(VSIFOpenL(inside(archive).c_str(), "wb"));
    Status written = whole ? Status() : Status(Error{"cannot be written: " + messages.failure_or("no such folder")});
    for (const ZipEntry& entry : entries) {
        if (!written) break;
        File out(VSIFOpenL(inside(archive, entry.name).c_str(), "wb"));
        written = out ? pack(out.get(), entry) : Status(Error{"cannot be written: " + messages.failure_or("")});
        if (VSIFCloseL(out.release()) != 0 && written) written = Error{"cannot be written; is the disk full?"};
    }
    if (whole && VSIFCloseL(whole.release()) != 0 && written) written = Error{"cannot be written; is the disk full?"};
    if (written) return {};
    fs::remove(archive, ignored);
    return Error{archive.string() + ": " + written.error().message};
}

bool names_no_others(const std::string& format) {
    return std::find(archived_formats.begin(), archived_formats.end(), format) != archived_formats.end();
}

Result<std::vector<fs::path>> files_of(const fs::path& file) {
    prepare_gdal();
    if (const std::string ending = lower_case(file.extension().string()); ending == ".zip" || ending == ".gz") {
        return Error{file.string() + ": an archive is not packed into another; unpack it"};
    }
    const GdalMessages messages;
    GDALDriverH driver = GDALIdentifyDriverEx(file.c_str(), GDAL_OF_RASTER | GDAL_OF_VECTOR, nullptr, nullptr);
    if (driver == nullptr) return std::vector<fs::path>{file};  // not GDAL's: a mesh
    const std::string format = GDALGetDriverShortName(driver);
    if (!names_no_others(format)) {
        return Error{fmt::format(
            "{}: a file of the format {} may name other files and is not packed; save it as GeoTIFF or GeoPackage",
            file.string(), format)};
    }
    std::vector<fs::path> all = {file};
    const GDALDatasetUniquePtr data = open_as_identified(file.string(), GDAL_OF_RASTER | GDAL_OF_VECTOR);
    if (!data) return all;
    const CPLStringList listed(data->GetFileList());
    for (int k = 0; k < listed.size(); ++k) {
        std::error_code failed;
        const fs::path other = listed[k];
        if (!fs::is_regular_file(other, failed) || fs::equivalent(other, file, failed)) continue;
        if (fs::weakly_canonical(other.parent_path(), failed) ==
            fs::weakly_canonical(fs::absolute(file).parent_path(), failed)) {
            all.push_back(other);
        }
    }
    return all;
}

}  // namespace talus::geo
