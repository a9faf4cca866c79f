#include "twin/scene_copy.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "core/try.hpp"
#include "params/scene_text.hpp"

namespace talus::twin {
namespace {

std::vector<params::GaugeSpec> gauge_specs(const Setup& setup) {
    std::vector<params::GaugeSpec> specs;
    for (const GaugeSetup& gauge : setup.gauges) {
        params::GaugeSpec& spec = specs.emplace_back();
        spec.name = gauge.body->name;
        if (std::isnan(gauge.body->chainage)) {
            spec.x = gauge.body->at.x;
            spec.y = gauge.body->at.y;
        } else {
            spec.chainage = gauge.body->chainage;
        }
    }
    return specs;
}

}  // namespace

Result<std::string> scene_text_with(const std::filesystem::path& file, const std::vector<std::string>& overrides,
                                    const Setup& setup, const scene::Scene& scene) {
    TALUS_ASSIGN(params::SceneSpec spec, scene::parse_scene(file, overrides));
    spec.gauges = gauge_specs(setup);
    for (const TableKind kind : {TableKind::observation, TableKind::trigger, TableKind::alarm}) {
        put_entries(spec, kind, bodies_of(setup.tables(kind)));
    }
    std::string header =
        "Written by the live twin: the scene with the gauges, observations, triggers and alarms of it.";
    std::erase_if(spec.alarms, [&](const params::AlarmSpec& alarm) {
        const bool known = alarm.structure.empty() ||
                           std::any_of(scene.buildings.begin(), scene.buildings.end(),
                                       [&](const terrain::Building& b) { return b.name == alarm.structure; });
        if (!known) {
            header += fmt::format("\nLeft out: alarm \"{}\", whose structure \"{}\" is not in the scene.", alarm.name,
                                  alarm.structure);
        }
        return !known;
    });
    return params::write_short_scene(spec, header);
}

}  // namespace talus::twin
