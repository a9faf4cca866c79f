#include "ensemble/hazard_zones.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace talus::ensemble {
namespace {

constexpr int residual = 1, low = 2, medium = 3, high = 4;

/// The Swiss matrix without or with a row of low intensity.
HazardMatrix swiss_matrix(bool with_low_intensity) {
    HazardMatrix matrix;
    matrix.name = "Swiss hazard matrix";
    matrix.citation =
        "BWW, BRP & BUWAL (1997), Berücksichtigung der Hochwassergefahren bei raumwirksamen Tätigkeiten, Empfehlungen "
        "(Loat & Petrascheck), Biel";
    matrix.remark =
        "Cited from memory. Fields that the recommendation leaves to the process are taken as the more dangerous zone.";
    matrix.periods = {30, 100, 300};
    matrix.zones = {{"residual (yellow-white)", {251, 246, 196}},
                    {"low (yellow)", {245, 220, 70}},
                    {"medium (blue)", {70, 120, 190}},
                    {"high (red)", {200, 30, 40}}};
    if (with_low_intensity) matrix.zone.push_back({medium, low, low, residual});
    matrix.zone.push_back({high, medium, medium, residual});
    matrix.zone.push_back({high, high, high, residual});
    return matrix;
}

}  // namespace

int HazardMatrix::zone_of(std::size_t intensity, double return_period) const {
    const auto period = std::lower_bound(periods.begin(), periods.end(), return_period * (1 - 1e-9)) - periods.begin();
    return zone[intensity][static_cast<std::size_t>(period)];
}

const HazardMatrix* hazard_matrix(params::GuidelineChoice guideline) {
    static const HazardMatrix debris_flow = swiss_matrix(false), flood = swiss_matrix(true);
    switch (guideline) {
        case params::GuidelineChoice::swiss_debris_flow:
            return &debris_flow;
        case params::GuidelineChoice::swiss_flood:
            return &flood;
        case params::GuidelineChoice::garcia_2003:
            break;
    }
    return nullptr;
}

Grid<float> hazard_zones(const HazardMatrix& matrix, const std::vector<Grid<float>>& at_least, double return_period) {
    if (at_least.empty()) return {};
    Grid<float> zones(at_least.front().geometry, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t cell = 0; cell < zones.values.size(); ++cell) {
        int worst = 0;
        for (std::size_t k = 0; k < at_least.size(); ++k) {
            const float share = at_least[k].values[cell];
            if (share > 0) worst = std::max(worst, matrix.zone_of(k, return_period / share));
        }
        if (worst > 0) zones.values[cell] = static_cast<float>(worst);
    }
    return zones;
}

report::HazardMap zone_style(const HazardMatrix& matrix) {
    report::HazardMap style;
    style.file = "hazard_zones";
    style.title = "Hazard zones";
    style.description = "hazard zones, " + matrix.name + ":";
    for (std::size_t k = 0; k < matrix.zones.size(); ++k) {
        style.description += fmt::format("{} {} {}", k == 0 ? "" : ",", k + 1, matrix.zones[k].name);
    }
    style.categories = matrix.zones;
    return style;
}

}  // namespace talus::ensemble
