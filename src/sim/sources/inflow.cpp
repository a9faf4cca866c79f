#include "sim/sources/inflow.hpp"

#include <algorithm>
#include <cmath>

#include "sim/change.hpp"
#include "sim/physics/net.hpp"
#include "sim/relax.hpp"

namespace talus::sim {

InflowFeeder::InflowFeeder(const Model& model, const LocalFrame& frame, const std::vector<terrain::Inflow>& inflows) {
    for (const terrain::Inflow& inflow : inflows) {
        places_.emplace_back(inflow.over_area(), inflow.over_area() ? areas_.size() : sources_.size());
        if (inflow.over_area()) {
            areas_.emplace_back(model, frame, inflow);
            continue;
        }
        Source source;
        source.inflow = inflow;
        source.spacing = model.particle_spacing;
        source.particle_volume = model.particle_volume();
        source.total = static_cast<std::uint32_t>(std::lround(inflow.volume() / source.particle_volume));
        source.last_time = inflow.hydrograph.front().time;
        sources_.push_back(std::move(source));
    }
}

std::uint32_t InflowFeeder::remaining() const {
    std::uint32_t count = 0;
    for (const Source& source : sources_) count += source.total - source.injected;
    for (const AreaSource& area : areas_) count += area.remaining();
    return count;
}

bool InflowFeeder::awaits(double time) const {
    return std::any_of(sources_.begin(), sources_.end(),
                       [&](const Source& source) { return source.gauged && time < source.end(); }) ||
           std::any_of(areas_.begin(), areas_.end(), [&](const AreaSource& area) { return area.awaits(time); });
}

void InflowFeeder::set_hydrograph(std::size_t inflow, const std::vector<params::InflowSample>& hydrograph) {
    const auto [over_area, index] = places_[inflow];
    if (over_area) return areas_[index].set_hydrograph(hydrograph);
    Source& source = sources_[index];
    source.inflow.hydrograph = hydrograph;
    const auto total = static_cast<std::uint32_t>(std::lround(source.inflow.volume() / source.particle_volume));
    source.total = std::max(total, source.injected);
    source.gauged = true;
}

bool InflowFeeder::due(double time) const {
    return std::any_of(sources_.begin(), sources_.end(),
                       [&](const Source& source) { return source.due(time) || source.leads(); }) ||
           std::any_of(areas_.begin(), areas_.end(), [&](const AreaSource& area) { return area.due(time); });
}

bool InflowFeeder::Source::leads() const {
    return std::any_of(prescribed.begin(), prescribed.end(), [](const Row& row) { return row.first != row.last; });
}

bool InflowFeeder::Source::due(double time) const {
    if (injected == total) return false;
    return time >= end() || inflow.way_until(time) >= static_cast<double>(rows + 1) * spacing;
}

double InflowFeeder::Source::next_time(double time) const {
    const double wanted = static_cast<double>(rows + 1) * spacing;
    double early = last_time, late = std::min(time, end());
    if (inflow.way_until(late) < wanted) return late;  // the end of the hydrograph
    for (int bisection = 0; bisection < 50; ++bisection) {
        const double middle = (early + late) / 2;
        (inflow.way_until(middle) < wanted ? early : late) = middle;
    }
    return late;
}

void InflowFeeder::inject(const Model& model, const Ground& ground, State& state) {
    if (state.room() < state.count + remaining()) state.resize(state.count + remaining());
    for (Source& source : sources_) {
        source.prescribe_inflow(ground, state);
        while (source.due(state.time)) {
            const double before = source.last_time;
            source.last_time = source.next_time(state.time);
            const std::uint32_t first = state.count;
            source.add_row(model, ground, state, state.time - source.last_time);
            ++source.rows;
            const double ratio = source.inflow.pore_pressure_ratio_at(source.last_time);
            for (std::uint32_t i = first; i < state.count; ++i) {
                set_entry(model, state, i, source.last_time, ratio, source.inflow.spec.solid_fraction);
            }
            if (!source.inflow.has_density()) continue;
            const double density = source.inflow.density_between(before, source.last_time);
            for (std::uint32_t i = first; i < state.count; ++i) set_density(state, i, density);
        }
    }
    for (AreaSource& area : areas_) area.inject(model, ground, state);
}

void InflowFeeder::Source::prescribe_inflow(const Ground& ground, State& state) {
    if (!leads()) return;
    const double early = inflow.volume_until(state.time - state.time_step), now = inflow.volume_until(state.time);
    if (state.time >= end() || !(now > early)) {  // between surges nothing drives the injected debris
        prescribed = {};
        return;
    }
    const WorldPoint& origin = ground.terrain.frame().origin;
    const double dx = inflow.to.x - inflow.from.x, dy = inflow.to.y - inflow.from.y, width = std::hypot(dx, dy);
    const Vec3<double> level{dy / width, -dx / width, 0};
    const Vec3<double> from{inflow.from.x - origin.x, inflow.from.y - origin.y, 0};
    const double velocity =
        (inflow.way_until(state.time) - inflow.way_until(state.time - state.time_step)) / state.time_step;
    for (std::uint64_t back = 1; back <= std::min(rows, buffer_rows); ++back) {
        const std::uint64_t number = rows - back;
        Row& row = prescribed[number % buffer_rows];
        const double way = way_of(number, state.time);
        if (row.first == row.last) continue;
        if (way > static_cast<double>(buffer_rows) * spacing) {
            row = {};
            continue;
        }
        for (std::uint32_t i = 0; i < state.count; ++i) {
            if (state.id[i] < row.first || state.id[i] >= row.last) continue;
            const LocalPoint p = state.position.at(i), v = state.velocity.at(i);
            const Vec3<double> place{p.x, p.y, p.z};
            const double beyond = dot(place - from, level);
            const Vec3<double> at_line = place - level * beyond;
            const terrain::GroundSample<double> below = ground.terrain.sample(at_line.x, at_line.y);
            Vec3<double> along = level - below.normal * dot(level, below.normal);
            along = along * (1 / length(along));
            const Vec3<double> plan = at_line + along * way;
            const terrain::GroundSample<double> here = ground.terrain.sample(place.x, place.y);
            const terrain::GroundSample<double> there = ground.terrain.sample(plan.x, plan.y);
            // At the height above the ground, normal to it, at which the solver left it.
            const Vec3<double> target =
                Vec3<double>{plan.x, plan.y, there.height} + there.normal * ((place.z - here.height) * here.normal.z);
            const LocalPoint led_to{static_cast<float>(target.x), static_cast<float>(target.y),
                                    static_cast<float>(target.z)};
            if (!ground.solids.empty() && ground.solids.inside(led_to, grain_rank(state.id[i]))) continue;
            const double lacks = velocity - (v.x * along.x + v.y * along.y + v.z * along.z);
            state.position.set(i, led_to);
            state.velocity.set(i, {static_cast<float>(v.x + lacks * along.x), static_cast<float>(v.y + lacks * along.y),
                                   static_cast<float>(v.z + lacks * along.z)});
            state.asleep[i] = 0;
        }
    }
}

/// `since`: s, time since the row passed the line.
void InflowFeeder::Source::add_row(const Model& model, const Ground& ground, State& state, double since) {
    const double in = inflow.volume_until(last_time) / particle_volume;
    const std::uint32_t reached = last_time >= end() ? total : static_cast<std::uint32_t>(std::lround(in));
    const std::uint32_t count = std::min(reached, total) - std::min(injected, reached);
    prescribed[rows % buffer_rows] = {state.seeded, state.seeded + count};
    if (count == 0) return;
    const WorldPoint& origin = ground.terrain.frame().origin;
    const double dx = inflow.to.x - inflow.from.x, dy = inflow.to.y - inflow.from.y, width = std::hypot(dx, dy);
    const auto columns = static_cast<std::uint32_t>(std::max(1L, std::lround(width / spacing)));
    const double column_width = width / columns, layer = spacing * spacing / column_width;
    const double early = inflow.way_until(last_time - 1e-3), late = inflow.way_until(last_time);
    const double velocity = (late - early) / std::min(1e-3, std::max(1e-9, last_time - inflow.hydrograph.front().time));
    double whole = 0;
    // Particles that do not fill a layer are distributed evenly over the columns, to different ones in every row.
    const double shift = std::modf(static_cast<double>(rows) * 0.6180339887498949, &whole);
    const std::uint32_t full = count / columns, odd = count % columns;
    const double previous = state.previous_time_step > 0 ? state.previous_time_step : model.largest_time_step();
    state.previous_time_step = previous;
    for (std::uint32_t c = 0; c < columns; ++c) {
        const double share = static_cast<double>(odd) / columns;
        const bool extra = std::floor((c + 1) * share + shift) > std::floor(c * share + shift);
        const std::uint32_t layers = full + (extra ? 1 : 0);
        const double across = (c + 0.5) / columns;
        const Vec3<double> at_line{inflow.from.x + across * dx - origin.x, inflow.from.y + across * dy - origin.y, 0};
        const terrain::GroundSample<double> below = ground.terrain.sample(at_line.x, at_line.y);
        const Vec3<double> level{dy / width, -dx / width, 0};
        Vec3<double> along = level - below.normal * dot(level, below.normal);
        along = along * (1 / length(along));
        const Vec3<double> plan = at_line + along * (velocity * since);
        const terrain::GroundSample<double> base = ground.terrain.sample(plan.x, plan.y);
        for (std::uint32_t k = 0; k < layers; ++k) {
            const Vec3<double> place = Vec3<double>{plan.x, plan.y, base.height} + base.normal * ((k + 0.5) * layer);
            LocalPoint p{static_cast<float>(place.x), static_cast<float>(place.y), static_cast<float>(place.z)};
            if (!ground.solids.empty()) {
                push_out_of_solids(model, ground, p, grain_rank(state.seeded), [](const LocalPoint&) {});
            }
            const double above = (layers - k - 0.5) * layer;
            add_particle(state, p,
                         {static_cast<float>(along.x * velocity), static_cast<float>(along.y * velocity),
                          static_cast<float>(along.z * velocity)},
                         static_cast<float>(-model.gravity * base.normal.z * above * previous * previous));
            ++injected;
        }
    }
}

}  // namespace talus::sim
