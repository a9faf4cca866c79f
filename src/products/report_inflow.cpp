// What came in while the run went on.
#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "products/report_plot.hpp"
#include "products/report_sections.hpp"
#include "products/report_text.hpp"

namespace talus::report {
namespace {

double density_of(const InflowSample& row, const Inflow& inflow, const Scene& scene) {
    return inflow.has_density() ? row.density : scene.spec.material.rest_density;
}

std::string way_in(const Inflow& inflow) {
    if (!inflow.over_area()) return "across a line";
    double area = 0;
    for (const Polygon& part : inflow.area) area += plan_area(part);
    return fmt::format("over {} m², {}", fixed(area, 0),
                       inflow.direction
                           ? fmt::format("towards {}° from north", fixed(*inflow.direction * 180 / std::numbers::pi, 0))
                           : "down the slope");
}

std::string volumes_of(const Inflow& inflow, double end) {
    std::string text = fmt::format("{} m³, {} m³ of it by the end of the run", fixed(inflow.volume(), 1),
                                   fixed(inflow.volume_until(end), 1));
    if (inflow.has_density()) {
        const double last = inflow.hydrograph.back().time;
        text += fmt::format("; {} t, {} kg/m³ on average", fixed(inflow.mass_until(last) / 1e3, 1),
                            fixed(inflow.mass_until(last) / inflow.volume(), 0));
    }
    return text;
}

}  // namespace

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
    const bool densities = std::any_of(scene.inflows.begin(), scene.inflows.end(),
                                       [](const Inflow& inflow) { return inflow.has_density(); });
    ValueRange density_range{0, 0};
    for (const Inflow& inflow : scene.inflows) {
        for (const InflowSample& row : inflow.hydrograph) {
            density_range.include(1.08 * density_of(row, inflow, scene));
        }
    }
    discharges.high *= 1.08;
    velocities.high *= 1.08;
    Plot discharge(66, 24, 412, 230, time, discharges), velocity(570, 24, 412, 230, time, velocities),
        density(66, 320, 412, 230, time, density_range);
    discharge.axes("time, s", "discharge, m³/s");
    velocity.axes("time, s", "velocity, m/s");
    density.axes("time, s", "density, kg/m³");
    std::string list;
    for (std::size_t k = 0; k < scene.inflows.size(); ++k) {
        const Inflow& inflow = scene.inflows[k];
        std::vector<double> t, q, v, rho;
        for (const InflowSample& row : inflow.hydrograph) {
            t.push_back(row.time);
            q.push_back(row.discharge);
            v.push_back(row.velocity);
            rho.push_back(density_of(row, inflow, scene));
        }
        const std::string colour = fmt::format("series v{}", k % 8);
        discharge.line(t, q, colour);
        velocity.line(t, v, colour);
        density.line(t, rho, colour);
        list += fmt::format("<li>{}, {}: {}</li>", escape(inflow.name), way_in(inflow),
                            volumes_of(inflow, result.simulated_time));
    }
    const bool lines = std::any_of(scene.inflows.begin(), scene.inflows.end(),
                                   [](const Inflow& inflow) { return !inflow.over_area(); });
    const bool areas = std::any_of(scene.inflows.begin(), scene.inflows.end(),
                                   [](const Inflow& inflow) { return inflow.over_area(); });
    std::string words = "Debris came in while the run went on";
    if (lines) {
        words +=
            ", across a line in rows of particles a spacing apart, at the velocity of the hydrograph and as deep as "
            "its "
            "discharge makes it";
    }
    if (areas) {
        words +=
            ", over an area particle by particle, evenly all over it, on the ground or on top of what lay there, at "
            "the "
            "velocity of the hydrograph";
    }
    words += "; the number of particles is that of the volume, to one of them.";
    if (densities) {
        words +=
            " Particles keep the density with which they came in: forces on structures, pressures and energies follow "
            "from it. Their motion does not depend on it.";
    }
    return fmt::format(
        R"(<section id="inflow">
<h2>Inflow</h2>
<p>{}</p><ul>{}</ul>
<figure>{}
<figcaption><b>Figure {}. Hydrographs.</b> Discharge of bulk debris and velocity{}, as given.</figcaption></figure>
</section>
)",
        words, list,
        figure_svg(1000, densities ? 616 : 320, "Discharge and velocity of the inflows over time",
                   discharge.svg() + velocity.svg() + (densities ? density.svg() : "")),
        figure, densities ? ", and density below" : "");
}

}  // namespace talus::report
