#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "bench/scenes.hpp"
#include "sim/cpu/cell_sort.hpp"
#include "sim/cpu/neighbours.hpp"
#include "sim/cpu/pair_sums.hpp"
#include "sim/physics/boundary.hpp"
#include "sim/simulation.hpp"

namespace talus::benchmarks {

/// The bench scene `slab` after some steps, and what the stages of a step read: neighbours, packed numbers, ground.
struct Debris {
    explicit Debris(int particles);

    [[nodiscard]] std::uint32_t count() const { return simulation.state().count; }
    [[nodiscard]] const Model& model() const { return simulation.model(); }
    [[nodiscard]] const State& state() const { return simulation.state(); }

    bench::Start start;
    Simulation simulation;
    cpu::PairSums sums;
    cpu::PairScale scale;
    VectorArray points;  ///< sorted by grid
    cpu::CellGrid grid;
    cpu::NeighbourLists neighbours;
    VectorArray displacement;                   ///< of a step
    std::vector<Boundary<float>> boundary;      ///< at the points
    cpu::Packed packed_points, packed_vectors;  ///< points and displacements, with a multiplier each
    cpu::Packed stress_rows, stress_rest;
};

/// The same debris for all benchmarks of one number of particles: making it takes longer than measuring.
[[nodiscard]] Debris& debris_of(std::int64_t particles);

}  // namespace talus::benchmarks
