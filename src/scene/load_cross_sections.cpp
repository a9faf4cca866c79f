#include <cmath>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/vector.hpp"
#include "scene/load.hpp"

namespace talus::scene {
namespace {

/// The lines of a `[[cross_section]]`: one of its own, or all of its file.
Result<std::vector<terrain::CrossSection>> lines_of(const params::CrossSectionSpec& spec, const std::string& name,
                                                    const std::string& at, Scene& scene) {
    if (spec.file.empty()) return std::vector<terrain::CrossSection>{{name, spec.line, spec.interval}};
    const auto layer = read_lines(spec.file, spec.layer, scene.crs);
    if (!layer) return Error{at + ": " + layer.error().message};
    const std::string label = fmt::format("cross-section \"{}\"", name);
    record_input(label, spec.file, scene);
    if (!layer->reprojection.empty()) scene.notes.push_back(label + ": " + layer->reprojection);
    std::vector<terrain::CrossSection> sections;
    for (const geo::LineFeature& line : layer->features) {
        const bool single = layer->features.size() == 1;
        const std::string number = single ? "" : fmt::format(" {}", sections.size() + 1);
        const bool own = !line.name.empty() && (!single || spec.name.empty());
        sections.push_back({own ? line.name : name + number, line.points, spec.interval});
    }
    return sections;
}

Status check_section(const terrain::CrossSection& section, const std::string& at, const Scene& scene) {
    if (section.line.size() < 2) {
        return Error{fmt::format("{}: has {} places; a line needs two or more", at, section.line.size())};
    }
    for (std::size_t k = 0; k < section.line.size(); ++k) {
        const PlanPoint& p = section.line[k];
        if (std::isnan(scene.terrain.elevation_at(p))) {
            return Error{fmt::format("{}: {} is not on the terrain, {}", at, place_text(p),
                                     extent_text(covered_extent(scene.terrain)))};
        }
        if (k > 0 && p.x == section.line[k - 1].x && p.y == section.line[k - 1].y) {
            return Error{fmt::format("{}: has the place {} twice in a row", at, place_text(p))};
        }
    }
    for (const terrain::CrossSection& other : scene.cross_sections) {
        if (other.name != section.name) continue;
        return Error{
            fmt::format("{}: \"{}\" is the name of another cross-section too", at, one_line(section.name, 80))};
    }
    return {};
}

}  // namespace

Status load_cross_sections(const ParsedScene& parsed, Scene& scene) {
    for (std::size_t i = 0; i < scene.spec.cross_sections.size(); ++i) {
        const params::CrossSectionSpec& spec = scene.spec.cross_sections[i];
        const std::string name = spec.name.empty() ? fmt::format("section {}", i + 1) : spec.name;
        const std::string at = parsed.at(fmt::format("cross_section[{}].{}", i, spec.file.empty() ? "line_m" : "file"));
        TALUS_ASSIGN(auto sections, lines_of(spec, name, at, scene));
        for (terrain::CrossSection& section : sections) {
            TALUS_TRY(check_section(section, at, scene));
            scene.cross_sections.push_back(std::move(section));
        }
    }
    return {};
}

}  // namespace talus::scene
