#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gdal_priv.h>
#include <ogr_geometry.h>

#include "core/result.hpp"
#include "geo/foreign.hpp"
#include "geo/layer_style.hpp"
#include "geo/mesh.hpp"
#include "geo/vector.hpp"

/// What the child process hands over (foreign.hpp): a line of JSON that describes it, then numbers. The reader checks
/// all of it, because the child may have been taken over by the file that it read. Not for other modules.
namespace talus::geo {

inline constexpr const char* foreign_word = "--read-foreign";  ///< first argument of the child

/// A raster without its cells.
struct ForeignRaster {
    struct Band {
        GDALDataType type = GDT_Float32;
        std::optional<double> nodata;
        double scale = 1, offset = 0;
        std::string unit;
        int colour = 0;  ///< GDALColorInterp
    };
    int columns = 0, rows = 0;
    std::vector<Band> bands;  ///< of one type
    std::optional<std::array<double, 6>> place;
    bool control_points = false;  ///< placed by them only
    std::string crs;              ///< WKT2; empty: none
};

struct ForeignLayer {
    std::string name, crs;
    bool of_geojson = false;  ///< WGS 84 may be what is read where nothing is stated
    std::vector<Field> fields;
    LayerSymbols symbols;  ///< by the file's own style; empty: none was asked for, or there is none
};

/// A mesh as arrays.
struct ForeignMesh {
    int epsg = 0;  ///< of its reference system; 0: not stated
    std::vector<MeshBuilding> buildings;
};

/// Whether a reference system (WKT) names files, as grids of changes of datum are.
[[nodiscard]] bool names_files(const std::string& wkt);

[[nodiscard]] std::string to_text(const ForeignMesh& mesh);
/// Errors name what is wrong.
[[nodiscard]] Result<ForeignMesh> read_foreign_mesh(const std::string& text);

/// Writes what is handed over.
class ForeignOutput {
  public:
    explicit ForeignOutput(std::FILE* file) : file_(file) {}
    void error(const std::string& sentence);
    void raster(const ForeignRaster& raster);
    void cells(const void* bytes, std::size_t count) { put(bytes, count); }
    void layers(const std::vector<ForeignLayer>& layers);
    /// Each layer's features follow, and their end.
    void end_of_features() { value(std::uint8_t{0}); }
    void feature(const OGRGeometry* geometry, const std::vector<Attribute>& values);
    void mesh(const ForeignMesh& mesh, const std::vector<std::string>& parts);
    [[nodiscard]] bool complete() { return good_ && std::fflush(file_) == 0; }

  private:
    void put(const void* bytes, std::size_t count) { good_ = std::fwrite(bytes, 1, count, file_) == count && good_; }
    template <class T>
    void value(const T& value) {
        put(&value, sizeof value);
    }
    void header(const std::string& text);
    void geometry(const OGRGeometry& geometry);

    std::FILE* file_;
    bool good_ = true;
};

/// Writes the canonical file from what the child handed over. `file`, `parts` and `layers` are set.
[[nodiscard]] Status write_again(std::FILE* in, std::uint64_t bytes, const std::string& stem, double most_cells,
                                 int most_bands, std::string& file, std::vector<std::string>& parts,
                                 std::vector<LayerSymbols>& layers);

}  // namespace talus::geo
