#pragma once

#include <cstdint>
#include <vector>

#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"
#include "terrain/inflow.hpp"

namespace talus {

/// Injects debris all over an area: a particle whenever the volume that came in has grown by its own, each at the next
/// of many sites that lie a spacing apart and take their turns all over the area, so that every part of it gets as
/// much. A particle appears on the ground, or on top of what debris is there, where it is a spacing away from any
/// other: nothing comes in denser than at rest, so nothing pops apart.
class AreaSource {
  public:
    AreaSource(const Model& model, const LocalFrame& frame, Inflow inflow);

    /// Particles that it has yet to bring.
    [[nodiscard]] std::uint32_t to_come() const { return total_ - injected_; }
    [[nodiscard]] bool due(double time) const;
    /// Injects what is due at the state's time; the state's arrays have room.
    void inject(const Model& model, const Ground& ground, State& state);

  private:
    struct Top {  ///< of a particle that lies where one may be let in
        LocalPoint place;
        std::int32_t next = -1;  ///< of the same bin; none: below 0
    };

    void place_sites(const LocalFrame& frame);
    void find_tops(const State& state);
    void add_top(const LocalPoint& p);
    [[nodiscard]] std::size_t bin_of(float x, float y) const;
    [[nodiscard]] bool near_sites(float x, float y) const;
    /// Where the next particle comes to lie: at a site that is not in a wall, if there is one.
    LocalPoint take_site(const Model& model, const Ground& ground);
    [[nodiscard]] LocalPoint place_at(const Model& model, const Ground& ground, const LocalPoint& site) const;
    [[nodiscard]] LocalPoint velocity_at(const Ground& ground, const LocalPoint& p, double time) const;

    Inflow inflow_;
    double spacing_ = 0, particle_volume_ = 0;
    std::uint32_t total_ = 0, injected_ = 0;
    double last_time_ = 0;  ///< s, when it last let some in
    std::vector<LocalPoint> sites_;
    std::size_t site_ = 0, stride_ = 1;  ///< the next site, and how far it is to the one after it

    // Debris over the area, by square bins of a spacing or more.
    float bin_ = 0, x_min_ = 0, y_min_ = 0;
    std::int32_t columns_ = 0, rows_ = 0;
    std::vector<std::int32_t> first_;  ///< of each bin, in tops_
    std::vector<Top> tops_;
};

}  // namespace talus
