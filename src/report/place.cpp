// Places and lengths of a scene in the words of its reports.
#include <algorithm>

#include <fmt/format.h>

#include "core/decimals.hpp"
#include "report/number_text.hpp"
#include "report/results.hpp"

namespace talus::report {

int length_decimals(const scene::Scene& scene, int least) {
    const Extent extent = scene.terrain.elevation().geometry.extent();
    return least + decimals_for(std::max(extent.width(), extent.height()), 0);
}

std::string place(const scene::Scene& scene, const PlanPoint& at) {
    if (!scene.flow_path.empty()) {
        if (const auto on_path = scene.flow_path.locate(at)) {
            return fmt::format("at chainage {}\u00a0m", fixed(on_path->chainage, length_decimals(scene)));
        }
    }
    return fmt::format("at {} E {} N", fixed(at.x, length_decimals(scene)), fixed(at.y, length_decimals(scene)));
}

std::string plural(std::size_t n, std::string_view word) {
    return fmt::format("{} {}{}", n, word, n == 1 ? "" : "s");
}

}  // namespace talus::report
