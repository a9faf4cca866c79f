#include "depth/internal_friction.hpp"

#include <algorithm>
#include <cmath>

#include "depth/formulas.hpp"

namespace talus::depth {
namespace {

/// Of a step. Each carries stress over a cell; with 24 the front of the built-in scene reaches House 38 0.6 % later.
constexpr int passes = 6;
/// Of what neighbours could exchange without overshooting. Debris that hardly shears is that stiff.
constexpr float stable_share = 0.15F;
/// Converging debris is squeezed at most so much more than debris under its own weight, 1 / this.
constexpr float least_relief = 0.2F;

struct Cell {
    int column = 0, row = 0;
    [[nodiscard]] Cell east(int cells = 1) const { return {column + cells, row}; }
    [[nodiscard]] Cell north(int cells = 1) const { return {column, row + cells}; }
};

/// On the debris before a face, from that behind it, per density and length of the face, m3/s2.
struct Traction {
    float x = 0, y = 0;
};

class Stress {
  public:
    /// `limit`: of its norm, over the pressure, or that of the grains where r_u differs; `stiffest`: stress over strain
    /// rate and depth, m2/s.
    Stress(const Solver& solver, float limit, float stiffest)
        : solver_(solver),
          gravity_(static_cast<float>(solver.material().gravity)),
          inverse_cell_(static_cast<float>(1 / solver.geometry().cell)),
          limit_(limit),
          stiffest_(stiffest) {}

    /// Across the face between a cell and its neighbour to the east, or to the north.
    [[nodiscard]] Traction across(const Cell& a, bool east) const {
        const Cell b = east ? a.east() : a.north();
        if (!touch(a, b)) return {};
        const bool normal = east, along = !east;  // whether it is u
        const float stretch = (velocity(b, normal) - velocity(a, normal)) * inverse_cell_;
        const float aside = (gradient(a, along, !east) + gradient(b, along, !east)) / 2;
        const float turn = (velocity(b, along) - velocity(a, along)) * inverse_cell_;
        const float shear = (turn + (gradient(a, normal, !east) + gradient(b, normal, !east)) / 2) / 2;
        const float rise = -(stretch + aside);  // volume stays
        const float rate = std::sqrt(stretch * stretch + aside * aside + rise * rise + 2 * shear * shear);
        if (!(rate > 0)) return {};
        const float limit = solver_.carries_pore_pressure() ? limit_ * (1 - (ratio(a) + ratio(b)) / 2) : limit_;
        const float pressure = std::min(weight(a), weight(b)) / std::max(least_relief, 1 - limit * rise / rate);
        const float over_rate = std::min(limit * pressure / rate, stiffest_ * std::min(depth(a), depth(b)));
        const float pull = over_rate * (stretch - rise), drag = over_rate * shear;
        return east ? Traction{pull, drag} : Traction{drag, pull};
    }

  private:
    [[nodiscard]] float depth(const Cell& at) const { return solver_.depth_at(at.column, at.row); }
    [[nodiscard]] float ratio(const Cell& at) const { return solver_.pore_pressure_ratio_at(at.column, at.row); }
    [[nodiscard]] float velocity(const Cell& at, bool u) const {
        return u ? solver_.u_at(at.column, at.row) : solver_.v_at(at.column, at.row);
    }
    [[nodiscard]] bool touch(const Cell& a, const Cell& b) const {
        return depth(a) > dry_depth && depth(b) > dry_depth &&
               solver_.built(a.column, a.row) == solver_.built(b.column, b.row);
    }
    /// Of u or v eastward or northward, from the neighbours that touch.
    [[nodiscard]] float gradient(const Cell& at, bool u, bool eastward) const {
        const Cell before = eastward ? at.east(-1) : at.north(-1), after = eastward ? at.east() : at.north();
        float change = 0, cells = 0;
        if (touch(at, before)) {
            change += velocity(at, u) - velocity(before, u);
            ++cells;
        }
        if (touch(at, after)) {
            change += velocity(after, u) - velocity(at, u);
            ++cells;
        }
        return cells > 0 ? change * inverse_cell_ / cells : 0;
    }
    /// Pressure of debris under its own weight, summed over the depth, per density, m3/s2.
    [[nodiscard]] float weight(const Cell& at) const {
        const float h = depth(at);
        const float x = solver_.slope_x_at(at.column, at.row), y = solver_.slope_y_at(at.column, at.row);
        return gravity_ * h * h / (2 * (1 + x * x + y * y));
    }

    const Solver& solver_;
    float gravity_, inverse_cell_, limit_, stiffest_;
};

}  // namespace

InternalFriction::InternalFriction(const Solver& solver, double coefficient) : coefficient_(coefficient) {
    if (!(coefficient > 0)) return;
    u_.resize(solver.geometry().size());
    v_.resize(u_.size());
}

void InternalFriction::resist(Solver& solver) {
    if (!(coefficient_ > 0)) return;
    const GridGeometry& grid = solver.geometry();
    const double step = solver.time_step() / passes;
    const float over_mass = static_cast<float>(step / grid.cell);
    const double everywhere = solver.carries_pore_pressure() ? 0 : solver.material().pore_pressure_ratio;
    const Stress stress(solver, static_cast<float>(std::sqrt(2.0) * coefficient_ * (1 - everywhere)),
                        static_cast<float>(stable_share * grid.cell * grid.cell / step));
    for (int pass = 0; pass < passes; ++pass) {
        solver.for_each_active_row([&](const CellRow& row) {
            Traction west = stress.across({row.first - 1, row.row}, true);
            for (int k = 0; k < row.last - row.first; ++k) {
                const Cell at{row.first + k, row.row};
                const Traction before = west, east = stress.across(at, true);
                west = east;
                if (!(row.depth[k] > dry_depth)) continue;
                const Traction north = stress.across(at, false), south = stress.across(at.north(-1), false);
                const std::size_t i = grid.index(at.column, at.row);
                u_[i] = row.u[k] + over_mass * (east.x - before.x + north.x - south.x) / row.depth[k];
                v_[i] = row.v[k] + over_mass * (east.y - before.y + north.y - south.y) / row.depth[k];
            }
        });
        solver.for_each_active_row_in_turn([&](const CellRow& row) {
            for (int k = 0; k < row.last - row.first; ++k) {
                if (!(row.depth[k] > dry_depth)) continue;
                const std::size_t i = grid.index(row.first + k, row.row);
                if (u_[i] == row.u[k] && v_[i] == row.v[k]) continue;
                solver.set_velocity(row.first + k, row.row, static_cast<double>(u_[i]), static_cast<double>(v_[i]));
            }
        });
    }
}

}  // namespace talus::depth
