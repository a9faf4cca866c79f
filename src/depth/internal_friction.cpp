#include "depth/internal_friction.hpp"

#include <algorithm>
#include <cmath>

#include "depth/formulas.hpp"
#include "simd/parallel.hpp"

namespace talus::depth {
namespace {

/// Of a step. Each carries stress over a cell; with 24 the front of the built-in scene reaches House 38 0.6 % later.
constexpr int passes = 6;
/// Of what neighbours could exchange without overshooting. Debris that hardly shears is that stiff.
constexpr float stable_share = 0.15F;
/// Converging debris is squeezed at most so much more than debris under its own weight, 1 / this.
constexpr float least_relief = 0.2F;

/// The debris and its neighbours. A cell touches another where both hold debris and both, or neither, are built.
class Stress {
  public:
    /// `limit`: of its norm, over the pressure, or that of the grains where r_u differs; `stiffest`: stress over strain
    /// rate and depth, m2/s.
    Stress(const Solver& solver, InternalFriction::Fields& fields, float limit, float stiffest)
        : solver_(solver),
          fields_(fields),
          grid_(solver.geometry()),
          gravity_(static_cast<float>(solver.material().gravity)),
          inverse_cell_(static_cast<float>(1 / solver.geometry().cell)),
          limit_(limit),
          stiffest_(stiffest) {}

    /// Pressure of debris under its own weight, summed over the depth, per density, m3/s2.
    void find_weight(int column, int row) {
        const float h = depth(column, row);
        const float x = solver_.slope_x_at(column, row), y = solver_.slope_y_at(column, row);
        fields_.weight[grid_.index(column, row)] = gravity_ * h * h / (2 * (1 + x * x + y * y));
    }
    void find_gradients(int column, int row) {
        const Difference east = difference(column, row, 1, 0), west = difference(column - 1, row, 1, 0);
        const Difference north = difference(column, row, 0, 1), south = difference(column, row - 1, 0, 1);
        const std::size_t i = grid_.index(column, row);
        fields_.u_east[i] = mean(west.u, east.u, west.cells + east.cells);
        fields_.v_east[i] = mean(west.v, east.v, west.cells + east.cells);
        fields_.u_north[i] = mean(south.u, north.u, south.cells + north.cells);
        fields_.v_north[i] = mean(south.v, north.v, south.cells + north.cells);
    }
    /// Across the faces to the east and to the north of a cell.
    void find_tractions(int column, int row) {
        const std::size_t i = grid_.index(column, row);
        const std::vector<float>&u_east = fields_.u_east, &v_east = fields_.v_east;
        const std::vector<float>&u_north = fields_.u_north, &v_north = fields_.v_north;
        fields_.pull_east[i] = fields_.drag_east[i] = fields_.pull_north[i] = fields_.drag_north[i] = 0;
        if (touch(column, row, 1, 0)) {
            const std::size_t j = i + 1;
            const float stretch = (solver_.u_at(column + 1, row) - solver_.u_at(column, row)) * inverse_cell_;
            const float turn = (solver_.v_at(column + 1, row) - solver_.v_at(column, row)) * inverse_cell_;
            const Traction t = across(column, row, 1, 0, stretch, (v_north[i] + v_north[j]) / 2,
                                      (turn + (u_north[i] + u_north[j]) / 2) / 2);
            fields_.pull_east[i] = t.pull;
            fields_.drag_east[i] = t.drag;
        }
        if (touch(column, row, 0, 1)) {
            const std::size_t j = i + static_cast<std::size_t>(grid_.columns);
            const float stretch = (solver_.v_at(column, row + 1) - solver_.v_at(column, row)) * inverse_cell_;
            const float turn = (solver_.u_at(column, row + 1) - solver_.u_at(column, row)) * inverse_cell_;
            const Traction t = across(column, row, 0, 1, stretch, (u_east[i] + u_east[j]) / 2,
                                      (turn + (v_east[i] + v_east[j]) / 2) / 2);
            fields_.pull_north[i] = t.pull;
            fields_.drag_north[i] = t.drag;
        }
    }

  private:
    /// On the debris before a face, from that behind it, per density and length of the face, m3/s2: along the normal of
    /// the face and along the face.
    struct Traction {
        float pull = 0, drag = 0;
    };
    /// Of velocities, to the next cell; 0 where that does not touch.
    struct Difference {
        float u = 0, v = 0, cells = 0;
    };

    [[nodiscard]] float depth(int column, int row) const { return solver_.depth_at(column, row); }
    [[nodiscard]] bool touch(int column, int row, int east, int north) const {
        return depth(column, row) > dry_depth && depth(column + east, row + north) > dry_depth &&
               solver_.built(column, row) == solver_.built(column + east, row + north);
    }
    [[nodiscard]] Difference difference(int column, int row, int east, int north) const {
        if (!touch(column, row, east, north)) return {};
        return {solver_.u_at(column + east, row + north) - solver_.u_at(column, row),
                solver_.v_at(column + east, row + north) - solver_.v_at(column, row), 1};
    }
    [[nodiscard]] float mean(float before, float after, float cells) const {
        return cells > 0 ? (before + after) * inverse_cell_ / cells : 0;
    }
    [[nodiscard]] Traction across(int column, int row, int east, int north, float stretch, float aside,
                                  float shear) const {
        const float rise = -(stretch + aside);  // volume stays
        const float rate = std::sqrt(stretch * stretch + aside * aside + rise * rise + 2 * shear * shear);
        if (!(rate > 0)) return {};
        const float here = solver_.carries_pore_pressure() ? solver_.pore_pressure_ratio_at(column, row) : 0;
        const float there =
            solver_.carries_pore_pressure() ? solver_.pore_pressure_ratio_at(column + east, row + north) : 0;
        const float limit = limit_ * (1 - (here + there) / 2);
        const float weight =
            std::min(fields_.weight[grid_.index(column, row)], fields_.weight[grid_.index(column + east, row + north)]);
        const float pressure = weight / std::max(least_relief, 1 - limit * rise / rate);
        const float thinner = std::min(depth(column, row), depth(column + east, row + north));
        const float over_rate = std::min(limit * pressure / rate, stiffest_ * thinner);
        return {over_rate * (stretch - rise), over_rate * shear};
    }

    const Solver& solver_;
    InternalFriction::Fields& fields_;
    const GridGeometry& grid_;
    float gravity_, inverse_cell_, limit_, stiffest_;
};

/// Calls f(column, row) in parallel for all cells with debris.
template <class F>
void for_each_wet(const Solver& solver, const F& f) {
    simd::parallel_ranges(static_cast<std::size_t>(solver.geometry().rows), 8,
                          [&](std::size_t first, std::size_t last) {
                              for (auto r = static_cast<int>(first); r < static_cast<int>(last); ++r) {
                                  for_each_deeper(solver.row(r), dry_depth, [&](int column) { f(column, r); });
                              }
                          });
}

}  // namespace

InternalFriction::InternalFriction(const Solver& solver, double coefficient) : coefficient_(coefficient) {
    if (!(coefficient > 0)) return;
    for (std::vector<float>* field : fields_.all()) field->resize(solver.geometry().size());
}

void InternalFriction::resist(Solver& solver) {
    if (!(coefficient_ > 0)) return;
    const GridGeometry& grid = solver.geometry();
    const double step = solver.time_step() / passes;
    const float over_mass = static_cast<float>(step / grid.cell);
    const double everywhere = solver.carries_pore_pressure() ? 0 : solver.material().pore_pressure_ratio;
    Stress stress(solver, fields_, static_cast<float>(std::sqrt(2.0) * coefficient_ * (1 - everywhere)),
                  static_cast<float>(stable_share * grid.cell * grid.cell / step));
    for_each_wet(solver, [&](int column, int row) { stress.find_weight(column, row); });
    for (int pass = 0; pass < passes; ++pass) {
        for_each_wet(solver, [&](int column, int row) { stress.find_gradients(column, row); });
        for_each_wet(solver, [&](int column, int row) { stress.find_tractions(column, row); });
        solver.for_each_active_row([&](const CellRow& row) {
            const auto up = static_cast<std::size_t>(grid.columns);
            for_each_deeper(row, dry_depth, [&](int k) {
                const int column = row.first + k;
                const std::size_t i = grid.index(column, row.row);
                const bool west = solver.depth_at(column - 1, row.row) > dry_depth;
                const bool south = solver.depth_at(column, row.row - 1) > dry_depth;
                const Fields& f = fields_;
                const float x = f.pull_east[i] - (west ? f.pull_east[i - 1] : 0) + f.drag_north[i] -
                                (south ? f.drag_north[i - up] : 0);
                const float y = f.drag_east[i] - (west ? f.drag_east[i - 1] : 0) + f.pull_north[i] -
                                (south ? f.pull_north[i - up] : 0);
                fields_.u[i] = row.u[k] + over_mass * x / row.depth[k];
                fields_.v[i] = row.v[k] + over_mass * y / row.depth[k];
            });
        });
        solver.for_each_active_row_in_turn([&](const CellRow& row) {
            for_each_deeper(row, dry_depth, [&](int k) {
                const std::size_t i = grid.index(row.first + k, row.row);
                if (fields_.u[i] == row.u[k] && fields_.v[i] == row.v[k]) return;
                solver.set_velocity(row.first + k, row.row, fields_.u[i], fields_.v[i]);
            });
        });
    }
}

}  // namespace talus::depth
