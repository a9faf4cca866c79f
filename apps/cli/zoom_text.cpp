#include "zoom_text.hpp"

#include <fmt/format.h>

#include "core/try.hpp"
#include "progress.hpp"
#include "run/cost.hpp"
#include "run/zoom.hpp"

namespace talus::cli {

std::string zoom_text(const run::ZoomRecord& zoom) {
    const Extent e = extent_of(zoom.area);
    return fmt::format(
        "{:.0f} x {:.0f} m{}, the event on cells of {:.3g} m: {:.1f} m3 of {:.0f} m3 come in from {:.1f} s on, {:.2f} "
        "m "
        "thick on average, {:.1f} particles of {:.3g} m",
        e.width(), e.height(), zoom.around.empty() ? "" : " around " + zoom.around, zoom.grid_cell, zoom.volumes.in,
        zoom.event_volume, zoom.first_time(), zoom.thickness, zoom.layers(), zoom.particle_spacing);
}

Result<std::string> zoom_cost_text(const scene::Scene& scene, const std::atomic<bool>& stop_requested) {
    run::RunOptions options;
    options.stop_requested = &stop_requested;
    TALUS_ASSIGN(const run::ZoomedScene zoomed, run::zoom_in(scene, options));
    const double spacing = zoomed.record.particle_spacing;
    const auto cost_of_run = [&](const scene::Scene& of) -> Result<run::Cost> {
        TALUS_ASSIGN(const run::Rehearsal rehearsal, run::rehearse(of, spacing, stop_requested));
        return cost_of(of, rehearsal, spacing);
    };
    TALUS_ASSIGN(const run::Cost zoom, cost_of_run(zoomed.scene));
    scene::Scene event = scene;
    event.zoom.reset();
    const Result<run::Cost> whole = cost_of_run(event);
    const std::string instead =
        whole ? fmt::format("the whole event would have {:.0f} and take {}", whole->particles,
                            clock_text(whole->seeding_time + whole->wall_time))
              : fmt::format("the whole event cannot be run with such particles: {}", whole.error().message);
    return fmt::format("zoom        {}\n            {} depth-averaged, then {:.0f} particles, about {}; {}\n",
                       zoom_text(zoomed.record), clock_text(zoomed.record.wall_time), zoom.particles,
                       clock_text(zoom.seeding_time + zoom.wall_time), instead);
}

}  // namespace talus::cli
