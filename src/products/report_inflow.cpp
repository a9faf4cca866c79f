// What came in across the terrain while the run went on.
#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "products/report_plot.hpp"
#include "products/report_sections.hpp"
#include "products/report_text.hpp"

namespace talus::report {

std::string inflow_section(const Scene& scene, const RunResult& result, int figure) {
    if (scene.inflows.empty()) return "";
    ValueRange time{0, result.simulated_time}, discharges{0, 0}, velocities{0, 0};
    for (const Inflow& inflow : scene.inflows) {
        for (const InflowSample& row : inflow.hydrograph) {
            time.include(row.time);
            discharges.include(row.discharge);
            velocities.include(row.velocity);
        }
    }
    discharges.high *= 1.08;
    velocities.high *= 1.08;
    Plot discharge(66, 24, 412, 230, time, discharges), velocity(570, 24, 412, 230, time, velocities);
    discharge.axes("time, s", "discharge, m³/s");
    velocity.axes("time, s", "velocity, m/s");
    std::string list;
    for (std::size_t k = 0; k < scene.inflows.size(); ++k) {
        const Inflow& inflow = scene.inflows[k];
        std::vector<double> t, q, v;
        for (const InflowSample& row : inflow.hydrograph) {
            t.push_back(row.time);
            q.push_back(row.discharge);
            v.push_back(row.velocity);
        }
        const std::string colour = fmt::format("series v{}", k % 8);
        discharge.line(t, q, colour);
        velocity.line(t, v, colour);
        list += fmt::format("<li>{}: {} m³, {} m³ of it by the end of the run</li>", escape(inflow.name),
                            fixed(inflow.volume(), 1), fixed(inflow.volume_until(result.simulated_time), 1));
    }
    return fmt::format(
        R"(<section id="inflow">
<h2>Inflow</h2>
<p>Debris came in across a line while the run went on, in rows of particles a spacing apart, at the velocity of the
hydrograph and as deep as its discharge makes it; the number of particles is that of the volume, to one of them.</p><ul>{}</ul>
<figure>{}
<figcaption><b>Figure {}. Hydrographs.</b> Discharge of bulk debris at rest density, and velocity, as given.</figcaption></figure>
</section>
)",
        list,
        figure_svg(1000, 320, "Discharge and velocity of the inflows over time", discharge.svg() + velocity.svg()),
        figure);
}

}  // namespace talus::report
