#include "depth/internal_friction.hpp"

#include <cmath>

#include "depth/formulas.hpp"
#include "simd/lanes.hpp"
#include "simd/parallel.hpp"

namespace talus::depth {
namespace {

/// Of a step. Each carries stress over a cell; with 24 the front of the built-in scene reaches House 38 0.6 % later.
constexpr int passes = 6;
/// Of what neighbours could exchange without overshooting. Debris that hardly shears is that stiff.
constexpr float stable_share = 0.15F;
/// Converging debris is squeezed at most so much more than debris under its own weight, 1 / this.
constexpr float least_relief = 0.2F;

using L = simd::Lanes<4>;  // which every instruction set has

L smaller(const L& a, const L& b) {
    return select(b < a, b, a);
}
L larger(const L& a, const L& b) {
    return select(a < b, b, a);
}

void find_wet(const Solver& solver, std::vector<InternalFriction::Group>& wet) {
    const GridGeometry& grid = solver.geometry();
    wet.clear();
    for (int row = 0; row < grid.rows; ++row) {
        const float* depth = solver.row(row).depth;
        for (int column = 0; column < grid.columns; column += L::size) {
            if (any(L::load(depth + column) > L(dry_depth))) wet.push_back({column, row});
        }
    }
}

/// Calls f(column, row) in parallel for groups of cells.
template <class F>
void for_each(const std::vector<InternalFriction::Group>& groups, const F& f) {
    simd::parallel_ranges(groups.size(), 256, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) f(groups[k].column, groups[k].row);
    });
}

/// The debris and its neighbours. A cell touches another where both hold debris, and a structure stands in both or in
/// neither.
class Stress {
  public:
    /// `limit`: of its norm, over the pressure, or that of the grains where r_u differs; `stiffest`: stress over strain
    /// rate and depth, m2/s; `over_mass`: time step over the length of a cell, s/m.
    Stress(const Solver& solver, InternalFriction::Fields& fields, float limit, float stiffest, float over_mass)
        : solver_(solver),
          f_(fields),
          gravity_(static_cast<float>(solver.material().gravity)),
          inverse_cell_(static_cast<float>(1 / solver.geometry().cell)),
          limit_(limit),
          stiffest_(stiffest),
          over_mass_(over_mass) {}

    /// What stays during the passes: neighbours that touch, and pressures of debris under its own weight.
    void prepare(int column, int row) {
        const std::size_t i = f_.index(column, row);
        const CellRow here = solver_.row(row);
        const float* depth = here.depth + column;
        const L h = L::load(depth), built = L::load(&f_.built[i]);
        const auto touch = [&](const float* beside, std::size_t j) {
            const auto both = (h > L(dry_depth)) & (L::load(beside) > L(dry_depth));
            return select(both & (built == L::load(&f_.built[j])), L(1), L(0));
        };
        touch(depth + 1, i + 1).store(&f_.touch_east[i]);
        touch(depth - 1, i - 1).store(&f_.touch_west[i]);
        touch(solver_.row(row + 1).depth + column, i + f_.stride).store(&f_.touch_north[i]);
        touch(solver_.row(row - 1).depth + column, i - f_.stride).store(&f_.touch_south[i]);
        const L x = L::load(here.slope_x + column), y = L::load(here.slope_y + column);
        (L(gravity_) * h * h / (L(2) * (L(1) + x * x + y * y))).store(&f_.weight[i]);
        if (!solver_.carries_pore_pressure()) return;
        for (int k = 0; k < L::size && column + k < solver_.geometry().columns; ++k) {
            f_.ratio[i + static_cast<std::size_t>(k)] = solver_.pore_pressure_ratio_at(column + k, row);
        }
    }
    void find_gradients(int column, int row) {
        const std::size_t i = f_.index(column, row);
        const CellRow here = solver_.row(row), north = solver_.row(row + 1), south = solver_.row(row - 1);
        const L east = L::load(&f_.touch_east[i]), west = L::load(&f_.touch_west[i]);
        const L above = L::load(&f_.touch_north[i]), below = L::load(&f_.touch_south[i]);
        const auto gradient = [&](const L& at, const float* before, const L& touches_before, const float* after,
                                  const L& touches_after) {
            const L change = select(touches_before > L(0), at - L::load(before), L(0)) +
                             select(touches_after > L(0), L::load(after) - at, L(0));
            const L cells = touches_before + touches_after;
            return select(cells > L(0), change * L(inverse_cell_) / cells, L(0));
        };
        const auto find = [&](const float* at, const float* at_north, const float* at_south, float* eastward,
                              float* northward) {
            const L value = L::load(at);
            gradient(value, at - 1, west, at + 1, east).store(eastward);
            gradient(value, at_south, below, at_north, above).store(northward);
        };
        find(here.u + column, north.u + column, south.u + column, &f_.u_east[i], &f_.u_north[i]);
        find(here.v + column, north.v + column, south.v + column, &f_.v_east[i], &f_.v_north[i]);
    }
    /// Across the faces to the east and to the north of a cell.
    void find_tractions(int column, int row) {
        const std::size_t i = f_.index(column, row), j = i + f_.stride;
        const CellRow here = solver_.row(row), north = solver_.row(row + 1);
        const float *u = here.u + column, *v = here.v + column;
        const float *u_above = north.u + column, *v_above = north.v + column;
        const L depth = L::load(here.depth + column);
        across(i, i + 1, L::load(&f_.touch_east[i]), {depth, L::load(here.depth + column + 1)}, slope(u, u + 1),
               slope(v, v + 1), f_.v_north, f_.u_north, &f_.pull_east[i], &f_.drag_east[i]);
        across(i, j, L::load(&f_.touch_north[i]), {depth, L::load(north.depth + column)}, slope(v, v_above),
               slope(u, u_above), f_.u_east, f_.v_east, &f_.pull_north[i], &f_.drag_north[i]);
    }
    void find_velocities(int column, int row) {
        const std::size_t i = f_.index(column, row);
        const CellRow here = solver_.row(row);
        const auto west = L::load(&f_.touch_west[i]) > L(0), south = L::load(&f_.touch_south[i]) > L(0);
        const auto sum = [&](const std::vector<float>& east, const std::vector<float>& north) {
            return L::load(&east[i]) - select(west, L::load(&east[i - 1]), L(0)) + L::load(&north[i]) -
                   select(south, L::load(&north[i - f_.stride]), L(0));
        };
        const L depth = L::load(here.depth + column);
        const L x = sum(f_.pull_east, f_.drag_north), y = sum(f_.drag_east, f_.pull_north);
        (L::load(here.u + column) + L(over_mass_) * x / depth).store(&f_.u[i]);
        (L::load(here.v + column) + L(over_mass_) * y / depth).store(&f_.v[i]);
    }

  private:
    [[nodiscard]] L slope(const float* from, const float* to) const {
        return (L::load(to) - L::load(from)) * L(inverse_cell_);
    }
    /// On the debris before faces between cells i and j, from that behind them, per density and length of a face,
    /// m3/s2: along its normal and along it. `stretch`, `turn`: of the velocity along the normal and of that along the
    /// face, in the direction of the normal; `aside`, `skew`: gradients of both along the face.
    void across(std::size_t i, std::size_t j, const L& touches, const std::array<L, 2>& depths, const L& stretch,
                const L& turn, const std::vector<float>& along, const std::vector<float>& skew, float* pull,
                float* drag) const {
        const L aside = (L::load(&along[i]) + L::load(&along[j])) * L(0.5);
        const L shear = (turn + (L::load(&skew[i]) + L::load(&skew[j])) * L(0.5)) * L(0.5);
        const L rise = -(stretch + aside);  // volume stays
        const L rate = sqrt(stretch * stretch + aside * aside + rise * rise + L(2) * shear * shear);
        const L limit = L(limit_) * (L(1) - (L::load(&f_.ratio[i]) + L::load(&f_.ratio[j])) * L(0.5));
        const L weight = smaller(L::load(&f_.weight[i]), L::load(&f_.weight[j]));
        const L pressure = weight / larger(L(least_relief), L(1) - limit * rise / rate);
        const L over_rate = smaller(limit * pressure / rate, L(stiffest_) * smaller(depths[0], depths[1]));
        const auto acts = (touches > L(0)) & (rate > L(0));
        select(acts, over_rate * (stretch - rise), L(0)).store(pull);
        select(acts, over_rate * shear, L(0)).store(drag);
    }

    const Solver& solver_;
    InternalFriction::Fields& f_;
    float gravity_, inverse_cell_, limit_, stiffest_, over_mass_;
};

}  // namespace

InternalFriction::InternalFriction(const Solver& solver, double coefficient) : coefficient_(coefficient) {
    if (!(coefficient > 0)) return;
    const GridGeometry& grid = solver.geometry();
    fields_.stride = static_cast<std::size_t>(grid.columns) + 2 * L::size;
    for (std::vector<float>* field : fields_.all()) {
        field->resize((static_cast<std::size_t>(grid.rows) + 2) * fields_.stride);
    }
    wet_.reserve(solver.geometry().size() / L::size + static_cast<std::size_t>(grid.rows));
    for (int row = 0; row < grid.rows; ++row) {
        for (int column = 0; column < grid.columns; ++column) {
            fields_.built[fields_.index(column, row)] = solver.built(column, row) ? 1 : 0;
        }
    }
}

void InternalFriction::resist(Solver& solver) {
    if (!(coefficient_ > 0)) return;
    const GridGeometry& grid = solver.geometry();
    const double step = solver.time_step() / passes;
    const double everywhere = solver.carries_pore_pressure() ? 0 : solver.material().pore_pressure_ratio;
    Stress stress(solver, fields_, static_cast<float>(std::sqrt(2.0) * coefficient_ * (1 - everywhere)),
                  static_cast<float>(stable_share * grid.cell * grid.cell / step),
                  static_cast<float>(step / grid.cell));
    find_wet(solver, wet_);  // depths stay during the passes
    for_each(wet_, [&](int column, int row) { stress.prepare(column, row); });
    for (int pass = 0; pass < passes; ++pass) {
        for_each(wet_, [&](int column, int row) { stress.find_gradients(column, row); });
        for_each(wet_, [&](int column, int row) { stress.find_tractions(column, row); });
        for_each(wet_, [&](int column, int row) { stress.find_velocities(column, row); });
        solver.for_each_active_row_in_turn([&](const CellRow& row) {
            for_each_deeper(row, dry_depth, [&](int k) {
                const std::size_t i = fields_.index(row.first + k, row.row);
                if (fields_.u[i] == row.u[k] && fields_.v[i] == row.v[k]) return;
                solver.set_velocity(row.first + k, row.row, fields_.u[i], fields_.v[i]);
            });
        });
    }
}

}  // namespace talus::depth
