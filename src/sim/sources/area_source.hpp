#pragma once

#include <cstdint>
#include <vector>

#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"
#include "terrain/inflow.hpp"

namespace talus::sim {

/// Injects debris over an area: a particle for every particle volume of inflow, each at the next of many sites a
/// spacing apart, visited in an order that spreads them evenly over the area. A particle appears on the ground, or on
/// top of debris already there, a spacing away from any other: nothing is injected denser than at rest, so nothing is
/// thrown apart.
class AreaSource {
  public:
    AreaSource(const Model& model, const LocalFrame& frame, terrain::Inflow inflow);

    /// Particles still to be injected.
    [[nodiscard]] std::uint32_t remaining() const { return total_ - injected_; }
    [[nodiscard]] bool due(double time) const;
    /// As in InflowFeeder.
    [[nodiscard]] bool awaits(double time) const { return gauged_ && time < inflow_.hydrograph.back().time; }
    void set_hydrograph(const std::vector<params::InflowSample>& hydrograph);
    /// Injects what is due at the state's time; the state's arrays must have room.
    void inject(const Model& model, const Ground& ground, State& state);

    /// What was injected so far.
    template <class Archive>
    void keep(Archive& archive) {
        archive(injected_, last_time_, site_);
    }

  private:
    struct Top {  ///< of a particle at a place where one may be injected
        LocalPoint place;
        std::int32_t next = -1;  ///< of the same bin; none: below 0
    };

    void place_sites(const LocalFrame& frame);
    void find_tops(const State& state);
    void add_top(const LocalPoint& p);
    [[nodiscard]] std::size_t bin_of(float x, float y) const;
    [[nodiscard]] bool near_sites(float x, float y) const;
    /// The position of the next particle: at a site outside walls, if there is one.
    LocalPoint take_site(const Model& model, const Ground& ground);
    [[nodiscard]] LocalPoint place_at(const Model& model, const Ground& ground, const LocalPoint& site) const;
    [[nodiscard]] LocalPoint velocity_at(const Ground& ground, const LocalPoint& p, double time) const;

    terrain::Inflow inflow_;
    double spacing_ = 0, particle_volume_ = 0;
    std::uint32_t total_ = 0, injected_ = 0;
    bool gauged_ = false;   ///< its hydrograph is that of a gauge
    double last_time_ = 0;  ///< s, of the last injection
    std::vector<LocalPoint> sites_;
    std::size_t site_ = 0, stride_ = 1;  ///< the next site, and the increment to the one after it

    // Debris over the area, by square bins of a spacing or more.
    float bin_ = 0, x_min_ = 0, y_min_ = 0;
    std::int32_t columns_ = 0, rows_ = 0;
    std::vector<std::int32_t> first_;  ///< of each bin, in tops_
    std::vector<Top> tops_;
};

}  // namespace talus::sim
