#include "geo/file_name.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

#include <cpl_string.h>
#include <cpl_vsi.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/lower_case.hpp"
#include "geo/gdal.hpp"
#include "geo/zip_archive.hpp"

namespace talus::geo {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_named = 12;  // members of an archive in a message

bool is_regular(const std::string& name) {
    std::error_code failed;
    return fs::is_regular_file(name, failed);
}

bool has_ending(const std::string& name, std::string_view ending) {
    const std::string lower = lower_case(name);
    return lower.size() > ending.size() && lower.ends_with(ending);
}

/// The archive in "dem.zip/valley/dem.tif"; empty: there is none.
std::string archive_in(const std::string& name) {
    const std::string lower = lower_case(name);
    for (std::size_t at = lower.find(".zip"); at != std::string::npos; at = lower.find(".zip", at + 4)) {
        std::string archive = name.substr(0, at + 4);
        if ((at + 4 == name.size() || name[at + 4] == '/') && is_regular(archive)) return archive;
    }
    return "";
}

/// Braces: the archive's name may hold any characters.
std::string in_archive(const std::string& archive, const std::string& member) {
    return "/vsizip/{" + archive + "}/" + member;
}

struct ArchiveMember {
    std::string name, format;
};

/// What GDAL takes for a data set of its own but belongs to another: tables of a Shapefile, overviews, masks.
bool belongs_to_another(const ArchiveMember& member) {
    constexpr std::array<std::string_view, 7> endings = {".dbf", ".shx", ".ovr", ".msk", ".xml", ".prj", ".cpg"};
    return std::any_of(endings.begin(), endings.end(),
                       [&](std::string_view ending) { return has_ending(member.name, ending); });
}

std::vector<ArchiveMember> data_sets(const std::string& archive, unsigned flags) {
    std::vector<ArchiveMember> found;
    const CPLStringList names(VSIReadDirRecursive(("/vsizip/{" + archive + "}").c_str()));
    for (int k = 0; k < names.size(); ++k) {
        ArchiveMember member{names[k], ""};
        if (member.name.ends_with('/') || member.name.starts_with("__MACOSX/")) continue;
        GDALDriverH driver = GDALIdentifyDriverEx(in_archive(archive, member.name).c_str(),
                                                  flags & (GDAL_OF_RASTER | GDAL_OF_VECTOR), nullptr, nullptr);
        if (driver == nullptr || belongs_to_another(member)) continue;
        member.format = GDALGetDriverShortName(driver);
        found.push_back(std::move(member));
    }
    // A picture beside a data set is a preview.
    const auto is_picture = [](const ArchiveMember& m) { return m.format == "PNG" || m.format == "JPEG"; };
    if (!std::all_of(found.begin(), found.end(), is_picture)) std::erase_if(found, is_picture);
    return found;
}

Result<std::string> name_in_zip(const std::string& file, const std::string& archive, unsigned flags,
                                const std::string& kind) {
    const GdalMessages messages;
    std::string member = file.size() > archive.size() ? file.substr(archive.size() + 1) : "";
    if (member.empty()) {
        const std::vector<ArchiveMember> found = data_sets(archive, flags);
        if (found.empty()) {
            return Error{
                fmt::format("{}: there is no {} in this archive{}", file, kind,
                            messages.has_failure() ? ", which cannot be read: " + messages.failure_or("") : "")};
        }
        if (found.size() > 1) {
            std::vector<std::string> names;
            names.reserve(found.size());
            for (const ArchiveMember& one : found) names.push_back(shell_quoted(file + "/" + one.name));
            const bool more = names.size() > most_named;
            names.resize(std::min(names.size(), most_named));
            return Error{fmt::format("{}: holds {} data sets; name one of them: {}{}", file, found.size(),
                                     fmt::join(names, ", "), more ? ", ..." : "")};
        }
        member = found.front().name;
    }
    const std::string name = in_archive(archive, member);
    GDALDriverH driver =
        GDALIdentifyDriverEx(name.c_str(), flags & (GDAL_OF_RASTER | GDAL_OF_VECTOR), nullptr, nullptr);
    if (driver == nullptr) {
        VSIStatBufL stat;
        if (VSIStatL(name.c_str(), &stat) == 0) return name;  // whoever opens it says what is wrong
        return Error{fmt::format("{}: there is no {} in {}", file, member, archive)};
    }
    if (const std::string format = GDALGetDriverShortName(driver); !names_no_others(format)) {
        return Error{
            fmt::format("{}: a file of the format {} may name other files and is not read from an archive; "
                        "unpack it",
                        file, format)};
    }
    return name;
}

}  // namespace

Result<LayerOfFile> split_layer(const std::string& name) {
    const std::size_t bar = name.find('|');
    if (bar == std::string::npos || is_regular(name)) return LayerOfFile{name, ""};
    constexpr std::string_view word = "layername=";
    const std::string rest = name.substr(bar + 1);
    if (!lower_case(rest).starts_with(word) || rest.size() == word.size() || rest.find('|') != std::string::npos) {
        return Error{fmt::format("{}: only a layer can be named behind \"|\", as in {}|layername=NAME", name,
                                 name.substr(0, bar))};
    }
    return LayerOfFile{name.substr(0, bar), rest.substr(word.size())};
}

bool is_gdal_name(const std::string& name) {
    if (name.starts_with("/vsi")) return true;
    const std::size_t colon = name.find(':');
    return colon != std::string::npos && colon >= 2 &&
           name.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789") == colon;
}

std::string file_on_disk(const std::string& name) {
    if (is_regular(name) || name.starts_with("/vsi")) return name;
    const Result<LayerOfFile> split = split_layer(name);
    const std::string& file = split ? split->file : name;
    const std::string archive = archive_in(file);
    return archive.empty() ? file : archive;
}

Result<std::string> name_for_gdal(const std::string& file, unsigned flags, const std::string& kind) {
    if (file.starts_with("/vsi")) return file;
    prepare_gdal();
    if (has_ending(file, ".gz") && is_regular(file)) {
        return "/vsigzip/" + fs::absolute(file).lexically_normal().string();
    }
    const std::string archive = archive_in(file);
    if (archive.empty() || has_ending(file, ".shp.zip")) return file;  // GDAL's own reader takes these
    return name_in_zip(file, archive, flags, kind);
}

}  // namespace talus::geo
