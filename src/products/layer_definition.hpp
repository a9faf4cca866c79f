#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/result.hpp"

namespace talus::products {

/// A QGIS layer definition (.qlr): one file that opens the results of a folder as a group of styled layers. Paths in
/// it are relative, so the folder can be moved.
class LayerDefinition {
  public:
    /// `group`: name of the group. `wkt`: reference system of all layers.
    LayerDefinition(std::string group, std::string wkt) : group_(std::move(group)), wkt_(std::move(wkt)) {}

    /// `file`: its name within the folder. `style`: a QGIS style (.qml). A layer that is not shown is in the group,
    /// switched off. Rasters are drawn under vectors, those added first on top.
    void add_raster(const std::string& name, const std::string& file, const std::string& style, bool shown);
    void add_vector(const std::string& name, const std::string& file, const std::string& layer,
                    const std::string& style, bool shown);

    /// A map of a moment: shown by QGIS's Temporal Controller from `begin` up to `end`, s since the start of the run.
    struct Frame {
        std::string name;
        std::string source;  ///< a raster within the folder, as GDAL names it from there: "./series/depth.tif"
        std::string style;
        double begin = 0, end = 0;
    };
    /// A group of its own under the vectors, switched off; the last frame is on top.
    void add_over_time(const std::string& group, const std::vector<Frame>& frames);

    /// Writes results.qlr.
    [[nodiscard]] Status write(const std::filesystem::path& folder) const;

  private:
    struct Parts {
        std::string tree, layers;
    };
    /// `more`: elements of the layer beside those of its style.
    void add(Parts& parts, const std::string& name, const std::string& source, const char* type, const char* provider,
             const std::string& style, bool shown, const std::string& more = "");

    std::string group_, wkt_;
    Parts vectors_, over_time_, rasters_;
    int count_ = 0;
};

}  // namespace talus::products
