#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "geo/vector.hpp"
#include "scene/attributes.hpp"
#include "scene/load.hpp"

namespace talus {
namespace {

constexpr double deepest = 100;  // m, as bed.depth_m allows

BedMaterial material_of(const BedSpec& spec) {
    return {spec.name,
            spec.law,
            spec.growth_rate.value_or(0),
            spec.critical_shear_stress,
            spec.erosion_rate,
            spec.erosion_depth_per_shear};
}

/// Lays material on the cells of the terrain.
class BedLayer {
  public:
    BedLayer(Scene& scene, std::uint8_t material) : scene_(scene), material_(material) {}

    /// `depth_at`: m at a world plan position; nothing is laid where it is not above 0.
    template <class DepthAt>
    void lay(const Extent& extent, const DepthAt& depth_at) {
        const Grid<float>& elevation = scene_.terrain.elevation();
        const GridGeometry& g = elevation.geometry;
        const auto nearest = [&](double along, int cells) {
            return static_cast<int>(std::clamp(std::floor(along / g.cell), 0.0, cells - 1.0));
        };
        const int first_column = nearest(extent.x_min - g.x_min, g.columns);
        const int last_column = nearest(extent.x_max - g.x_min, g.columns);
        const int last_row = nearest(extent.y_max - g.y_min, g.rows);
        for (int row = nearest(extent.y_min - g.y_min, g.rows); row <= last_row; ++row) {
            for (int column = first_column; column <= last_column; ++column) {
                const std::size_t cell = g.index(column, row);
                const double depth = std::isnan(elevation.values[cell]) ? 0 : depth_at(g.centre(column, row));
                if (!(depth > 0)) continue;
                deepest_ = std::max(deepest_, depth);
                scene_.bed.material_at[cell] = material_;
                scene_.bed.depth[cell] = static_cast<float>(depth);
                volume_ += depth * g.cell * g.cell;
            }
        }
    }

    [[nodiscard]] double volume() const { return volume_; }    ///< m3
    [[nodiscard]] double deepest() const { return deepest_; }  ///< m

  private:
    Scene& scene_;
    std::uint8_t material_;
    double volume_ = 0, deepest_ = 0;
};

Status load_one(const ParsedScene& parsed, std::size_t index, Scene& scene) {
    BedSpec& spec = scene.spec.beds[index];
    if (spec.name.empty()) spec.name = fmt::format("bed {}", index + 1);
    const std::string label = fmt::format("bed \"{}\"", spec.name);
    const auto refused = [&](const char* key, const Error& error) {
        return Error{parsed.at(fmt::format("bed[{}].{}", index, key)) + ": " + error.message};
    };
    scene.bed.materials.push_back(material_of(spec));
    BedLayer bed(scene, static_cast<std::uint8_t>(index + 1));

    std::optional<Raster> raster;
    if (!spec.depth_raster.empty()) {
        Result<Raster> read = read_value_raster(spec.depth_raster, scene.crs);
        if (!read) return refused("depth_raster", read.error());
        record_input(label + " depth", spec.depth_raster, scene);
        raster = *std::move(read);
    }
    const auto lay = [&](const Extent& extent, double depth, const Polygon* polygon) {
        bed.lay(extent, [&](const PlanPoint& p) -> double {
            if (polygon != nullptr && !contains(*polygon, p)) return 0;
            return raster ? value_at(raster->grid, p) : depth;
        });
    };
    if (spec.file.empty()) {
        lay(raster ? raster->grid.geometry.extent() : scene.terrain.elevation().geometry.extent(),
            spec.depth.value_or(0), nullptr);
    } else {
        const Result<PolygonLayer> layer = read_polygons(spec.file, spec.layer, scene.crs);
        if (!layer) return refused("file", layer.error());
        record_input(label, spec.file, scene);
        if (!layer->reprojection.empty()) scene.notes.push_back(label + ": " + layer->reprojection);
        for (std::size_t feature = 0; feature < layer->features.size(); ++feature) {
            double depth = spec.depth.value_or(0);
            if (!spec.depth_attribute.empty()) {
                const Result<double> read =
                    read_length(spec.file, *layer, feature, {spec.depth_attribute, "depth", deepest});
                if (!read) return refused("depth_attribute", read.error());
                depth = *read;
            }
            for (const Polygon& part : layer->features[feature].parts) lay(extent_of(part), depth, &part);
        }
    }
    if (bed.deepest() > deepest) {
        return refused("depth_raster", Error{fmt::format("{}: holds a depth of {:.6g}; it must be at most {:.0f} (m)",
                                                         spec.depth_raster, bed.deepest(), deepest)});
    }
    if (!(bed.volume() > 0)) {
        return refused(raster ? "depth_raster" : "file",
                       Error{fmt::format("{} covers the centre of no cell of the terrain, {}", label,
                                         extent_text(covered_extent(scene.terrain)))});
    }
    scene.notes.push_back(
        fmt::format("{}: {:.6g} m3 on the ground, in cells of {:.4g} m", label, bed.volume(), scene.terrain.cell()));
    return {};
}

}  // namespace

Status load_bed(const ParsedScene& parsed, Scene& scene) {
    if (scene.spec.beds.empty()) return {};
    if (scene.spec.beds.size() > Bed::most_materials) {
        return Error{fmt::format("{}: {} beds are too many; there can be {}", parsed.at("bed[0].name"),
                                 scene.spec.beds.size(), Bed::most_materials)};
    }
    const std::size_t cells = scene.terrain.elevation().values.size();
    scene.bed.material_at.assign(cells, 0);
    scene.bed.depth.assign(cells, 0);
    scene.bed.eroded.assign(cells, 0);
    for (std::size_t i = 0; i < scene.spec.beds.size(); ++i) {
        if (Status s = load_one(parsed, i, scene); !s) return s.error();
    }
    return {};
}

}  // namespace talus
