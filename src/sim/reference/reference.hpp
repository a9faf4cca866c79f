#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry.hpp"
#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/physics/contact.hpp"
#include "sim/physics/density.hpp"
#include "sim/physics/stress.hpp"
#include "sim/state.hpp"

namespace talus::sim::reference {

using Vector = Vec3<double>;

/// A particle with all that a step needs.
struct Particle {
    Vector position, velocity, displacement;
    double multiplier = 0, multiplier_change = 0, tolerated_compression = 0, compression = 0;
    Deviator<double> stress, stress_change;
    DensityConstraint<double> constraint;
    Vector linearised_at, sampled_at, shift;
    Boundary<double> boundary;
    ContactMemories<double> contacts;
    Grip<double> grip;
    double effective_share = 1, ground_shear = 0;
    bool held = false;

    [[nodiscard]] Vector predicted() const { return position + displacement; }
};

/// The particles in the order of their ids.
struct State {
    double time = 0, time_step = 0, previous_time_step = 0;
    std::uint64_t step = 0;
    std::vector<Particle> particles;
    std::vector<Entry> entry_of_id;
    std::vector<Water> water_of_release;
    std::vector<Soil<double>> soil_of_id;  ///< with evolving pore pressure; empty before the first step
    // Of the last step; see compression.hpp.
    double mean_compression = 0, max_compression = 0, mean_added_compression = 0, overcompressed_share = 0,
           squeezing_share = 0;
    int iterations = 0;  ///< that the step took

    State() = default;
    explicit State(const sim::State& state);
};

/// The density constraint G of a particle (eq. 1), summed over every other particle.
[[nodiscard]] double constraint(const Model& model, const Ground& ground, const std::vector<Vector>& points,
                                std::size_t i);

/// Its gradient with respect to the position of particle k.
[[nodiscard]] Vector constraint_gradient(const Model& model, const Ground& ground, const std::vector<Vector>& points,
                                         std::size_t i, std::size_t k);

/// The stages of a step in double precision and in O(N^2), as plainly as the laws allow. The fast backends are tested
/// against it; no run uses it.
class Backend {
  public:
    void begin_step(const Model&, const State&) {}
    void release_held(const Model& model, State& state);
    void apply_drag(const Model& model, const Ground& ground, State& state);
    void predict_positions(const Model& model, const Ground& ground, State& state);
    void sort_particles(const Model&, State&) {}
    void find_neighbours(const Model&, State&) {}
    void prepare_particles(const Model& model, const Ground& ground, State& state);
    void warm_start(const Model& model, const Ground& ground, State& state);
    void solve_density(const Model& model, const Ground& ground, State& state);
    void solve_contacts(const Model& model, const Ground& ground, State& state);
    void measure_compression(const Model& model, State& state);
    void resolve_penetration(const Model& model, const Ground& ground, State& state);
    void enforce_boundaries(const Model& model, const Ground& ground, State& state);
    void update_velocities(const Model& model, const Ground& ground, State& state);
    void measure_impacts(const Model&, const Ground&, State&) {}
    void apply_viscosity(const Model& model, const Ground& ground, State& state);
    void update_sleep(const Model&, const Ground&, State&) {}
    void remove_outflow(const Model&, const Ground&, State&) {}
};

}  // namespace talus::sim::reference
