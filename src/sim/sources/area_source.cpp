#include "sim/sources/area_source.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "sim/change.hpp"
#include "sim/relax.hpp"

namespace talus::sim {
namespace {

constexpr double max_sites = 1e6, max_bins = 250e3;
constexpr double max_tries = 2e7;  ///< places examined to find sites

}  // namespace

AreaSource::AreaSource(const Model& model, const LocalFrame& frame, terrain::Inflow inflow)
    : inflow_(std::move(inflow)),
      spacing_(model.particle_spacing),
      particle_volume_(model.particle_volume()),
      total_(static_cast<std::uint32_t>(std::lround(inflow_.volume() / particle_volume_))),
      last_time_(inflow_.hydrograph.front().time) {
    place_sites(frame);
}

/// On a lattice, finer than that of the particles where an area is too small to contain any site of theirs.
void AreaSource::place_sites(const LocalFrame& frame) {
    Extent extent = extent_of(inflow_.area.front());
    double area = 0;
    for (const Polygon& part : inflow_.area) {
        const Extent own = extent_of(part);
        extent.include({own.x_min, own.y_min});
        extent.include({own.x_max, own.y_max});
        area += plan_area(part);
    }
    const double around = extent.width() * extent.height();
    double pitch = std::max({spacing_, std::sqrt(area / max_sites), std::sqrt(around / max_tries)});
    for (; sites_.empty() && around / (pitch * pitch) <= 1.01 * max_tries; pitch /= 2) {
        for (double y = extent.y_min + pitch / 2; y < extent.y_max; y += pitch) {
            for (double x = extent.x_min + pitch / 2; x < extent.x_max; x += pitch) {
                const PlanPoint p{x, y};
                const bool inside = std::any_of(inflow_.area.begin(), inflow_.area.end(),
                                                [&](const Polygon& part) { return contains(part, p); });
                if (inside) sites_.push_back(frame.to_local({x, y, 0}));
            }
        }
    }
    if (sites_.empty()) {  // a sliver
        const PlanPoint corner = inflow_.area.front().outer.front();
        sites_.push_back(frame.to_local({corner.x, corner.y, 0}));
    }
    // Steps of the golden section visit a row of sites evenly, and all of them if the step shares no factor with it.
    stride_ = static_cast<std::size_t>(static_cast<double>(sites_.size()) * 0.6180339887498949);
    while (std::gcd(stride_, sites_.size()) != 1) ++stride_;

    const double wider = std::sqrt(around / max_bins);
    bin_ = static_cast<float>(std::max({spacing_, wider, std::max(extent.width(), extent.height()) / max_bins}));
    const LocalPoint corner = frame.to_local({extent.x_min, extent.y_min, 0});
    x_min_ = corner.x - bin_;
    y_min_ = corner.y - bin_;
    columns_ = static_cast<std::int32_t>(extent.width() / bin_) + 3;
    rows_ = static_cast<std::int32_t>(extent.height() / bin_) + 3;
    first_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
}

void AreaSource::set_hydrograph(const std::vector<params::InflowSample>& hydrograph) {
    inflow_.hydrograph = hydrograph;
    total_ = std::max(static_cast<std::uint32_t>(std::lround(inflow_.volume() / particle_volume_)), injected_);
    gauged_ = true;
}

bool AreaSource::due(double time) const {
    if (injected_ == total_ || time < inflow_.hydrograph.front().time) return false;
    return time >= inflow_.hydrograph.back().time || inflow_.volume_until(time) >= (injected_ + 0.5) * particle_volume_;
}

bool AreaSource::near_sites(float x, float y) const {
    return x >= x_min_ && y >= y_min_ && x < x_min_ + static_cast<float>(columns_) * bin_ &&
           y < y_min_ + static_cast<float>(rows_) * bin_;
}

std::size_t AreaSource::bin_of(float x, float y) const {
    const auto column = std::clamp(static_cast<std::int32_t>((x - x_min_) / bin_), 0, columns_ - 1);
    const auto row = std::clamp(static_cast<std::int32_t>((y - y_min_) / bin_), 0, rows_ - 1);
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
}

void AreaSource::add_top(const LocalPoint& p) {
    std::int32_t& first = first_[bin_of(p.x, p.y)];
    tops_.push_back({p, first});
    first = static_cast<std::int32_t>(tops_.size()) - 1;
}

void AreaSource::find_tops(const State& state) {
    std::fill(first_.begin(), first_.end(), -1);
    tops_.clear();
    tops_.reserve(state.id.size());
    for (std::uint32_t i = 0; i < state.count; ++i) {
        if (near_sites(state.position.x[i], state.position.y[i])) add_top(state.position.at(i));
    }
}

LocalPoint AreaSource::place_at(const Model& model, const Ground& ground, const LocalPoint& site) const {
    const terrain::GroundSample<double> below =
        ground.terrain.sample(static_cast<double>(site.x), static_cast<double>(site.y));
    double z = below.height + model.contact_distance() / below.normal.z;
    const auto spacing = static_cast<float>(spacing_);
    for (const float y : {site.y - bin_, site.y, site.y + bin_}) {
        for (const float x : {site.x - bin_, site.x, site.x + bin_}) {
            if (!near_sites(x, y)) continue;
            for (std::int32_t k = first_[bin_of(x, y)]; k >= 0; k = tops_[static_cast<std::size_t>(k)].next) {
                const LocalPoint& p = tops_[static_cast<std::size_t>(k)].place;
                const float dx = p.x - site.x, dy = p.y - site.y, room = spacing * spacing - dx * dx - dy * dy;
                if (room > 0) z = std::max(z, static_cast<double>(p.z) + std::sqrt(static_cast<double>(room)));
            }
        }
    }
    return {site.x, site.y, static_cast<float>(z)};
}

LocalPoint AreaSource::take_site(const Model& model, const Ground& ground) {
    LocalPoint place;
    for (std::size_t tries = 0; tries < sites_.size(); ++tries) {
        place = place_at(model, ground, sites_[site_]);
        site_ = (site_ + stride_) % sites_.size();
        if (ground.solids.empty() || !ground.solids.inside(place)) return place;
    }
    push_out_of_solids(model, ground, place, terrain::largest_grain, [](const LocalPoint&) {});
    return place;
}

LocalPoint AreaSource::velocity_at(const Ground& ground, const LocalPoint& p, double time) const {
    const Vec3<double> normal = ground.terrain.sample(static_cast<double>(p.x), static_cast<double>(p.y)).normal;
    Vec3<double> level{normal.x, normal.y, 0};
    if (inflow_.spec.direction) {
        const double azimuth = *inflow_.spec.direction * std::numbers::pi / 180;
        level = {std::sin(azimuth), std::cos(azimuth), 0};
    }
    Vec3<double> along = level - normal * dot(level, normal);
    const double size = length(along);
    if (!(size > 1e-6)) return {};  // level ground has no downhill direction
    along = along * (inflow_.velocity_at(time) / size);
    return {static_cast<float>(along.x), static_cast<float>(along.y), static_cast<float>(along.z)};
}

void AreaSource::inject(const Model& model, const Ground& ground, State& state) {
    if (!due(state.time)) return;
    find_tops(state);
    const double density = inflow_.has_density() ? inflow_.density_between(last_time_, state.time) : 0;
    while (due(state.time)) {
        const LocalPoint place = take_site(model, ground);
        const std::uint32_t i = add_particle(state, place, velocity_at(ground, place, state.time), 0);
        if (density > 0) set_density(state, i, density);
        set_entry(model, state, i, state.time, inflow_.pore_pressure_ratio_at(state.time), inflow_.spec.solid_fraction);
        if (near_sites(place.x, place.y)) add_top(place);
        ++injected_;
    }
    last_time_ = state.time;
}

}  // namespace talus::sim
