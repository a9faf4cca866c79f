#pragma once

#include <string>

#include "core/geometry.hpp"
#include "core/result.hpp"
#include "geo/crs.hpp"

namespace talus::geo {

/// An orthophoto in a format for browsers.
struct Orthophoto {
    std::string bytes;
    std::string type;  ///< "image/webp" or "image/png"
    int columns = 0, rows = 0;
};

/// Whether `file` is a picture that can be laid over `extent` (of the terrain, in `crs`); reads no pixels.
/// Errors, each naming the file: missing, no position, unknown CRS, not 8 bits per band, beside the terrain.
[[nodiscard]] Status check_orthophoto(const std::string& file, const Crs& crs, const Extent& extent);

/// Warps a picture to `crs`, cut to `extent`, transparent where it has no data; the longer edge has at most
/// `max_pixels`, and no more than the file. Errors: as check_orthophoto, and pixels that cannot be read.
[[nodiscard]] Result<Orthophoto> read_orthophoto(const std::string& file, const Crs& crs, const Extent& extent,
                                                 int max_pixels);

}  // namespace talus::geo
