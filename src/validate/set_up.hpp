#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/geometry.hpp"
#include "run/run.hpp"
#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"
#include "terrain/buildings.hpp"
#include "terrain/terrain.hpp"
#include "validate/case.hpp"

/// Small worlds: ground, walls and debris made from numbers.
namespace talus::validate {

/// Ground over a rectangle around the world's origin, `length` along x and `width` along y, with elevations in m from a
/// function of world x and y.
[[nodiscard]] terrain::Terrain make_terrain(double length, double width, double cell,
                                            const std::function<double(double x, double y)>& elevation);

/// A plane that falls towards +x, and coordinates along it, across it and normal to it, m. Their origin is the ground
/// in the middle.
class Incline {
  public:
    /// `slope` in radians; `length` and `width` of the plane in plan.
    Incline(double slope, double length, double width);

    [[nodiscard]] const terrain::Terrain& terrain() const { return terrain_; }
    [[nodiscard]] LocalPoint point(double along, double across, double normal) const;
    /// A vector down the slope.
    [[nodiscard]] LocalPoint down(double speed) const;
    [[nodiscard]] double along(const LocalPoint& p) const;
    [[nodiscard]] double normal(const LocalPoint& p) const;
    [[nodiscard]] double cosine() const { return cosine_; }

  private:
    terrain::Terrain terrain_;
    double sine_, cosine_;
    LocalPoint origin_;
};

/// A wall over a rectangle of world coordinates whose top is at least `height` above the highest ground beside it.
[[nodiscard]] terrain::Building make_wall(const terrain::Terrain& terrain, double x_min, double y_min, double x_max,
                                          double y_max, double height);

/// Two walls along x over the whole ground, `width` apart: the space between is a slice.
[[nodiscard]] std::vector<terrain::Building> make_slice(const terrain::Terrain& terrain, double width, double height);

/// A strip of a gate across a channel, from `from` to `to` m from its middle, that is gone from a time on.
struct GateLeaf {
    double from = 0, to = 0;  ///< m
    double gone = 0;          ///< s since the gate began to open
};

/// A gate of two doors that open evenly from the middle of a channel to its sides, in `opening` s: so many pairs of
/// leaves, in the order in which they go, each when the doors' edges are at its middle. Of an `opening` of 0 all are
/// gone at once.
[[nodiscard]] std::vector<GateLeaf> opening_gate(double width, double opening, int pairs);

/// Particles on the lattice of an incline, its first layer half a spacing above the ground: in every column of [0, n)
/// spacings along and across from (`along`, `across`) as many as the thickness there requires. Remaining particles are
/// distributed evenly over the columns, so that the volume is correct.
[[nodiscard]] std::vector<LocalPoint> fill_lattice(const Incline& incline, double spacing, double along,
                                                   int columns_along, double across, int columns_across,
                                                   const std::function<double(double, double)>& thickness);

/// Particles on a lattice along the world's axes: so many columns behind x = `head` and layers above z = `bottom`, in
/// m, and so many rows on both sides of the x axis.
[[nodiscard]] std::vector<LocalPoint> fill_block(double head, double bottom, int columns, int rows, int layers,
                                                 double spacing);

/// A state at rest of particles at these places, without any release, without pressure.
[[nodiscard]] sim::State state_at_rest(const std::vector<LocalPoint>& points);

/// The same under the weight of the debris above, as after standing behind a gate for long: `thickness` as in
/// fill_lattice. Without it a tall column collapses before its pressure has built up.
[[nodiscard]] sim::State state_under_weight(const sim::Model& model, const sim::Ground& ground,
                                            const std::vector<LocalPoint>& points, const Incline& incline,
                                            const std::function<double(double, double)>& thickness);

/// Of all debris along x, kg m/s.
[[nodiscard]] double momentum_along(const sim::Model& model, const sim::State& state);

enum class OnFault {
    stop,
    note,  ///< continue: for results that are only shown, where a fault is part of the result
};

enum class Observed {
    no,   ///< the state alone; what presses on the side walls of a slice takes a third of a run to record
    yes,  ///< maps and impacts too, in observer()
};

/// A run under test: until a time, or the first step that cannot be trusted.
class Trial {
  public:
    Trial(run::RunStart start, const Watch& watch, OnFault on_fault = OnFault::stop, Observed observed = Observed::no);

    /// As Run::inject_inflow().
    void inject_inflow() { run_.inject_inflow(); }

    /// Steps until `time`, calling `after_step` after each. False when it stopped before: `problem` says why.
    /// A reference to the state stays valid: debris that a device moves is copied before every call and at the end.
    bool advance_to(double time, const std::function<void()>& after_step = {});

    /// Takes away a wall: the building at this place of the ground's.
    void remove_wall(std::size_t building);

    [[nodiscard]] const sim::Model& model() const { return run_.model(); }
    [[nodiscard]] const sim::Ground& ground() const { return run_.ground(); }
    [[nodiscard]] const sim::State& state() const { return run_.state(); }
    /// With Observed::yes; else it has nothing but the start.
    [[nodiscard]] const observe::Observer& observer() const { return run_.observer(); }
    /// The first fault, or the user's request to stop; empty: none.
    [[nodiscard]] const std::string& problem() const { return problem_; }

  private:
    run::Run run_;
    const Watch& watch_;
    OnFault on_fault_;
    bool stopped_ = false;
    std::string problem_;
};

}  // namespace talus::validate
