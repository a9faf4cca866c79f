#pragma once

#include <string>

namespace talus::geo {

/// A coordinate reference system as read from data.
struct Crs {
    std::string wkt;   ///< WKT2; empty: none given
    std::string name;  ///< "Hong Kong 1980 Grid System"
    int epsg = 0;      ///< 0: not an EPSG code

    /// "EPSG:2326 (Hong Kong 1980 Grid System)" or the name alone.
    [[nodiscard]] std::string label() const;
};

}  // namespace talus::geo
