#pragma once

#include <string>

#include "core/geometry.hpp"
#include "core/result.hpp"
#include "geo/crs.hpp"

namespace talus {

/// A picture of the ground from above, as a browser takes it.
struct Orthophoto {
    std::string bytes;
    std::string type;  ///< "image/webp" or "image/png"
    int columns = 0, rows = 0;
};

/// Whether `file` is a picture that can be laid over `extent` (of the terrain, in `crs`); reads no pixels.
/// Errors, each naming the file: missing, no position, unknown CRS, not 8 bits per band, beside the terrain.
[[nodiscard]] Status check_orthophoto(const std::string& file, const Crs& crs, const Extent& extent);

/// Brings a picture into `crs`, cut to `extent`, transparent where it has nothing; the longer edge has `most_pixels` at
/// most, and no more than the file has itself. Errors: as check_orthophoto, and pixels that cannot be read.
[[nodiscard]] Result<Orthophoto> read_orthophoto(const std::string& file, const Crs& crs, const Extent& extent,
                                                 int most_pixels);

}  // namespace talus
