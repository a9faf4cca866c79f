#include "run/depth_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "scene/grid_cell.hpp"

namespace talus::run {
namespace {

/// The roof of the part of a building at a place; empty: it does not stand there.
std::optional<double> roof_at(const terrain::Building& building, const PlanPoint& p) {
    for (std::size_t part = 0; part < building.footprint.size(); ++part) {
        if (!contains(building.footprint[part], p)) continue;
        const double roof =
            building.part_roof_elevations.empty() ? building.roof_elevation : building.part_roof_elevations[part];
        if (std::isfinite(roof)) return roof;
    }
    return {};
}

/// Raises cells to the roofs of a building.
class Raiser {
  public:
    Raiser(const terrain::Building& building, Grid<double>& bed, std::vector<std::size_t>& cells)
        : building_(building), bed_(bed), cells_(cells) {}

    /// The cells whose centres it covers.
    void raise_footprint() {
        const GridGeometry& g = bed_.geometry;
        const Extent e = extent_of(building_);
        for (int row = row_of(e.y_min); row <= row_of(e.y_max); ++row) {
            for (int column = column_of(e.x_min); column <= column_of(e.x_max); ++column) {
                raise(column, row, roof_at(building_, g.centre(column, row)));
            }
        }
    }
    /// The cells that a barrier's line crosses, so that no debris slips through between two corners.
    void raise_line(const std::vector<PlanPoint>& line) {
        for (std::size_t k = 0; k + 1 < line.size(); ++k) {
            const PlanPoint a = line[k], b = line[k + 1];
            const int parts = 1 + static_cast<int>(std::hypot(b.x - a.x, b.y - a.y) / (bed_.geometry.cell / 8));
            int before_column = column_of(a.x), before_row = row_of(a.y);
            for (int part = 0; part <= parts; ++part) {
                const double share = static_cast<double>(part) / parts;
                const PlanPoint p{a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
                const int column = column_of(p.x), row = row_of(p.y);
                const auto roof = roof_at(building_, p);
                raise(column, row, roof);
                if (column != before_column && row != before_row) raise(column, before_row, roof);
                before_column = column;
                before_row = row;
            }
        }
    }

  private:
    [[nodiscard]] int column_of(double x) const {
        const GridGeometry& g = bed_.geometry;
        return std::clamp(static_cast<int>(std::floor((x - g.x_min) / g.cell)), 0, g.columns - 1);
    }
    [[nodiscard]] int row_of(double y) const {
        const GridGeometry& g = bed_.geometry;
        return std::clamp(static_cast<int>(std::floor((y - g.y_min) / g.cell)), 0, g.rows - 1);
    }
    void raise(int column, int row, const std::optional<double>& roof) {
        if (!roof || std::isnan(bed_.at(column, row))) return;
        const std::size_t cell = bed_.geometry.index(column, row);
        bed_.values[cell] = std::max(bed_.values[cell], *roof);
        if (std::find(cells_.begin(), cells_.end(), cell) == cells_.end()) cells_.push_back(cell);
    }

    const terrain::Building& building_;
    Grid<double>& bed_;
    std::vector<std::size_t>& cells_;
};

}  // namespace

GridGround grid_ground(const scene::Scene& scene) {
    const Extent e = scene.terrain.elevation().geometry.extent();
    const double cell = scene::grid_cell(scene);
    GridGround ground;
    ground.bed = Grid<double>({e.x_min, e.y_min, cell, std::max(1, static_cast<int>(std::lround(e.width() / cell))),
                               std::max(1, static_cast<int>(std::lround(e.height() / cell)))},
                              std::numeric_limits<double>::quiet_NaN());
    const GridGeometry& g = ground.bed.geometry;
    if (!scene.cover.empty()) {
        for (std::vector<float>* values :
             {&ground.values.friction_coefficient, &ground.values.inverse_turbulent_friction, &ground.values.cohesion,
              &ground.values.stem_drag, &ground.values.laminar_viscosity}) {
            if (values == &ground.values.laminar_viscosity && !scene.cover.has_viscosities()) continue;
            values->assign(g.size(), std::numeric_limits<float>::quiet_NaN());
        }
    }
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            const PlanPoint p = g.centre(column, row);
            const LocalPoint at = scene.terrain.frame().to_local({p.x, p.y, 0});
            if (!scene.terrain.covers(at.x, at.y)) continue;
            const std::size_t k = g.index(column, row);
            ground.bed.values[k] =
                scene.terrain.frame().origin.z + static_cast<double>(scene.terrain.sample(at.x, at.y).height);
            if (scene.cover.empty()) continue;
            const auto cover = scene.cover.at(at.x, at.y);
            ground.values.friction_coefficient[k] = cover.x;
            ground.values.inverse_turbulent_friction[k] = cover.y;
            ground.values.cohesion[k] = cover.z;
            ground.values.stem_drag[k] = cover.w;
            if (scene.cover.has_viscosities())
                ground.values.laminar_viscosity[k] = scene.cover.viscosity_at(at.x, at.y);
        }
    }
    for (const terrain::Building& building : scene.buildings) {
        observe::StructureCells structure{building.name, building.barrier.has_value(), {}};
        if (stands(building)) {
            Raiser raiser(building, ground.bed, structure.cells);
            raiser.raise_footprint();
            if (building.barrier) raiser.raise_line(building.barrier->line);
        }
        ground.structures.push_back(std::move(structure));
    }
    if (!scene.buildings.empty()) ground.values.structure.assign(g.size(), 0);
    for (const observe::StructureCells& structure : ground.structures) {
        for (const std::size_t raised : structure.cells) ground.values.structure[raised] = 1;
    }
    return ground;
}

namespace {

/// The cell of the terrain at the centre of one of the grid, for each whose ground is known.
template <class F>
void for_each_terrain_cell(const scene::Scene& scene, const GridGeometry& grid, const F& f) {
    for (int row = 0; row < grid.rows; ++row) {
        for (int column = 0; column < grid.columns; ++column) {
            const PlanPoint p = grid.centre(column, row);
            const LocalPoint at = scene.terrain.frame().to_local({p.x, p.y, 0});
            if (scene.terrain.covers(at.x, at.y)) f(grid.index(column, row), scene.terrain.cell_at(at.x, at.y));
        }
    }
}

}  // namespace

terrain::Bed grid_bed(const scene::Scene& scene, const GridGround& ground) {
    terrain::Bed bed;
    if (scene.bed.empty()) return bed;
    const std::size_t cells = ground.bed.geometry.size();
    bed.materials = scene.bed.materials;
    bed.material_at.assign(cells, 0);
    bed.depth.assign(cells, 0);
    bed.eroded.assign(cells, 0);
    for_each_terrain_cell(scene, ground.bed.geometry, [&](std::size_t cell, std::size_t of_terrain) {
        if (!ground.values.structure.empty() && ground.values.structure[cell] > 0) return;
        bed.material_at[cell] = scene.bed.material_at[of_terrain];
        bed.depth[cell] = scene.bed.depth[of_terrain];
    });
    return bed;
}

terrain::Bed terrain_bed(const scene::Scene& scene, const GridGeometry& grid, const terrain::Bed& eroded) {
    terrain::Bed bed = scene.bed;
    if (bed.empty()) return bed;
    const double share = grid.cell * grid.cell / (scene.terrain.cell() * scene.terrain.cell());
    std::vector<double> sum(bed.eroded.size());
    for_each_terrain_cell(scene, grid, [&](std::size_t cell, std::size_t of_terrain) {
        sum[of_terrain] += share * double{eroded.eroded[cell]};
    });
    for (std::size_t k = 0; k < sum.size(); ++k) bed.eroded[k] = static_cast<float>(sum[k]);
    return bed;
}

Grid<float> grid_release(const scene::Scene& scene, const terrain::Release& release, const GridGround& ground) {
    const GridGeometry& g = ground.bed.geometry;
    std::vector<std::uint8_t> built(g.size(), 0);
    for (const observe::StructureCells& structure : ground.structures) {
        for (const std::size_t cell : structure.cells) built[cell] = 1;
    }
    Grid<float> depth(g);
    const Extent e = release.extent();
    double sum = 0;
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            const PlanPoint centre = g.centre(column, row);
            const std::size_t k = g.index(column, row);
            if (!e.grown(g.cell).contains(centre) || built[k] || std::isnan(ground.bed.values[k])) continue;
            constexpr int parts = 4;  // so that cells on the outline get their share
            double mean = 0;
            for (int east = 0; east < parts; ++east) {
                for (int north = 0; north < parts; ++north) {
                    mean += release.depth_at(scene.terrain, {centre.x + ((east + 0.5) / parts - 0.5) * g.cell,
                                                             centre.y + ((north + 0.5) / parts - 0.5) * g.cell});
                }
            }
            depth.values[k] = static_cast<float>(mean / (parts * parts));
            sum += depth.values[k];
        }
    }
    if (!(sum > 0)) return depth;
    const auto scale = static_cast<float>(release.volume / (sum * g.cell * g.cell));
    for (float& value : depth.values) value *= scale;
    return depth;
}

}  // namespace talus::run
