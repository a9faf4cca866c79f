#include "twin/intensity.hpp"

#include <fmt/format.h>

namespace talus::twin {
namespace {

constexpr const char* medium = "medium";
constexpr const char* high = "high";

}  // namespace

const char* intensity_class(const observe::BuildingImpact& impact) {
    if (!impact.hit) return nullptr;
    return impact.peak_depth > high_intensity_depth && impact.peak_speed > high_intensity_speed ? high : medium;
}

nlohmann::json intensity_json() {
    const auto class_of = [](const char* name, const char* colour, const char* text) {
        return nlohmann::json{{"name", name}, {"colour", colour}, {"criterion", text}};
    };
    const std::string both =
        fmt::format("depth above {:g} m and speed above {:g} m/s", high_intensity_depth, high_intensity_speed);
    const std::string either =
        fmt::format("depth up to {:g} m or speed up to {:g} m/s", high_intensity_depth, high_intensity_speed);
    return {
        {"classes", {class_of(medium, "#e69f00", either.c_str()), class_of(high, "#b2182b", both.c_str())}},
        {"depth_m", high_intensity_depth},
        {"speed_mps", high_intensity_speed},
        {"rule",
         "Intensity of a debris flow at a building, by the peak depth at its walls and the peak depth-averaged speed "
         "within a map cell of them: high with a " +
             both + ", medium with a " + either + ". A debris flow of low intensity does not exist."},
        {"source",
         "BWW, BRP, BUWAL (1997): Empfehlungen. Berücksichtigung der Hochwassergefahren bei raumwirksamen "
         "Tätigkeiten. Biel and Bern"}};
}

}  // namespace talus::twin
