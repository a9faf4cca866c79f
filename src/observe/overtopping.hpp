#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/geometry.hpp"
#include "observe/barrier_line.hpp"
#include "observe/debris.hpp"
#include "observe/observation.hpp"
#include "observe/retention.hpp"
#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"

namespace talus::observe {

/// Volume of debris that passes a barrier: particles that cross its line between two steps, less those that return,
/// each counted once: over the crest, or below it through an opening or the meshes of a net. Debris that flows around
/// its ends does not count. Only debris in a rectangle around the line is examined.
class Overtopping {
  public:
    /// `deposited_speed`: slower debris is at rest, m/s.
    Overtopping(const sim::Model& model, const terrain::Terrain& terrain, const params::BarrierSpec& shape,
                double deposited_speed);

    /// Reserves memory for the particles, so that no step has to.
    void follow(const sim::State& state) { tracks_.resize(std::max<std::size_t>(tracks_.size(), state.seeded)); }
    void expect(std::uint32_t particles) { tracks_.reserve(particles); }
    /// `jumped`: particles may have been moved since the last call; nothing counts as a crossing.
    void after_step(const Debris& debris, bool jumped = false);

    [[nodiscard]] double volume() const { return beyond(over_); }            ///< m3, over the crest
    [[nodiscard]] double passed_volume() const { return beyond(through_); }  ///< m3, through openings and meshes
    [[nodiscard]] double first_time() const { return first_time_; }          ///< s, over the crest; NaN: never

    /// Debris upstream of a barrier: on the side from which it has crossed, or where there is more of it.
    struct Filling {
        double volume = 0;  ///< m3, see retained()
        double height = 0;  ///< m, the mean depth of the deepest of the sections, four spacings square, along the face
    };
    [[nodiscard]] Filling filling(const Debris& debris) const;

    /// The crossings of the same line so far.
    template <class Archive>
    void keep(Archive& archive) {
        archive(tracks_, over_, through_, first_time_, calls_);
    }

  private:
    struct Point {
        float x, y;
    };
    struct Side {
        std::int64_t to_right = 0, to_left = 0;  // particles
    };
    struct Track {
        Point last{};
        std::uint64_t step = 0;  ///< one more than the call of the last position; 0: none
        std::int8_t net = 0;     ///< crossings from left to right less those back
        bool through = false;    ///< an opening or a mesh
    };
    [[nodiscard]] std::vector<DebrisColumn> columns_of(const std::vector<PlacedParticle>& particles, int side) const;
    [[nodiscard]] bool in_mesh(std::uint32_t id, double chainage, double z) const;
    [[nodiscard]] double beyond(const Side& counted) const;

    BarrierLine line_;
    float passing_share_ = 0;    // of a net
    std::vector<double> crest_;  // of a net, local z, by metres along the line
    Extent near_;                // local
    double particle_volume_ = 0, section_ = 0, deposited_speed_ = 0;
    std::vector<Track> tracks_;  // by particle id
    std::vector<PlacedParticle> inside_;
    Side over_, through_;
    double first_time_ = never;
    std::uint64_t calls_ = 0;
};

}  // namespace talus::observe
