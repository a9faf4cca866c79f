#include "depth/internal_friction.hpp"

#include <cmath>

#include "simd/parallel.hpp"

namespace talus::depth {
namespace {

/// Of a step. Each carries stress over a cell; with 24 the front of the built-in scene reaches House 38 0.6 % later.
constexpr int passes = 6;
/// Of what neighbours could exchange without overshooting. Debris that hardly shears is that stiff.
constexpr float stable_share = 0.15F;
/// So much less than the fastest wave or the highest energy line so far is certainly not more, rounded to floats or
/// not.
constexpr double certainly_less = 1 - 1e-5;

}  // namespace

InternalFriction::InternalFriction(Solver& solver, double coefficient)
    : coefficient_(coefficient), stages_(friction_stages()) {
    if (!(coefficient > 0)) return;
    const Solver::Cells cells = solver.cells();
    FrictionData& d = data_;
    std::vector<float> built(cells.size, 0.0F);
    const GridGeometry& grid = solver.geometry();
    for (int row = 0; row < grid.rows; ++row) {
        const std::size_t west = cells.before + static_cast<std::size_t>(solver.row(row).depth - cells.depth);
        for (int column = 0; column < grid.columns; ++column) {
            built[west + static_cast<std::size_t>(column)] = solver.built(column, row) ? 1 : 0;
        }
    }
    fields_.push_back(std::move(built));
    d.built = &fields_.back()[cells.before];
    for (float** const field : {&d.weight, &d.ratio, &d.touch_east, &d.touch_west, &d.touch_north, &d.touch_south,
                                &d.half_x, &d.half_y, &d.u_east, &d.v_east, &d.u_north, &d.v_north, &d.pull_east,
                                &d.drag_east, &d.pull_north, &d.drag_north, &d.faster}) {
        *field = &fields_.emplace_back(cells.size, 0.0F)[cells.before];
    }
    strips_.reserve(cells.size / tile_edge);
    changes_.reserve(cells.size / tile_edge);
}

void InternalFriction::resist(Solver& solver) {
    if (!(coefficient_ > 0)) return;
    const GridGeometry& grid = solver.geometry();
    const double step = solver.time_step() / passes;
    const double everywhere = solver.carries_pore_pressure() ? 0 : solver.material().pore_pressure_ratio;
    data_.cells = solver.cells();
    data_.gravity = static_cast<float>(solver.material().gravity);
    data_.inverse_cell = static_cast<float>(1 / grid.cell);
    data_.limit = static_cast<float>(std::sqrt(2.0) * coefficient_ * (1 - everywhere));
    data_.stiffest = static_cast<float>(stable_share * grid.cell * grid.cell / step);
    data_.over_mass = static_cast<float>(step / grid.cell);
    solver.find_strips(near_, strips_);  // depths stay during the passes
    changes_.resize(strips_.size());
    const auto for_strips = [&](const auto& f) {
        simd::parallel_ranges(strips_.size(), 64, [&](std::size_t first, std::size_t last) {
            f(strips_.data() + first, strips_.data() + last, changes_.data() + first);
        });
    };
    using Place = const Solver::Strip*;
    for_strips([&](Place first, Place last, std::uint8_t*) { stages_.prepare(data_, first, last); });
    for (int pass = 0; pass < passes; ++pass) {
        data_.signal = static_cast<float>(certainly_less * solver.signal());
        data_.line = static_cast<float>(certainly_less * solver.highest_line());
        for_strips([&](Place first, Place last, std::uint8_t*) { stages_.find_gradients(data_, first, last); });
        for_strips([&](Place first, Place last, std::uint8_t*) { stages_.find_tractions(data_, first, last); });
        for_strips([&](Place first, Place last, std::uint8_t* changes) {
            stages_.take_velocities(data_, first, last, changes);
        });
        for (std::size_t k = 0; k < strips_.size(); ++k) {
            if (changes_[k] == strip_unchanged) continue;
            const bool faster = (changes_[k] & strip_perhaps_faster) != 0;
            solver.expect_waves(strips_[k], faster ? data_.faster + strips_[k].at : nullptr);
        }
    }
}

}  // namespace talus::depth
