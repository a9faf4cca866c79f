#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "core/geometry.hpp"
#include "core/result.hpp"
#include "geo/crs.hpp"

namespace talus::geo {

using Attribute = std::variant<std::monostate, double, std::string>;  ///< monostate: null

/// A polygon or multi-polygon in the terrain's CRS.
struct PolygonFeature {
    std::int64_t fid = 0;  ///< the number that GIS programs show
    std::vector<Polygon> parts;
    std::map<std::string, Attribute> attributes;
};

struct PolygonLayer {
    std::vector<PolygonFeature> features;
    /// "reprojected from EPSG:4326 (WGS 84) to EPSG:2326 (...)", "taken to be in ..."; empty: same CRS
    std::string reprojection;
    std::size_t closed_lines = 0;   ///< features that are closed lines, taken as polygons
    bool encoding_assumed = false;  ///< some text was not UTF-8 and was read as Windows-1252
};

/// A line in the terrain's CRS; several connected parts are joined.
struct LineFeature {
    std::vector<PlanPoint> points;
    std::string name;  ///< its attribute "name", in any case; empty: none
};

struct LineLayer {
    std::vector<LineFeature> features;
    std::string reprojection;
};

struct SingleLine {
    std::vector<PlanPoint> points;
    std::string reprojection;
};

/// Reads polygons from GeoJSON, GeoPackage, Shapefile or any other OGR source; `layer` empty: that which the name of
/// the file says (FILE|layername=NAME), or else the only one. Vectors are reprojected to `terrain_crs`, with a note;
/// where that is local, a layer with a local system, with none or with one that says nothing (GeoJSON without crs) is
/// taken to be in it. Closed lines count as polygons; all text is UTF-8. Errors: missing file, a folder that is no data
/// source, no such layer or several without a name, empty layer, other geometry, an open line, missing CRS,
/// self-intersecting polygon (names the feature and the place).
[[nodiscard]] Result<PolygonLayer> read_polygons(const std::string& file, const std::string& layer,
                                                 const Crs& terrain_crs);

/// Reads lines; all text is UTF-8. Errors as above.
[[nodiscard]] Result<LineLayer> read_lines(const std::string& file, const std::string& layer, const Crs& terrain_crs);

/// Reads a layer with a single line. Errors as above, and: it has several (says how many, and how one is taken out).
[[nodiscard]] Result<SingleLine> read_line(const std::string& file, const std::string& layer, const Crs& terrain_crs);

/// A column of a vector layer to write.
struct Field {
    std::string name;
    bool is_text = false;
};

struct OutputFeature {
    std::vector<Polygon> polygon;   ///< either this
    std::vector<PlanPoint> line;    ///< or this; of a single point: a point
    std::vector<Attribute> values;  ///< one per field
    /// Of a line that has them, as many as it has points: elevations, m, and measures, such as times.
    std::vector<double> z = {}, m = {};
};

/// Writes (appends) a layer to a GeoPackage, creating the file when needed.
[[nodiscard]] Status write_geopackage_layer(const std::string& file, const std::string& layer,
                                            const std::vector<Field>& fields,
                                            const std::vector<OutputFeature>& features, const Crs& crs);

/// A QGIS style of a layer, as QML.
struct LayerStyle {
    std::string layer, qml;
};

/// Adds the table `layer_styles` to a GeoPackage, from which QGIS takes the style of a layer that it opens.
[[nodiscard]] Status write_geopackage_styles(const std::string& file, const std::vector<LayerStyle>& styles);

}  // namespace talus::geo
