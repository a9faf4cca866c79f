#include "scene/particle_spacing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "core/cube_root.hpp"

namespace talus::scene {

double particle_spacing(const Scene& scene) {
    const params::SolverSpec& solver = scene.spec.solver;
    if (solver.particle_spacing) return *solver.particle_spacing;
    if (solver.target_layers) return spacing_of_layers(scene.thinnest.value().thickness, *solver.target_layers);
    return cube_root(total_volume(scene) /
                     solver.target_particle_count.value_or(params::SolverSpec::usual_particle_count));
}

const char* spacing_key(const params::SolverSpec& solver) {
    if (solver.particle_spacing) return "solver.particle_spacing_m";
    return solver.target_layers ? "solver.target_layers" : "solver.target_particle_count";
}

std::optional<ThinnestSource> thinnest_source(const Scene& scene) {
    std::optional<ThinnestSource> thinnest;
    const auto consider = [&](const char* kind, const std::string& name, double thickness) {
        if (!(thickness > 0) || (thinnest && thinnest->thickness <= thickness)) return;
        thinnest = ThinnestSource{fmt::format("{} \"{}\"", kind, name), thickness};
    };
    for (const terrain::Release& release : scene.releases) {
        consider("release", release.name, mean_thickness(scene.terrain, release));
    }
    for (const terrain::Inflow& inflow : scene.inflows) {
        if (!inflow.over_area()) consider("inflow", inflow.name, inflow.mean_thickness());
    }
    return thinnest;
}

double spacing_of_layers(double thickness, double layers) {
    return std::strtod(fmt::format("{:.4g}", thickness / layers).c_str(), nullptr);
}

double most_layers(const Scene& scene, double thickness) {
    return thickness * cube_root(scene.spec.solver.particle_limit / total_volume(scene));
}

Status settle_layers(const ParsedScene& parsed, Scene& scene) {
    const params::SolverSpec& solver = scene.spec.solver;
    if (!solver.target_layers) return {};
    const std::string at = parsed.at("solver.target_layers");
    scene.thinnest = thinnest_source(scene);
    if (!scene.thinnest) {
        return Error{at +
                     ": needs a release or an inflow across a line; the thickness of inflow over an area is not "
                     "known: give solver.particle_spacing_m"};
    }
    const double layers = *solver.target_layers, thickness = scene.thinnest->thickness;
    const double spacing = particle_spacing(scene), particles = total_volume(scene) / std::pow(spacing, 3);
    const std::string over = fmt::format("{} ({:.3g} m thick)", scene.thinnest->name, thickness);
    if (particles > solver.particle_limit) {
        const double most = std::floor(100 * most_layers(scene, thickness)) / 100;
        return Error{
            fmt::format("{} = {:.6g} is refused; over {} it needs {:.3g} particles, more than "
                        "solver.particle_limit = {}; {}",
                        at, layers, over, particles, solver.particle_limit,
                        most >= 1 ? fmt::format("it must be from 1 to {:.6g}", most)
                                  : std::string("raise that, or give solver.particle_spacing_m"))};
    }
    scene.notes.push_back(
        fmt::format("solver.target_layers = {:.6g} over {}: solver.particle_spacing_m = {:.4g}, about {:.0f} particles",
                    layers, over, spacing, particles));
    return {};
}

}  // namespace talus::scene
