#include "observe/debris.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>

#include "observe/device/particles.hpp"
#include "observe/map_accumulator.hpp"
#include "sim/particle_density.hpp"
#include "simd/parallel.hpp"

namespace talus::observe {
namespace {

constexpr std::size_t group = 64;  ///< particles examined together; usually none is relevant

/// As find_on_path(). Debris behind the front is excluded without locating it: it is outside the rectangle around the
/// path beyond, or in a cell of the path's table that does not reach so far.
void find_in_arrays(const sim::State& state, const Extent& beyond, const ChainageBeyond& chainage_beyond,
                    Debris::OnPath& result) {
    if (result.found.size() < state.count) result.found.resize(state.count + state.count / 2);
    const PlanPoint& origin = chainage_beyond.origin;
    const auto x_min = static_cast<float>(beyond.x_min - origin.x), x_max = static_cast<float>(beyond.x_max - origin.x);
    const auto y_min = static_cast<float>(beyond.y_min - origin.y), y_max = static_cast<float>(beyond.y_max - origin.y);
    const auto examine = [&](std::size_t first, std::size_t last) {
        std::array<PathParticle, group> found{};
        std::uint32_t count = 0;
        for (std::size_t i = first; i < last; ++i) {
            if (state.held[i] != 0) continue;
            const float chainage = chainage_beyond.of(state.position.x[i], state.position.y[i]);
            if (chainage < 0) continue;
            found[count++] = {static_cast<std::uint32_t>(i), chainage, length(state.velocity.at(i))};
        }
        if (count == 0) return;
        const std::uint32_t place = std::atomic_ref(result.count).fetch_add(count, std::memory_order_relaxed);
        std::copy_n(found.begin(), count, result.found.begin() + place);
    };
    result.count = 0;
    result.held = simd::reduce_ranges(
        state.count, 4096, std::uint32_t{0},
        [&](std::size_t first, std::size_t last, std::uint32_t held) {
            for (std::size_t begin = first; begin < last; begin += group) {
                const std::size_t end = std::min(last, begin + group);
                unsigned inside = 0, held_here = 0;
                for (std::size_t i = begin; i < end; ++i) {
                    const float x = state.position.x[i], y = state.position.y[i];
                    inside |= static_cast<unsigned>(x >= x_min) & static_cast<unsigned>(x <= x_max) &
                              static_cast<unsigned>(y >= y_min) & static_cast<unsigned>(y <= y_max);
                    held_here += static_cast<unsigned>(state.held[i] != 0);
                }
                held += held_here;
                if (inside != 0) examine(begin, end);
            }
            return held;
        },
        std::plus<>{});
}

}  // namespace

ParticleSums Debris::sums(const sim::Model& model, double deposited_speed) const {
    if (device_ != nullptr) return device_->sums(*summary_, deposited_speed);
    const sim::State& state = *state_;
    const bool own_densities = !state.density_of_id.empty();
    return simd::reduce_ranges(
        state.count, 1024, ParticleSums{},
        [&](std::size_t first, std::size_t last, ParticleSums sum) {
            for (std::size_t i = first; i < last; ++i) {
                const double weight = own_densities ? density_of(model, state, i) / model.rest_density : 1;
                sum.add(state.velocity.at(i), state.position.z[i], state.held[i] != 0, weight, deposited_speed);
            }
            return sum;
        },
        std::plus<>{});
}

void Debris::find_on_path(const terrain::FlowPath& path, const PlanPoint& origin, double from, OnPath& result) const {
    if (device_ != nullptr) return device_->find_on_path(*summary_, path, origin, from, result);
    const Extent beyond = path.extent_beyond(from).grown(0.01);  // for the rounding to float
    find_in_arrays(*state_, beyond, {path.field(), origin, from}, result);
}

void Debris::find_beside_walls(const sim::Model& model, const WallPatches& patches, BesideWalls& result) const {
    if (device_ != nullptr) return device_->find_beside_walls(*summary_, patches, result.found);
    const sim::State& state = *state_;
    std::vector<std::uint8_t>& near = result.near;
    if (near.size() < state.count) near.resize(std::max<std::size_t>(state.count, state.room()));
    simd::parallel_ranges(state.count, 4096, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            near[i] = !patches.near(state.position.x[i], state.position.y[i]).empty() && state.held[i] == 0;
        }
    });
    result.found.clear();
    for (std::uint32_t i = 0; i < state.count; ++i) {
        if (near[i] == 0) continue;
        result.found.push_back({state.position.at(i), state.velocity.at(i), density_of(model, state, i)});
    }
}

void Debris::find_inside(const Extent& extent, bool released, std::vector<PlacedParticle>& found) const {
    const PlanRectangle rectangle{extent.x_min, extent.y_min, extent.x_max, extent.y_max};
    if (device_ != nullptr) return device_->find_inside(*summary_, rectangle, released, found);
    const sim::State& state = *state_;
    found.clear();
    for (std::uint32_t i = 0; i < state.count; ++i) {
        if (!rectangle.contains(state.position.x[i], state.position.y[i])) continue;
        if (released && state.held[i] != 0) continue;
        found.push_back({state.position.at(i), state.id[i], length(state.velocity.at(i))});
    }
}

void Debris::add_to(MapAccumulator& maps) const {
    if (device_ != nullptr) {
        maps.add(device_->maps(), *summary_);
    } else {
        maps.add(*state_);
    }
}

}  // namespace talus::observe
