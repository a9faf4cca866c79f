#include <set>
#include <string>
#include <utility>
#include <vector>

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

/// The lines of a section, each with the name of its barrier.
struct NamedLine {
    std::string name;
    std::vector<PlanPoint> points;
};

std::string name_of(const Scene& scene, std::size_t index) {
    const std::string& name = scene.spec.barriers[index].name;
    return name.empty() ? fmt::format("barrier {}", index + 1) : name;
}

/// A file with several lines gives a barrier each, called after the section and the feature.
Result<std::vector<NamedLine>> read_lines_of(const ParsedScene& parsed, std::size_t index, Scene& scene) {
    const params::BarrierSpec& spec = scene.spec.barriers[index];
    const std::string name = name_of(scene, index);
    if (spec.file.empty()) {
        if (spec.line.size() >= 2) return std::vector{NamedLine{name, spec.line}};
        return Error{fmt::format("{} has {} place; a line needs at least two", parsed.at(path_of(index) + ".line_m"),
                                 spec.line.size())};
    }
    Result<geo::LineLayer> layer = read_lines(spec.file, spec.layer, scene.crs);
    if (!layer) return Error{parsed.at(path_of(index) + ".file") + ": " + layer.error().message};
    const std::string label = fmt::format("barrier \"{}\"", name);
    record_input(label, spec.file, scene);
    if (!layer->reprojection.empty()) scene.notes.push_back(fmt::format("{}: {}", label, layer->reprojection));
    std::vector<geo::LineFeature>& features = layer->features;
    if (features.size() == 1) return std::vector{NamedLine{name, std::move(features.front().points)}};

    std::set<std::string> names;
    for (const geo::LineFeature& feature : features) names.insert(feature.name);
    const bool named = names.size() == features.size() && !names.contains("");
    std::vector<NamedLine> lines;
    std::string list;
    for (std::size_t k = 0; k < features.size(); ++k) {
        lines.push_back({fmt::format("{} {}", name, named ? features[k].name : std::to_string(k + 1)),
                         std::move(features[k].points)});
        list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", lines.back().name);
    }
    scene.notes.push_back(
        fmt::format("{}: {} holds {} lines, a barrier each: {}", label, spec.file, lines.size(), one_line(list)));
    return lines;
}

/// Adds the barrier of a line.
Status add_barrier(const ParsedScene& parsed, std::size_t index, NamedLine line, Scene& scene) {
    const params::BarrierSpec& spec = scene.spec.barriers[index];
    const std::string at = parsed.at(path_of(index) + (spec.file.empty() ? ".line_m" : ".file"));
    params::BarrierSpec shape = spec;
    shape.file.clear();
    shape.layer.clear();
    shape.line = std::move(line.points);
    for (const params::BarrierOpeningSpec& opening : scene.spec.barrier_openings) {
        if (opening.barrier != line.name) continue;
        shape.openings.push_back(opening);
        shape.openings.back().barrier.clear();
    }
    Result<terrain::Building> barrier = make_barrier(scene.terrain, line.name, shape);
    if (!barrier) return Error{at + ": " + barrier.error().message};
    for (const terrain::Release& release : scene.releases) {
        const double area = shared_area(release, *barrier);
        if (area <= 0) continue;
        return Error{
            fmt::format("{}: barrier \"{}\" stands on release \"{}\" with {:.3g} m2: the ground under it "
                        "fails; move the line",
                        at, line.name, release.name, area)};
    }
    scene.buildings.push_back(std::move(*barrier));
    scene.barrier_sections.push_back(index);
    return {};
}

/// Openings refer to barriers by name.
Status check_names(const ParsedScene& parsed, const Scene& scene, std::size_t first) {
    for (std::size_t k = first; k < scene.buildings.size(); ++k) {
        for (std::size_t other = first; other < k; ++other) {
            if (scene.buildings[k].name != scene.buildings[other].name) continue;
            return Error{fmt::format("{} = \"{}\" is the name of another barrier too",
                                     parsed.at(path_of(scene.barrier_sections[k - first]) + ".name"),
                                     scene.buildings[k].name)};
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
        TALUS_ASSIGN(std::vector<NamedLine> lines, read_lines_of(parsed, k, scene));
        for (NamedLine& line : lines) TALUS_TRY(add_barrier(parsed, k, std::move(line), scene));
    }
    return check_names(parsed, scene, first);
}

}  // namespace talus::scene
