#include <cmath>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/vector.hpp"
#include "scene/load.hpp"
#include "scene/particle_spacing.hpp"
#include "terrain/barrier.hpp"

namespace talus::scene {
namespace {

std::string path_of(std::size_t index) {
    return fmt::format("barrier[{}]", index);
}

Status read_line_of(const ParsedScene& parsed, std::size_t index, Scene& scene, const std::string& name,
                    std::vector<PlanPoint>& line) {
    const params::BarrierSpec& spec = scene.spec.barriers[index];
    line = spec.line;
    if (spec.file.empty()) {
        if (line.size() >= 2) return {};
        return Error{fmt::format("{} has {} place; a line needs at least two", parsed.at(path_of(index) + ".line_m"),
                                 line.size())};
    }
    auto layer = read_line(spec.file, spec.layer, scene.crs);
    if (!layer) return Error{parsed.at(path_of(index) + ".file") + ": " + layer.error().message};
    record_input(fmt::format("barrier \"{}\"", name), spec.file, scene);
    if (!layer->reprojection.empty()) {
        scene.notes.push_back(fmt::format("barrier \"{}\": {}", name, layer->reprojection));
    }
    line = std::move(layer->points);
    return {};
}

/// Openings refer to barriers by name.
Status check_names(const ParsedScene& parsed, const Scene& scene, std::size_t first) {
    for (std::size_t k = first; k < scene.buildings.size(); ++k) {
        for (std::size_t other = first; other < k; ++other) {
            if (scene.buildings[k].name != scene.buildings[other].name) continue;
            return Error{fmt::format("{} = \"{}\" is the name of another barrier too",
                                     parsed.at(path_of(k - first) + ".name"), scene.buildings[k].name)};
        }
    }
    const std::vector<params::BarrierOpeningSpec>& openings = scene.spec.barrier_openings;
    for (std::size_t k = 0; k < openings.size(); ++k) {
        std::string names;
        bool found = false;
        for (std::size_t b = first; b < scene.buildings.size(); ++b) {
            found = found || scene.buildings[b].name == openings[k].barrier;
            names += (names.empty() ? "\"" : ", \"") + scene.buildings[b].name + "\"";
        }
        if (found) continue;
        return Error{fmt::format("{} = \"{}\": there is no such barrier; barriers: {}",
                                 parsed.at(fmt::format("barrier_opening[{}].barrier", k)), openings[k].barrier,
                                 names.empty() ? "none" : names)};
    }
    return {};
}

}  // namespace

Status load_barriers(const ParsedScene& parsed, Scene& scene) {
    TALUS_TRY(check_rules(parsed, particle_spacing(scene)));
    const std::size_t first = scene.buildings.size();
    for (std::size_t k = 0; k < scene.spec.barriers.size(); ++k) {
        const params::BarrierSpec& spec = scene.spec.barriers[k];
        const std::string path = path_of(k);
        const std::string name = spec.name.empty() ? fmt::format("barrier {}", k + 1) : spec.name;
        params::BarrierSpec shape = spec;
        shape.file.clear();
        shape.layer.clear();
        TALUS_TRY(read_line_of(parsed, k, scene, name, shape.line));
        for (const params::BarrierOpeningSpec& opening : scene.spec.barrier_openings) {
            if (opening.barrier != name) continue;
            shape.openings.push_back(opening);
            shape.openings.back().barrier.clear();
        }
        Result<terrain::Building> barrier = make_barrier(scene.terrain, name, shape);
        if (!barrier) {
            return Error{parsed.at(path + (spec.file.empty() ? ".line_m" : ".file")) + ": " + barrier.error().message};
        }
        for (const terrain::Release& release : scene.releases) {
            const double area = shared_area(release, *barrier);
            if (area <= 0) continue;
            return Error{
                fmt::format("{}: barrier \"{}\" stands on release \"{}\" with {:.3g} m2: the ground under it "
                            "fails; move the line",
                            parsed.at(path + (spec.file.empty() ? ".line_m" : ".file")), name, release.name, area)};
        }
        scene.buildings.push_back(std::move(*barrier));
    }
    return check_names(parsed, scene, first);
}

}  // namespace talus::scene
