// How intense the flow was, by the classes of a guideline, and on what area.
#include <fmt/format.h>

#include "report/intensity.hpp"
#include "report/results.hpp"

namespace talus::report {

Json intensity(const scene::Scene& scene, const run::RunResult& result) {
    const IntensityGuideline& guideline = intensity_guideline(scene.spec.outputs.intensity_guideline);
    const Grid<float> map = intensity_map(guideline, result.observation.maps);
    Json rows = table({{"class", "Class", ""},
                       {"name", "Intensity", ""},
                       {"criterion", "Peak depth h, peak speed v", ""},
                       {"area_m2", "Area", "m²", fmt::format("f{}", length_decimals(scene))}});
    for (std::size_t k = guideline.classes.size(); k > 0; --k) {
        double area = 0;
        for (const float value : map.values) {
            if (value == static_cast<float>(k)) area += map.geometry.cell * map.geometry.cell;
        }
        const IntensityClass& c = guideline.classes[k - 1];
        rows["rows"].push_back({{"class", k},
                                {"name", c.name},
                                {"colour", c.colour.hex()},
                                {"criterion", c.criterion},
                                {"area_m2", area}});
    }
    return {{"guideline", guideline.name},
            {"citation", guideline.citation},
            {"remark", guideline.remark},
            {"arrival_depth_m", scene.spec.outputs.arrival_depth},
            {"table", std::move(rows)}};
}

}  // namespace talus::report
