// Changes a live run from one setup to another: first everything that can fail, then the change.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "scene/limits.hpp"
#include "sim/change.hpp"
#include "sim/sources/seed.hpp"
#include "terrain/wall_effort.hpp"
#include "twin/live_run.hpp"

namespace talus::twin {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

bool overlap(const Extent& a, const Extent& b) {
    return a.x_min <= b.x_max && b.x_min <= a.x_max && a.y_min <= b.y_max && b.y_min <= a.y_max;
}

bool overlaps_any(const Extent& a, const std::vector<Extent>& others) {
    return std::any_of(others.begin(), others.end(), [&](const Extent& other) { return overlap(a, other); });
}

/// Whether two lists of obstacles hold the very same ones in the same order.
template <class Entries>
bool same_bodies(const Entries& a, const Entries& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const auto& p, const auto& q) { return p.id == q.id && p.body == q.body; });
}

/// What an action may take by estimate, s of processor time: nobody else's action is heard meanwhile.
constexpr double max_effort = 10;
// Measured on a core of 2.6 GHz, with barriers upon each other on the built-in scene.
constexpr double seconds_per_comparison = 13e-9;
constexpr double seconds_per_particle = 0.5e-3, seconds_per_particle_and_piece = 12e-6;  // seeded

/// Resistances: if any of them changes, debris at rest may move again.
std::array<double, 7> resistance_values(const sim::Model& model) {
    return {model.friction_coefficient,
            model.building_friction_coefficient,
            model.internal_friction_coefficient,
            model.viscosity,
            model.cohesion / model.rest_density,
            model.cover.empty() ? 0 : 1 / model.rest_density,  // cohesion of zones is divided by it
            model.pore_pressure_ratio};
}

/// Structures farther from a release than this, in support radii, have no part in how its debris is seeded.
constexpr double seeding_reach = 10;

}  // namespace

/// The effects of a change of setup.
struct LiveRun::Change {
    Setup next;
    std::vector<Obstacle> obstacles;
    std::optional<std::vector<terrain::Building>> buildings;  ///< of the ground, if any changes
    std::optional<terrain::BuildingSolids> solids;            ///< likewise
    std::optional<terrain::WallEffort> effort;                ///< likewise
    std::vector<Extent> touched;                              ///< world, of obstacles that were added, removed or moved
    std::vector<std::size_t> renewed;                         ///< obstacles whose record is reset

    std::optional<terrain::GroundCover> cover;  ///< of zones that were added, removed or changed

    struct Seed {
        const ReleaseSetup* release;
        sim::State state;
    };
    std::vector<const ReleaseSetup*> to_seed;  ///< of `next`
    std::vector<Seed> seeds;
    std::vector<bool> gone;  ///< by group: its debris is removed
};

Status LiveRun::plan_obstacles(const Setup& next, Change& change) const {
    change.obstacles = obstacles_;
    if (same_bodies(setup_.buildings, next.buildings) && same_bodies(setup_.barriers, next.barriers)) return {};
    std::vector<terrain::Building>& buildings = change.buildings.emplace(ground().buildings);
    for (std::size_t k = 0; k < obstacles_.size(); ++k) {
        Obstacle& obstacle = change.obstacles[k];
        const bool wanted =
            find_id(next.buildings, obstacle.id) != nullptr || find_id(next.barriers, obstacle.id) != nullptr;
        if (wanted || !(obstacle.stands || obstacle.failed)) continue;
        obstacle.stands = obstacle.failed = false;
        obstacle.until_step = summary().step;
        obstacle.last = impact_now(k);
        obstacle.last.removed_time = summary().time;
        buildings[k] = without_solid(buildings[k]);
        change.touched.push_back(extent_of(*obstacle.body));
    }
    const auto put = [&](const auto& entry, bool barrier) {
        Obstacle* obstacle = find_id(change.obstacles, entry.id);
        if (obstacle == nullptr) {
            change.obstacles.push_back({entry.id, entry.body, barrier, summary().step});
            buildings.push_back(*entry.body);
            change.touched.push_back(extent_of(*entry.body));
            return;
        }
        const auto k = static_cast<std::size_t>(obstacle - change.obstacles.data());
        const bool moved = !same_shape(obstacle->body, entry.body);
        buildings[k].name = entry.body->name;
        if ((obstacle->stands || obstacle->failed) && !moved) return;
        if (obstacle->stands) change.touched.push_back(extent_of(*obstacle->body));
        change.touched.push_back(extent_of(*entry.body));
        if (moved) change.renewed.push_back(k);
        *obstacle = {entry.id, entry.body, barrier, moved ? summary().step : obstacle->since_step};
        buildings[k] = *entry.body;
    };
    for (const BuildingSetup& building : next.buildings) put(building, false);
    for (const BarrierSetup& barrier : next.barriers) put(barrier, true);
    if (change.touched.empty()) return {};
    change.effort.emplace(buildings, model().support_radius);
    if (const double estimate = change.effort->comparisons() * seconds_per_comparison; estimate > max_effort) {
        return Error{
            fmt::format("obstacles that overlap: their walls would take about {:.0f} s to cut; an action may take "
                        "{:.0f} s. Place them apart",
                        estimate, max_effort)};
    }
    change.solids.emplace(ground().terrain, buildings, model().support_radius);
    return {};
}

/// particles: in all, with those of the release.
Status LiveRun::check_room(const ReleaseSetup& release, double particles) const {
    const int limit = model().solver.particle_limit;
    if (particles <= std::min(limit, max_live_particles)) return {};
    const std::string told = fmt::format("release \"{}\": {:.4g} m3 would make {:.0f} particles in all",
                                         release.body->name, release.body->volume, particles);
    if (particles > limit) {
        return Error{fmt::format("{}; solver.particle_limit must be at least that, and is {}", told, limit)};
    }
    return Error{fmt::format("{}, which need about {:.2g} GB; a live run may have {}", told,
                             particles * scene::bytes_per_particle / 1e9, max_live_particles)};
}

Status LiveRun::plan_releases(const Setup& next, Change& change) const {
    change.gone.assign(groups_.size(), false);
    std::vector<const ReleaseSetup*>& to_seed = change.to_seed;
    for (const ReleaseSetup& release : next.releases) {
        const Group* group = find_id(groups_, release.id);
        const ReleaseSetup* before = find_id(setup_.releases, release.id);
        bool seed = group == nullptr;
        if (group != nullptr && !group->begun) {
            seed = !same_shape(before->body, release.body) || overlaps_any(release.body->extent(), change.touched);
        } else if (group != nullptr && before->triggered && !release.triggered) {
            seed = release.body->spec.start_time > summary().time;  // its start is revoked
        }
        if (!seed) continue;
        to_seed.push_back(&release);
        if (group != nullptr) change.gone[static_cast<std::size_t>(group - groups_.data())] = true;
    }
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        if (find_id(next.releases, groups_[g].id) == nullptr) change.gone[g] = true;
    }
    if (to_seed.empty()) return {};

    double particles = state().count;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        if (!change.gone[g]) continue;
        const sim::ReleaseGroup& group = model().releases[g];
        for (std::uint32_t i = 0; i < state().count; ++i) {
            particles -= state().id[i] >= group.first_particle && state().id[i] < group.last_particle ? 1 : 0;
        }
    }
    for (const ReleaseSetup* release : to_seed) {  // before any of it is done
        particles += std::round(release->body->volume / model().particle_volume());
        TALUS_TRY(check_room(*release, particles));
    }
    const terrain::WallEffort effort =
        change.effort ? *change.effort : terrain::WallEffort(ground().buildings, model().support_radius);
    double open_ground = 0, estimate = 0;
    for (const ReleaseSetup* release : to_seed) {
        const double count = release->body->volume / model().particle_volume();
        open_ground += seconds_per_particle * count;
        const double pieces = effort.pieces_near(release->body->extent());
        estimate += (seconds_per_particle + seconds_per_particle_and_piece * pieces) * count;
        if (estimate <= std::max(max_effort, 2 * open_ground)) continue;
        return Error{
            fmt::format("release \"{}\": its debris would take about {:.0f} s to seed among the obstacles there; "
                        "an action may take {:.0f} s. Remove obstacles or debris there first",
                        release->body->name, estimate, max_effort)};
    }
    return {};
}

Status LiveRun::seed_debris(Change& change, const sim::Progress& progress) const {
    if (change.to_seed.empty()) return {};
    sim::Model alone = model();
    set_material(alone, change.next.material);
    sim::Ground around = ground();
    if (change.solids) around.solids = *change.solids;
    for (const ReleaseSetup* release : change.to_seed) {
        TALUS_ASSIGN(sim::State seeded, seed_releases(alone, around, {*release->body}, progress));
        change.seeds.push_back({release, std::move(seeded)});
    }
    return {};
}

/// All debris of a run is seeded together, with the material and beside the structures of its start.
bool LiveRun::begins_anew(const Change& change) const {
    if (summary().step > 0) return false;
    const Setup& next = change.next;
    const double reach = seeding_reach * model().support_radius;
    const bool near = std::any_of(next.releases.begin(), next.releases.end(), [&](const ReleaseSetup& release) {
        return overlaps_any(release.body->extent().grown(reach), change.touched);
    });
    return near || change.cover || !begin_alike(next, begun_with_) || !same_material(next.material, setup_.material) ||
           !same_shapes(next.releases, setup_.releases);
}

Result<std::shared_ptr<LiveRun::Change>> LiveRun::prepare(const Setup& next, const sim::Progress& progress) const {
    return run_->threads().execute([&]() -> Result<std::shared_ptr<Change>> {
        auto change = std::make_shared<Change>();
        change->next = next;
        const Setup& wanted = change->next;  // lives as long as the change, which refers to it
        TALUS_TRY(plan_obstacles(wanted, *change));
        if (!same_shapes(setup_.zones, wanted.zones)) {
            change->cover = zones_on_terrain(bodies_of(wanted.zones), ground().terrain).cover;
        }
        TALUS_TRY(plan_releases(wanted, *change));
        if (begins_anew(*change)) return std::shared_ptr<Change>();
        TALUS_TRY(seed_debris(*change, progress));
        return change;
    });
}

/// Removes the debris of deleted releases and adds that of new ones, held.
void LiveRun::replace_releases(sim::Model& model, sim::State& state, Change& change) {
    // Ids at the end, of debris that never moved, are reused: otherwise dragging the outline of a release would use up
    // ids without limit.
    bool given_back = true;
    std::vector<bool> done(groups_.size(), false);
    while (given_back) {
        given_back = false;
        for (std::size_t g = 0; g < groups_.size(); ++g) {
            const sim::ReleaseGroup group = model.releases[g];
            if (done[g] || !change.gone[g] || groups_[g].begun || group.last_particle != state.seeded) continue;
            const std::uint32_t taken = state.removed;
            remove_particles(state, group.first_particle, group.last_particle);
            state.removed = taken;
            state.seeded = group.first_particle;
            done[g] = given_back = true;
        }
    }
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        if (!change.gone[g] || done[g]) continue;
        const sim::ReleaseGroup& group = model.releases[g];
        Extent lay{infinity, infinity, -infinity, -infinity};
        for (std::uint32_t i = 0; i < state.count; ++i) {
            if (state.id[i] < group.first_particle || state.id[i] >= group.last_particle) continue;
            lay.include({state.position.x[i], state.position.y[i]});
        }
        remove_particles(state, group.first_particle, group.last_particle);
        wake(state, lay.grown(2 * model.support_radius));
    }
    std::vector<Group> groups;
    std::vector<sim::ReleaseGroup> ranges;
    std::vector<sim::Water> waters;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        if (change.gone[g]) continue;
        groups.push_back(groups_[g]);
        ranges.push_back(model.releases[g]);
        if (g < state.water_of_release.size()) waters.push_back(state.water_of_release[g]);
    }
    state.water_of_release = std::move(waters);
    for (Change::Seed& seed : change.seeds) {
        const std::uint32_t first = state.seeded;
        append_particles(state, seed.state, first);
        groups.push_back({seed.release->id, false});
        ranges.push_back({seed.release->body->name, seed.release->body->spec.start_time, first, state.seeded,
                          seed.release->body->spec.pore_pressure_ratio, seed.release->body->spec.solid_fraction,
                          seed.release->body->water});
    }
    groups_ = std::move(groups);
    model.releases = std::move(ranges);
}

void LiveRun::set_start_times(sim::Model& model, const sim::State& state, const Setup& next) {
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        if (groups_[g].begun) continue;
        const ReleaseSetup& release = *find_id(next.releases, groups_[g].id);
        model.releases[g].start_time =
            release.triggered ? std::min(release.body->spec.start_time, state.time) : release.body->spec.start_time;
    }
}

void LiveRun::put_in_force(Change& change) {
    const Setup& next = change.next;
    const auto held_back = resistance_values(model());
    const WorldPoint origin = ground().terrain.frame().origin;
    run_->change([&](sim::Model& model, sim::Ground& ground, sim::State& state) {
        set_material(model, next.material);
        if (change.buildings) ground.buildings = std::move(*change.buildings);
        if (change.solids) ground.solids = std::move(*change.solids);
        replace_releases(model, state, change);
        set_start_times(model, state, next);
        std::uint32_t first_new = state.seeded;
        for (const Change::Seed& seed : change.seeds) first_new -= seed.state.seeded;
        for (const Extent& e : change.touched) {
            const Extent local{e.x_min - origin.x, e.y_min - origin.y, e.x_max - origin.x, e.y_max - origin.y};
            wake(state, local.grown(2 * model.support_radius));
            clear_solids(model, ground, state, local);
        }
        if (change.cover) model.cover = std::move(*change.cover);
        if (change.cover || held_back != resistance_values(model))
            wake(state, {-infinity, -infinity, infinity, infinity});
        return first_new;
    });
    slots_ = std::max(slots_, state().seeded);
    obstacles_ = std::move(change.obstacles);
    for (const std::size_t k : change.renewed) {
        run_->forget_building(k);
        impact_history_.forget(k);
    }
}

void LiveRun::carry_out(Change& change) {
    run_->threads().execute([&] { put_in_force(change); });
    setup_ = std::move(change.next);
    alarms_.watch(setup_);
}

Status LiveRun::bring_to(const Setup& next) {
    TALUS_ASSIGN(const auto change, prepare(next));
    carry_out(*change);
    return {};
}

}  // namespace talus::twin
