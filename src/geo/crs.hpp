#pragma once

#include <string>

#include "core/result.hpp"

namespace talus::geo {

/// A coordinate reference system as read from data.
struct Crs {
    std::string wkt;     ///< WKT2; empty: none given
    std::string name;    ///< "Hong Kong 1980 Grid System"
    int epsg = 0;        ///< 0: not an EPSG code
    bool local = false;  ///< metres of its own, as those of a flume: where it lies on the globe is not known

    /// Local coordinates of data that state no system.
    [[nodiscard]] static Crs own_metres();
    /// "EPSG:2326 (Hong Kong 1980 Grid System)" or the name alone.
    [[nodiscard]] std::string label() const;
};

/// "EPSG:2326", WKT or anything else that PROJ knows, or "local". Errors: unknown.
[[nodiscard]] Result<Crs> crs_from_text(const std::string& text);

}  // namespace talus::geo
