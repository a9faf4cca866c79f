#include "sim/sources/entrainment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/cube_root.hpp"
#include "sim/change.hpp"
#include "sim/physics/erosion.hpp"
#include "sim/physics/net.hpp"
#include "sim/relax.hpp"

namespace talus::sim {
namespace {

constexpr float reach_in_spacings = 4;  ///< distance within which a new particle moves others; there by a hundredth of
                                        ///< a spacing
constexpr float sites_apart = 3.5F;     ///< minimum distance between sites of one step, in spacings
constexpr float foot_offset = 1.2F;     ///< maximum distance from the particle below which ground comes loose, in
                                        ///< spacings

/// A direction in plan.
struct Spoke {
    float x = 0, y = 0;
};

/// Particles are not a continuum: with a quarter more room than the new particle's volume, the peak compression is
/// halved; with half more, a gap remains into which debris above falls.
constexpr double room_factor = 1.25;

/// Slower debris entrains nothing: a tenth of the speed of a fall through a particle's own size.
double moving_speed(const Model& model) {
    return 0.1 * std::sqrt(model.gravity * model.particle_spacing);
}

/// A share of a particle, 0 to below 1, by which a cell is ahead of its law, evenly distributed over neighbouring
/// cells: the whole particles from all cells then add up to the volume of the law, however little each cell loses
/// (additive low-discrepancy sequence, Roberts 2018).
double head_start(const GridGeometry& g, std::size_t cell) {
    const auto columns = static_cast<std::size_t>(g.columns);
    const std::size_t column = cell % columns, row = cell / columns;
    double whole = 0;
    return std::modf(static_cast<double>(column) * 0.7548776662466927 + static_cast<double>(row) * 0.5698402909980532,
                     &whole);
}

/// A square bin in plan, as wide as the reach of a new particle.
std::uint64_t bin_of(int column, int row) {
    return std::uint64_t{static_cast<std::uint32_t>(row)} << 32U | static_cast<std::uint32_t>(column);
}

/// Which bins have a site in or beside them; false positives occur, since bins share bits.
class BinSet {
  public:
    void add(std::uint64_t bin) { words_[word(bin)] |= bit(bin); }
    [[nodiscard]] bool may_have(std::uint64_t bin) const { return (words_[word(bin)] & bit(bin)) != 0; }

  private:
    static std::uint64_t mixed(std::uint64_t bin) { return (bin * 0x9E3779B97F4A7C15U) >> 48U; }
    static std::size_t word(std::uint64_t bin) { return mixed(bin) / 64; }
    static std::uint64_t bit(std::uint64_t bin) { return std::uint64_t{1} << mixed(bin) % 64; }
    std::array<std::uint64_t, 1024> words_{};
};

}  // namespace

void Entrainment::find_shear_rates(const Model& model, const Ground& ground, const State& state) {
    const terrain::Bed& bed = ground.bed;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        if (state.held[i] != 0) continue;
        const std::size_t cell = ground.terrain.cell_at(state.position.x[i], state.position.y[i]);
        if (bed.material_at[cell] == 0) continue;
        if (bed.materials[bed.material_at[cell] - 1].law != params::EntrainmentLaw::shear) continue;
        if (count_[cell]++ == 0) touched_.push_back(cell);
    }
    const double area = ground.terrain.cell() * ground.terrain.cell();
    for (const std::size_t cell : touched_) {
        const terrain::BedMaterial& material = bed.materials[bed.material_at[cell] - 1];
        const double depth = count_[cell] * model.particle_volume() / area;
        const double cosine = ground.terrain.slope_cosine_of(cell);
        const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
        const double loose = eroded_by_shear(material, model.rest_density, model.gravity, depth, cosine, sine,
                                             bed.eroded[cell] + loose_[cell] / area, state.time_step);
        rate_[cell] = static_cast<float>(loose * area / count_[cell]);
        count_[cell] = 0;
    }
    touched_.clear();
}

std::size_t Entrainment::find(const Model& model, const Ground& ground, const State& state) {
    const terrain::Bed& bed = ground.bed;
    sites_.clear();
    if (bed.empty()) return 0;
    if (loose_.empty()) {
        loose_.resize(bed.depth.size());
        count_.resize(bed.depth.size());
        rate_.resize(bed.depth.size());
    }
    find_shear_rates(model, ground, state);

    const GridGeometry& g = ground.terrain.elevation().geometry;
    const double volume = model.particle_volume(), area = ground.terrain.cell() * ground.terrain.cell();
    const double slowest = moving_speed(model);
    for (std::uint32_t i = 0; i < state.awake && i < state.count; ++i) {
        if (state.held[i] != 0) continue;
        const LocalPoint v = state.velocity.at(i);
        const double square = dot(v, v);
        if (!(square > slowest * slowest)) continue;
        const LocalPoint p = state.position.at(i);
        const std::size_t cell = ground.terrain.cell_at(p.x, p.y);
        if (bed.material_at[cell] == 0) continue;
        const double ahead = head_start(g, cell);
        if ((bed.eroded[cell] - bed.depth[cell]) * area + volume > ahead * volume) continue;  // nothing remains
        const terrain::BedMaterial& material = bed.materials[bed.material_at[cell] - 1];
        loose_[cell] += material.law == params::EntrainmentLaw::growth
                            ? material.growth_rate * volume * std::sqrt(square) * state.time_step
                            : rate_[cell];
        if (loose_[cell] + ahead * volume < volume || !is_clear(model, ground, p)) continue;
        loose_[cell] -= volume;
        sites_.push_back({i, cell, {p.x, p.y, ground.terrain.sample(p.x, p.y).height}, {}});
    }
    return sites_.size();
}

bool Entrainment::is_clear(const Model& model, const Ground& ground, const LocalPoint& p) const {
    const auto apart = static_cast<float>(sites_apart * model.particle_spacing);
    for (const Site& site : sites_) {
        const float x = site.foot.x - p.x, y = site.foot.y - p.y;
        if (x * x + y * y < apart * apart) return false;
    }
    if (!ground.solids.near(p.x, p.y)) return true;
    const terrain::SolidSample<float> wall = ground.solids.nearest(p);
    return wall.building < 0 || wall.distance > static_cast<float>(model.particle_spacing);
}

void Entrainment::find_neighbours(const Model& model, const State& state) {
    const auto reach = static_cast<float>((reach_in_spacings + foot_offset) * model.particle_spacing);
    const auto bin = [reach](float along) { return static_cast<int>(std::floor(along / reach)); };
    BinSet bins;
    by_bin_.clear();
    for (std::uint32_t s = 0; s < sites_.size(); ++s) {
        const int column = bin(sites_[s].foot.x), row = bin(sites_[s].foot.y);
        by_bin_.emplace_back(bin_of(column, row), s);
        for (int r = row - 1; r <= row + 1; ++r) {
            for (int c = column - 1; c <= column + 1; ++c) bins.add(bin_of(c, r));
        }
    }
    std::sort(by_bin_.begin(), by_bin_.end());
    neighbours_.clear();
    for (std::uint32_t i = 0; i < state.count; ++i) {
        const LocalPoint p = state.position.at(i);
        const int column = bin(p.x), row = bin(p.y);
        if (!bins.may_have(bin_of(column, row)) || state.held[i] != 0) continue;
        for (int r = row - 1; r <= row + 1; ++r) {
            for (int c = column - 1; c <= column + 1; ++c) {
                const std::pair<std::uint64_t, std::uint32_t> first{bin_of(c, r), 0};
                for (auto k = std::lower_bound(by_bin_.begin(), by_bin_.end(), first);
                     k != by_bin_.end() && k->first == first.first; ++k) {
                    const LocalPoint away = p - sites_[k->second].foot;
                    if (dot(away, away) < reach * reach) neighbours_.push_back({k->second, i});
                }
            }
        }
    }
    std::sort(neighbours_.begin(), neighbours_.end());
}

void Entrainment::choose_foot(const Model& model, const Ground& ground, const State& state, std::size_t index) {
    Site& site = sites_[index];
    const auto spacing = static_cast<float>(model.particle_spacing), touching = spacing / 2;
    const LocalPoint above = site.foot;
    float best = -1;
    constexpr int rings = 3;
    constexpr float half = std::numbers::sqrt2_v<float> / 2;
    constexpr std::array<Spoke, 8> spokes = {
        {{1, 0}, {half, half}, {0, 1}, {-half, half}, {-1, 0}, {-half, -half}, {0, -1}, {half, -half}}};
    constexpr int around = spokes.size();
    for (int k = 0; k <= rings * around; ++k) {
        const int ring = (k + around - 1) / around;
        const Spoke& spoke = spokes.at(static_cast<std::size_t>(k % around));
        const float offset = foot_offset * spacing * static_cast<float>(ring) / rings;
        const float x = above.x + offset * spoke.x, y = above.y + offset * spoke.y;
        if (!ground.terrain.covers(x, y)) continue;
        const terrain::GroundSample<float> below = ground.terrain.sample(x, y);
        const LocalPoint foot{x, y, below.height}, place = foot + below.normal * touching;
        float nearest = std::numeric_limits<float>::max();
        for (const Neighbour& neighbour : neighbours_of(index)) {
            const LocalPoint away = state.position.at(neighbour.particle) - place;
            nearest = std::min(nearest, dot(away, away));
        }
        if (nearest <= best) continue;
        best = nearest;
        site.foot = foot;
        site.normal = below.normal;
    }
}

std::span<const Entrainment::Neighbour> Entrainment::neighbours_of(std::size_t site) const {
    const auto s = static_cast<std::uint32_t>(site);
    const auto first = std::lower_bound(neighbours_.begin(), neighbours_.end(), Neighbour{s, 0});
    const auto last = std::lower_bound(first, neighbours_.end(), Neighbour{s + 1, 0});
    const std::span<const Neighbour> all(neighbours_);
    return all.subspan(static_cast<std::size_t>(first - neighbours_.begin()), static_cast<std::size_t>(last - first));
}

void Entrainment::make_room(const Model& model, const Ground& ground, State& state, std::size_t index) const {
    const Site& site = sites_[index];
    const auto spacing = static_cast<float>(model.particle_spacing), reach = reach_in_spacings * spacing;
    const auto room =
        static_cast<float>(room_factor * 3 * model.particle_volume() / (2 * std::numbers::pi));  // radius cubed
    for (const Neighbour& neighbour : neighbours_of(index)) {
        const std::uint32_t i = neighbour.particle;
        LocalPoint p = state.position.at(i);
        const LocalPoint away = p - site.foot;
        const float distance = length(away);
        if (!(distance > 0) || distance > reach) continue;
        p += away * (cube_root(distance * distance * distance + room) / distance - 1);
        if (!ground.terrain.covers(p.x, p.y)) continue;
        push_out_of_solids(model, ground, p, grain_rank(state.id[i]), [](const LocalPoint&) {});
        state.position.set(i, p);
        if (distance > 2 * spacing) continue;
        state.asleep[i] = 0;
        state.still_time[i] = 0;
    }
}

void Entrainment::apply(const Model& model, Ground& ground, State& state) {
    if (sites_.empty()) return;
    const double area = ground.terrain.cell() * ground.terrain.cell(), depth = model.particle_volume() / area;
    find_neighbours(model, state);
    for (std::size_t s = 0; s < sites_.size(); ++s) {
        Site& site = sites_[s];
        ground.erode(site.cell, depth);
        choose_foot(model, ground, state, s);
        make_room(model, ground, state, s);
        const LocalPoint place = site.foot + site.normal * static_cast<float>(model.contact_distance());
        const std::uint32_t i = add_particle(state, place, {}, state.multiplier[site.particle]);
        set_entry(model, state, i, state.time);
        ++state.entrained;
    }
}

}  // namespace talus::sim
