#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "observe/debris.hpp"
#include "observe/observation.hpp"
#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"
#include "terrain/flow_path.hpp"

namespace talus::observe {

/// Particles that have to lie beyond a position for it to count as reached: 5, or 0.1 % of the released volume if that
/// is more, so that a single stray particle is not a front.
[[nodiscard]] std::uint32_t front_particle_count(const sim::StateSummary& state);

/// Upper limit of the front velocity relative to the fastest debris at the front: on the inside of a bend chainage
/// grows faster than the distance travelled, by half at a third of the bend radius from the path.
inline constexpr double fastest_front = 1.5;

/// When map cells are reached says little about the velocity of a front over less than so many of them.
inline constexpr double resolved_cells = 4;

/// Slope of chainage against arrival time (s; NaN: none) by least squares over the rows [first, last], m/s. The rows
/// are `interval` m of chainage apart. NaN where all arrived at the same time.
[[nodiscard]] double fitted_velocity(std::span<const double> arrival, std::size_t first, std::size_t last,
                                     double interval);

/// When a front reached each chainage, every `interval` m, and how fast debris was there; velocities follow.
///
/// A front has no velocity where its chainage outruns the debris: chainage is a projection, and at a corner of the path
/// it jumps.
struct FrontRecord {
    /// Speeds of the debris at the front, m/s.
    struct Head {
        double mean = never, fastest = never;
    };
    double interval = 1, window = 10;  ///< m of chainage; the window is that of front velocities
    double resolution = 0;             ///< m, length below which arrivals say little about velocity: that of map cells
    std::vector<double> arrival{};     ///< s, by chainage / interval; NaN: not yet
    std::vector<Head> head{};

    [[nodiscard]] std::vector<FrontSample> samples() const;

  private:
    [[nodiscard]] double fastest(std::size_t first, std::size_t last) const;
    /// Whether the front went from the previous chainage to this one faster than the debris there moves: at a corner of
    /// the path, or because other debris entered its corridor. Both are looked at over the resolution.
    [[nodiscard]] bool jumped_to(std::size_t bin) const;
    [[nodiscard]] double velocity_at(std::size_t middle) const;
};

/// The front along the flow path: where it is, when it first reached each chainage and how fast it was there.
///
/// A release covers part of the path when it starts; that is not an arrival.
class FrontTracker {
  public:
    /// `flow_path` may be empty: then there is no front. Intervals and window in m of chainage.
    FrontTracker(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
                 terrain::FlowPath flow_path, double chainage_interval, double velocity_window);

    void after_step(const sim::Ground& ground, const Debris& debris);
    /// Call when the state was changed between two steps.
    void follow(const sim::State& state);
    /// Reserves memory for this number of particles.
    void expect(std::uint32_t particles) { candidates_.found.reserve(particles); }

    [[nodiscard]] const terrain::FlowPath& flow_path() const { return flow_path_; }
    /// Chainage of the front now, m; NaN: none on the path.
    [[nodiscard]] double current() const { return current_; }
    /// Farthest chainage so far, m; NaN: none yet.
    [[nodiscard]] double farthest() const { return farthest_; }
    /// Arrivals by chainage, with velocities.
    [[nodiscard]] std::vector<FrontSample> samples() const { return record_.samples(); }

    /// Of the same flow path.
    template <class Archive>
    void keep(Archive& archive) {
        archive(front_count_, held_, current_, farthest_, candidates_.found, candidates_.held, record_.arrival,
                record_.head);
    }

  private:
    /// Sets current_ and the candidates.
    void find_front(const sim::Ground& ground, const Debris& debris);
    [[nodiscard]] FrontRecord::Head head_behind(double front);

    terrain::FlowPath flow_path_;
    double head_length_ = 0;
    std::size_t front_count_ = 1;
    std::uint32_t held_ = 0;
    double current_ = never, farthest_ = never;
    Debris::OnPath candidates_;  // not far behind the front
    FrontRecord record_;
};

}  // namespace talus::observe
