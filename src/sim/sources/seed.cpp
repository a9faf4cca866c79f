#include "sim/sources/seed.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "core/try.hpp"
#include "sim/change.hpp"
#include "sim/cpu/backend.hpp"
#include "sim/relax.hpp"
#include "sim/step.hpp"

namespace talus::sim {
namespace {

/// A column of the seeding lattice.
struct Column {
    PlanPoint centre;
    int particles = 0;
    double leftover = 0;  ///< the fraction that rounding left out, [0, 1)
};

/// Columns with their particle counts, adding up to `target`.
std::vector<Column> fill_columns(const terrain::Terrain& terrain, const terrain::Release& release, double spacing,
                                 long target, const Progress& progress) {
    std::vector<Column> columns;
    const Extent extent = release.extent();
    const int across = static_cast<int>(std::ceil(extent.width() / spacing)) + 1;
    const int along = static_cast<int>(std::ceil(extent.height() / spacing)) + 1;
    long total = 0;
    for (int row = 0; row < along; ++row) {
        if (progress && !progress(0)) return {};
        for (int column = 0; column < across; ++column) {
            const PlanPoint centre{extent.x_min + (column + 0.5) * spacing, extent.y_min + (row + 0.5) * spacing};
            constexpr int parts = 3;  // sub-samples per side, so that columns on the outline get their share
            double depth = 0;
            for (int east = 0; east < parts; ++east) {
                for (int north = 0; north < parts; ++north) {
                    const PlanPoint sample{centre.x + ((east + 0.5) / parts - 0.5) * spacing,
                                           centre.y + ((north + 0.5) / parts - 0.5) * spacing};
                    depth += release.depth_at(terrain, sample) / (parts * parts);
                }
            }
            if (depth <= 0) continue;
            // Rounding by an additive low-discrepancy sequence (Roberts 2018) distributes the remaining particles
            // evenly.
            double whole = 0;
            const double threshold = std::modf(column * 0.7548776662466927 + row * 0.5698402909980532, &whole);
            const double share = depth / spacing + threshold;
            Column entry{centre, static_cast<int>(share), 0};
            entry.leftover = share - entry.particles;
            total += entry.particles;
            columns.push_back(entry);
        }
    }
    // The remaining difference is added to the columns nearest to one more particle, or subtracted from those nearest
    // to one less.
    std::vector<std::size_t> order(columns.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return columns[a].leftover > columns[b].leftover; });
    while (total != target && !columns.empty()) {
        const long before = total;
        if (total < target) {
            for (auto at = order.begin(); at != order.end() && total < target; ++at, ++total) ++columns[*at].particles;
        } else {
            for (auto at = order.rbegin(); at != order.rend() && total > target; ++at) {
                if (columns[*at].particles == 0) continue;
                --columns[*at].particles;
                --total;
            }
        }
        if (total == before) break;
    }
    return columns;
}

/// A column's particles lie at its centre, which can be inside a wall that cuts its edge.
void put_out_of_buildings(const Model& model, const Ground& ground, State& state) {
    if (ground.solids.empty()) return;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        LocalPoint p = state.position.at(i);
        push_out_of_solids(model, ground, p, terrain::largest_grain, [](const LocalPoint&) {});
        state.position.set(i, p);
    }
}

/// Debris with walls around it can be pushed out of a building only into other debris.
Status check_room(const State& state) {
    constexpr double most = 0.5;
    if (state.mean_compression <= most) return {};
    return Error{
        fmt::format("debris has no room where it is released: it is compressed by {:.2g} on average before it moves "
                    "(at most {:g}); "
                    "move or shrink the structures that stand in the release, or the release",
                    state.mean_compression, most)};
}

}  // namespace

void find_pressures(const Model& model, const Ground& ground, State& state) {
    constexpr int rounds = 100;
    const State start = state;
    Model awake = model;
    awake.solver.rest_duration = 0;
    cpu::Backend backend(awake, state.count);
    StageTimes times;
    state.time_step = model.largest_time_step() / 4;
    for (int round = 0; round < rounds; ++round) {
        step(backend, awake, ground, state, times);
        for (std::uint32_t i = 0; i < state.count; ++i) {
            state.position.set(i, start.position.at(state.id[i]));
            state.velocity.set(i, start.velocity.at(state.id[i]));
        }
        forget_soil(awake, state);
    }
    state.time = start.time;
    state.step = start.step;
}

Status check_particle_count(const std::vector<terrain::Release>& releases, const std::vector<terrain::Inflow>& inflows,
                            const params::SolverSpec& solver, double particle_spacing) {
    const double particle = particle_spacing * particle_spacing * particle_spacing;
    double volume = 0, particles = 0;
    const auto add = [&](const char* what, const std::string& name, double its_volume) -> Status {
        const double count = std::round(its_volume / particle);
        if (count < 1) {
            return Error{
                fmt::format("{} '{}': {:.4g} m3 is less than one particle of solver.particle_spacing_m = {:.4g}", what,
                            name, its_volume, particle_spacing)};
        }
        volume += its_volume;
        particles += count;
        return {};
    };
    for (const terrain::Release& release : releases) TALUS_TRY(add("release", release.name, release.volume));
    for (const terrain::Inflow& inflow : inflows) TALUS_TRY(add("inflow", inflow.name, inflow.volume()));
    if (particles <= solver.particle_limit) return {};
    return Error{
        fmt::format("{:.4g} m3 at solver.particle_spacing_m = {:.4g} would need {:.0f} particles, more than "
                    "solver.particle_limit = {}; a spacing of {:.4g} m or more would fit",
                    volume, particle_spacing, particles, solver.particle_limit,
                    std::ceil(std::cbrt(volume / solver.particle_limit) * 1000) / 1000)};
}

Result<State> seed_releases(Model& model, const Ground& ground, const std::vector<terrain::Release>& releases,
                            const Progress& progress) {
    const Error ended{"cancelled"};
    const double spacing = model.particle_spacing;
    TALUS_TRY(check_particle_count(releases, {}, model.solver, spacing));
    std::vector<long> targets;
    long particles = 0;
    for (const terrain::Release& release : releases) {
        targets.push_back(std::lround(release.volume / model.particle_volume()));
        particles += targets.back();
    }

    State state;
    const auto count = static_cast<std::uint32_t>(particles);
    state.resize(count);
    std::iota(state.id.begin(), state.id.begin() + count, 0u);
    model.releases.clear();
    std::vector<float> overburden(count);
    std::uint32_t next = 0;
    for (std::size_t r = 0; r < releases.size(); ++r) {
        const std::uint32_t first = next;
        for (const Column& column : fill_columns(ground.terrain, releases[r], spacing, targets[r], progress)) {
            const LocalPoint plan = ground.terrain.frame().to_local({column.centre.x, column.centre.y, 0});
            const terrain::GroundSample<float> below = ground.terrain.sample(plan.x, plan.y);
            // The first particle touches the ground: half a spacing along the normal.
            const double bottom = below.height + spacing / 2 / below.normal.z;
            for (int layer = 0; layer < column.particles && next < count; ++layer, ++next) {
                state.position.set(next, {plan.x, plan.y, static_cast<float>(bottom + layer * spacing)});
                const double above = (column.particles - layer - 0.5) * spacing;
                overburden[next] = static_cast<float>(above * below.normal.z * below.normal.z);
            }
        }
        model.releases.push_back({releases[r].name, releases[r].spec.start_time, first, next,
                                  releases[r].spec.pore_pressure_ratio, releases[r].spec.solid_fraction,
                                  releases[r].water});
    }
    if (progress && !progress(0)) return ended;
    state.seeded = state.count = next;
    if (state.count == 0) return state;
    put_out_of_buildings(model, ground, state);
    if (!relax(model, ground, state, overburden, progress)) return ended;
    TALUS_TRY(check_room(state));
    for (std::uint32_t i = 0; i < state.count; ++i) {
        for (const ReleaseGroup& release : model.releases) {
            const bool own = state.id[i] >= release.first_particle && state.id[i] < release.last_particle;
            if (own) state.held[i] = release.start_time > 0;
        }
    }
    state.max_speed = 0;  // was that of the search for the pressures
    return state;
}

}  // namespace talus::sim
