#include "run/cost.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "core/try.hpp"
#include "run/run.hpp"
#include "scene/limits.hpp"
#include "scene/particle_spacing.hpp"
#include "sim/time_step.hpp"

namespace talus::run {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double few_particles = 2000, many_particles = 20000;
constexpr double rehearsal_limit = 8, timed_early = 1;  // s of wall time
constexpr double program_memory = 70e6;                 // bytes, measured with a small terrain

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The spacing of so many particles, well below the limit, or a finer one of which every release and inflow fills one.
double spacing_for(const scene::Scene& scene, double particles) {
    double volume = total_volume(scene) / std::min(particles, 0.9 * scene.spec.solver.particle_limit);
    for (const terrain::Release& release : scene.releases) volume = std::min(volume, release.volume);
    for (const terrain::Inflow& inflow : scene.inflows) volume = std::min(volume, inflow.volume());
    return std::cbrt(volume);
}

/// Takes steps until the run is over or `stopped()`.
template <class Stopped>
std::vector<Rehearsal::Step> take_steps(Run& run, const Stopped& stopped) {
    std::vector<Rehearsal::Step> steps;
    while (!stopped()) {
        const double before = run.wall_time(), max_speed = run.summary().max_speed;
        const bool more = run.advance();
        if (run.wall_time() > before) steps.push_back({max_speed, run.wall_time() - before});
        if (!more) break;
    }
    return steps;
}

/// Mean of the first steps, so many that other work on the machine averages out.
double early_step_time(const std::vector<Rehearsal::Step>& steps) {
    double sum = 0;
    std::size_t count = 0;
    while (count < steps.size() && sum < timed_early) sum += steps[count++].wall_time;
    return count > 0 ? sum / static_cast<double>(count) : 0;
}

/// Time per step and particle of `times` as many particles, relative to that of few: a power law between the two
/// numbers of particles that were timed, and constant beyond them.
double relative_cost(const Rehearsal& rehearsal, double times) {
    if (rehearsal.many <= 1) return 1;
    return std::pow(rehearsal.more_per_step, std::clamp(std::log(times) / std::log(rehearsal.many), 0.0, 1.0));
}

sim::Model model_of(const scene::Scene& scene, double particle_spacing) {
    sim::Model model;
    model.solver = scene.spec.solver;
    model.particle_spacing = particle_spacing;
    return model;
}

}  // namespace

Result<Rehearsal> rehearse(const scene::Scene& scene, double particle_spacing,
                           const std::atomic<bool>& stop_requested) {
    Rehearsal rehearsal;
    rehearsal.particle_spacing = std::max(particle_spacing, spacing_for(scene, few_particles));
    const Clock::time_point start = Clock::now();
    TALUS_ASSIGN(const std::unique_ptr<Run> few, Run::start(scene, rehearsal.particle_spacing));
    double seeding_time = seconds_since(start);
    std::uint32_t seeded = few->summary().count;
    rehearsal.steps = take_steps(*few, [&] { return stop_requested.load() || seconds_since(start) > rehearsal_limit; });
    rehearsal.simulated_time = few->summary().time;
    rehearsal.complete = few->phase() == RunPhase::at_rest || few->phase() == RunPhase::ended;

    const double finer = std::max(particle_spacing, spacing_for(scene, many_particles));
    const double few_time = early_step_time(rehearsal.steps);
    if (finer < rehearsal.particle_spacing && few_time > 0 && seeded > 0 && !stop_requested.load()) {
        const Clock::time_point again = Clock::now();
        TALUS_ASSIGN(const std::unique_ptr<Run> many, Run::start(scene, finer));
        seeding_time = seconds_since(again);
        rehearsal.many = many->summary().count / static_cast<double>(seeded);
        seeded = many->summary().count;
        const double many_time = early_step_time(
            take_steps(*many, [&] { return stop_requested.load() || many->wall_time() > timed_early; }));
        if (many_time > 0) rehearsal.more_per_step = many_time / few_time / rehearsal.many;
    }
    rehearsal.seeding_time = seeded > 0 ? seeding_time / seeded : 0;
    return rehearsal;
}

Cost cost_of(const scene::Scene& scene, const Rehearsal& rehearsal, double particle_spacing) {
    Cost cost;
    cost.particle_spacing = particle_spacing;
    cost.particles = total_volume(scene) / std::pow(particle_spacing, 3);
    const sim::Model few = model_of(scene, rehearsal.particle_spacing), wanted = model_of(scene, particle_spacing);
    double sum = 0;
    sim::State state;
    for (const Rehearsal::Step& step : rehearsal.steps) {
        state.max_speed = step.max_speed;
        sum += step.wall_time * sim::choose_time_step(few, state) / sim::choose_time_step(wanted, state);
    }
    const double times = std::pow(rehearsal.particle_spacing / particle_spacing, 3);
    sum *= times * relative_cost(rehearsal, times);
    cost.simulated_time = rehearsal.complete ? rehearsal.simulated_time : scene.spec.solver.end_time;
    if (rehearsal.simulated_time > 0) cost.wall_time = sum * cost.simulated_time / rehearsal.simulated_time;
    cost.seeding_time = cost.particles * rehearsal.seeding_time;
    cost.memory = program_memory + memory_needed(scene, cost.particles);
    return cost;
}

double real_time_layers(const scene::Scene& scene, const Rehearsal& rehearsal, double thickness) {
    double fast = 0, slow = most_layers(scene, thickness);
    const auto in_time = [&](double layers) {
        return cost_of(scene, rehearsal, thickness / layers).real_time_factor() >= real_time_margin;
    };
    if (in_time(slow)) fast = slow;
    while (slow - fast > 0.01) {
        const double middle = (fast + slow) / 2;
        (in_time(middle) ? fast : slow) = middle;
    }
    return std::floor(10 * fast) / 10;
}

}  // namespace talus::run
