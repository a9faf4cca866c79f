#include "validate/set_up.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "sim/change.hpp"
#include "sim/physics/viscosity.hpp"
#include "sim/sources/seed.hpp"

namespace talus::validate {

terrain::Terrain make_terrain(double length, double width, double cell,
                              const std::function<double(double, double)>& elevation) {
    // One more cell on each side: ground is known between cell centres only.
    const int columns = static_cast<int>(std::ceil(length / cell)) + 2;
    const int rows = static_cast<int>(std::ceil(width / cell)) + 2;
    Grid<float> grid(GridGeometry{-columns * cell / 2, -rows * cell / 2, cell, columns, rows});
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const PlanPoint p = grid.geometry.centre(column, row);
            grid.at(column, row) = static_cast<float>(elevation(p.x, p.y));
        }
    }
    return terrain::Terrain(std::move(grid));
}

Incline::Incline(double slope, double length, double width)
    : terrain_(make_terrain(length, width, 1, [&](double x, double) { return -std::tan(slope) * x; })),
      sine_(std::sin(slope)),
      cosine_(std::cos(slope)),
      origin_{0, 0, terrain_.sample(0.0F, 0.0F).height} {}

LocalPoint Incline::point(double along, double across, double normal) const {
    return origin_ + LocalPoint{static_cast<float>(along * cosine_ + normal * sine_), static_cast<float>(across),
                                static_cast<float>(-along * sine_ + normal * cosine_)};
}

LocalPoint Incline::down(double speed) const {
    return {static_cast<float>(speed * cosine_), 0, static_cast<float>(-speed * sine_)};
}

double Incline::along(const LocalPoint& p) const {
    return p.x * cosine_ - (p.z - origin_.z) * sine_;
}

double Incline::normal(const LocalPoint& p) const {
    return p.x * sine_ + (p.z - origin_.z) * cosine_;
}

terrain::Building make_wall(const terrain::Terrain& terrain, double x_min, double y_min, double x_max, double y_max,
                            double height) {
    terrain::Building wall;
    wall.footprint = {{{{x_min, y_min}, {x_max, y_min}, {x_max, y_max}, {x_min, y_max}}, {}}};
    const auto& elevations = terrain.elevation().values;
    wall.roof_elevation = *std::max_element(elevations.begin(), elevations.end()) + height;
    return wall;
}

std::vector<terrain::Building> make_slice(const terrain::Terrain& terrain, double width, double height) {
    const Extent extent = terrain.elevation().geometry.extent();
    return {make_wall(terrain, extent.x_min, width / 2, extent.x_max, extent.y_max, height),
            make_wall(terrain, extent.x_min, extent.y_min, extent.x_max, -width / 2, height)};
}

std::vector<GateLeaf> opening_gate(double width, double opening, int pairs) {
    std::vector<GateLeaf> leaves;
    const double leaf = width / (2 * pairs);
    for (int k = 0; k < pairs; ++k) {
        const double gone = opening * (k + 0.5) / pairs;
        leaves.push_back({-(k + 1) * leaf, -k * leaf, gone});
        leaves.push_back({k * leaf, (k + 1) * leaf, gone});
    }
    return leaves;
}

std::vector<LocalPoint> fill_lattice(const Incline& incline, double spacing, double along, int columns_along,
                                     double across, int columns_across,
                                     const std::function<double(double, double)>& thickness) {
    std::vector<LocalPoint> points;
    for (int j = 0; j < columns_across; ++j) {
        for (int i = 0; i < columns_along; ++i) {
            const double s = along + (i + 0.5) * spacing, y = across + (j + 0.5) * spacing;
            // Rounding by an additive low-discrepancy sequence (Roberts 2018) distributes the remaining particles
            // evenly.
            double whole = 0;
            const double threshold = std::modf(i * 0.7548776662466927 + j * 0.5698402909980532, &whole);
            const double share = std::max(0.0, thickness(s, y)) / spacing;
            const double layers = std::floor(share + 1e-6);
            const int count = static_cast<int>(layers) + (share - layers > threshold + 1e-6 ? 1 : 0);
            for (int k = 0; k < count; ++k) points.push_back(incline.point(s, y, (k + 0.5) * spacing));
        }
    }
    return points;
}

std::vector<LocalPoint> fill_block(double head, double bottom, int columns, int rows, int layers, double spacing) {
    const double width = rows * spacing;
    std::vector<LocalPoint> points;
    for (int k = 0; k < layers; ++k) {
        for (int j = 0; j < rows; ++j) {
            for (int i = 0; i < columns; ++i) {
                points.push_back({static_cast<float>(head - (i + 0.5) * spacing),
                                  static_cast<float>(-width / 2 + (j + 0.5) * spacing),
                                  static_cast<float>(bottom + (k + 0.5) * spacing)});
            }
        }
    }
    return points;
}

sim::State state_at_rest(const std::vector<LocalPoint>& points) {
    sim::State state;
    state.resize(points.size());
    state.count = state.seeded = static_cast<std::uint32_t>(points.size());
    for (std::uint32_t i = 0; i < state.count; ++i) {
        state.position.set(i, points[i]);
        state.id[i] = i;
    }
    return state;
}

sim::State state_under_weight(const sim::Model& model, const sim::Ground& ground, const std::vector<LocalPoint>& points,
                              const Incline& incline, const std::function<double(double, double)>& thickness) {
    sim::State state = state_at_rest(points);
    const double gravity = model.gravity * incline.cosine();
    state.previous_time_step = 1;  // s: multipliers are pressure over density, times its square
    for (std::uint32_t i = 0; i < state.count; ++i) {
        const double above = thickness(incline.along(points[i]), points[i].y) - incline.normal(points[i]);
        state.multiplier[i] = static_cast<float>(-gravity * std::max(0.0, above));
    }
    // Debris with free sides has less pressure there.
    find_pressures(model, ground, state);
    return state;
}

double momentum_along(const sim::Model& model, const sim::State& state) {
    double sum = 0;
    for (std::uint32_t i = 0; i < state.count; ++i) sum += state.velocity.x[i];
    return sum * model.particle_mass();
}

namespace {

run::RunStart endless(run::RunStart start, const Watch& watch, Observed observed) {
    start.model.solver.thread_count = watch.thread_count;
    start.model.solver.backend = watch.backend;
    start.endless = true;
    start.measured = observed == Observed::yes;
    return start;
}

}  // namespace

Trial::Trial(run::RunStart start, const Watch& watch, OnFault on_fault, Observed observed)
    : run_(endless(std::move(start), watch, observed)), watch_(watch), on_fault_(on_fault) {
    // As scenes refuse it: smoothing of more than the whole velocity difference is cut, and would be another viscosity.
    const double longest = sim::longest_viscous_step(model().viscosity);
    if (model().solver.time_step > longest * (1 + 1e-9)) {
        problem_ = fmt::format("the viscosity needs steps of at most {:.3g} s, the case takes {:.3g} s", longest,
                               *model().solver.time_step);
        stopped_ = true;
    }
}

void Trial::remove_wall(std::size_t building) {
    run_.change([&](sim::Model& model, sim::Ground& ground, sim::State& state) {
        sim::remove_building(model, ground, state, building);
        return state.seeded;
    });
}

bool Trial::advance_to(double time, const std::function<void()>& after_step) {
    while (!stopped_ && run_.summary().time < time - 1e-9) {
        if (watch_.stopped()) {
            problem_ = "stopped by the user";
            stopped_ = true;
            break;
        }
        if (!run_.advance()) {
            if (problem_.empty()) problem_ = run_.stop_reason();
            stopped_ = on_fault_ == OnFault::stop || !std::isfinite(run_.summary().max_speed);
        }
        if (stopped_ || !after_step) continue;
        (void)state();
        after_step();
    }
    (void)state();
    return !stopped_;
}

}  // namespace talus::validate
