#include "debris.hpp"

#include <algorithm>
#include <array>
#include <map>

namespace talus::benchmarks {
namespace {

constexpr int steps = 20;  // until the lattice that debris starts as has come into disorder

}  // namespace

Debris::Debris(int particles)
    : start(*bench::make_start("slab", particles, "")),
      simulation(start.model, start.state),
      sums(cpu::pair_sums_for(model().kernel.choice)),
      scale(model().kernel),
      neighbours(count(), sums) {
    for (int step = 0; step < steps; ++step) (void)simulation.advance();
    const std::uint32_t n = count();
    cpu::CellSort cell_sort(n);
    const auto order = cell_sort.sort(state().position, n, model().support_radius, grid);
    points.resize(n);
    displacement.resize(n);
    boundary.resize(n);
    for (auto* packed : {&packed_points, &packed_vectors, &stress_rows, &stress_rest}) packed->resize(n);
    const auto dt = static_cast<float>(state().time_step);
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t from = order[i];
        const LocalPoint p = state().position.at(from), u = state().velocity.at(from) * dt;
        const float lambda = state().multiplier[from];
        const Deviator<float> s = state().stress.at(from);
        points.set(i, p);
        displacement.set(i, u);
        boundary[i] = sample_boundary(model(), p);
        packed_points[i] = {p.x, p.y, p.z, lambda};
        packed_vectors[i] = {u.x, u.y, u.z, lambda};
        stress_rows[i] = {lambda + s.xx, s.xy, s.xz, lambda + s.yy};
        stress_rest[i] = {s.yz, lambda - s.xx - s.yy, 0, lambda};
    }
    neighbours.build(points, grid, static_cast<float>(model().support_radius));
    // Leaves the pair gradients that the other sums read.
    for (std::uint32_t i = 0; i < n; ++i) sums.density(scale, neighbours.pairs_of(i), packed_points, i);
}

Debris& debris_of(std::int64_t particles) {
    static std::map<std::int64_t, std::unique_ptr<Debris>> made;
    auto& debris = made[particles];
    if (!debris) debris = std::make_unique<Debris>(static_cast<int>(particles));
    return *debris;
}

}  // namespace talus::benchmarks
