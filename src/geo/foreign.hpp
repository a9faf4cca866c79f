#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "geo/layer_style.hpp"
#include "geo/repair_raster.hpp"

/// Untrusted files, which somebody else made. They are read once, by a child process that sees nothing but their
/// folder, and written again here from the numbers that it hands over: nothing else of this program opens them.
/// docs/security.md.
namespace talus::geo {

/// How the child process is started and what it may take.
struct ForeignReader {
    std::filesystem::path program = {};             ///< which calls read_foreign() first thing; empty: this one
    std::function<bool()> shall_end = {};           ///< asked several times a second; the child is then killed
    bool isolated = true;                           ///< false: as on a kernel without Landlock and seccomp
    std::uint64_t memory = std::uint64_t{4} << 30;  ///< bytes of address space
    std::uint64_t bytes = std::uint64_t{3} << 30;   ///< that it hands over
    std::chrono::seconds processor_time{180}, patience{600};  ///< patience: by the clock
};

/// What a file may be, and how much of it is wanted.
struct ForeignWanted {
    bool raster = false, vector = false, mesh = false, picture = false;
    bool styles = false;       ///< of the layers of a vector file, where it has some
    int bands = 1;             ///< of a raster
    double cells = 5e7;        ///< of a band, at most
    std::string purpose = {};  ///< what is said of a file that is none of these: "no raster"
};

/// The file as it was written again.
struct ForeignFile {
    std::filesystem::path file;                ///< GeoTIFF, GeoPackage, or roofs.json
    FileKind kind = FileKind::other;           ///< other: a mesh
    std::vector<std::filesystem::path> parts;  ///< files that were read beside it, in its folder
    std::vector<LayerSymbols> layers;          ///< of each layer of a vector file
};

/// Reads `file` and writes it again as STEM.tif (a GeoTIFF without metadata, masks and overviews), STEM.gpkg (a
/// GeoPackage of tables alone) or STEM.roofs.json. Errors: not of the kinds wanted, too large, takes too long, damaged,
/// a reference system that names a file, cancelled; then nothing remains.
[[nodiscard]] Result<ForeignFile> convert_foreign(const std::filesystem::path& file, const ForeignWanted& wanted,
                                                  const std::filesystem::path& stem, const ForeignReader& reader);

/// Does the child's part and ends the process if the arguments are the child's. To be called before anything else.
void read_foreign(int argc, const char* const* argv);

}  // namespace talus::geo
