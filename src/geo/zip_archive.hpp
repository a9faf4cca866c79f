#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/result.hpp"

namespace talus::geo {

/// What an archive may hold, so that a small one cannot fill the disk.
struct ZipLimits {
    std::uint64_t bytes = std::uint64_t{4} << 30;  ///< of all files, unpacked
    std::size_t files = 1000;
};

/// Unpacks a ZIP archive into a folder, which is made. Every name in it must lead to a place in the folder. Counts what
/// it writes, whatever the archive says about sizes. Errors: no ZIP archive, a name that leads elsewhere, beyond the
/// limits, damaged, cannot be written; then nothing remains.
[[nodiscard]] Status unpack_zip(const std::filesystem::path& archive, const std::filesystem::path& folder,
                                const ZipLimits& limits = {});

/// Unpacks a single file that gzip packed, `file`, as `to`, in a folder that is there. Errors: as of an archive.
[[nodiscard]] Status unpack_gzip(const std::filesystem::path& file, const std::filesystem::path& to,
                                 const ZipLimits& limits = {});

/// A file to pack.
struct ZipEntry {
    std::string name;            ///< in the archive, "data/terrain.tif"
    std::filesystem::path file;  ///< on disk; empty: `text` is what it holds
    std::string text{};
};

/// Errors: a file cannot be read, the archive cannot be written; then none remains.
[[nodiscard]] Status write_zip(const std::filesystem::path& archive, const std::vector<ZipEntry>& entries);

/// Whether files of a format (the name of GDAL's driver) are complete by themselves: none leads elsewhere, as a virtual
/// raster can.
[[nodiscard]] bool names_no_others(const std::string& format);

/// The file and those beside it that belong to it: the parts of a Shapefile, world files, metadata. Errors: a format
/// that may name files elsewhere or the network, such as a virtual raster.
[[nodiscard]] Result<std::vector<std::filesystem::path>> files_of(const std::filesystem::path& file);

}  // namespace talus::geo
