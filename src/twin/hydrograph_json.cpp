#include "twin/hydrograph_json.hpp"

#include <cmath>
#include <cstddef>
#include <limits>

#include <fmt/format.h>

#include "scene/hydrograph.hpp"
#include "twin/json_keys.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

constexpr std::size_t most_rows = 1'000'000;

double number_of(const json& row, const char* key) {
    const auto found = row.find(key);
    return found != row.end() && found->is_number() ? found->get<double>() : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

json to_json(const std::vector<InflowSample>& hydrograph) {
    json rows = json::array();
    for (const InflowSample& row : hydrograph) {
        rows.push_back({{"time_s", row.time},
                        {"discharge_m3ps", row.discharge},
                        {"velocity_mps", row.velocity},
                        {"density_kgpm3", row.density > 0 ? json(row.density) : json()}});
    }
    return rows;
}

Result<std::vector<InflowSample>> read_hydrograph_rows(const json& list, bool may_be_still) {
    if (!list.is_array() || list.size() < 2 || list.size() > most_rows) {
        return Error{fmt::format("hydrograph = {}: must be a list of 2 rows or more", shown(list))};
    }
    std::vector<InflowSample> rows;
    bool has_density = false;
    for (std::size_t k = 0; k < list.size(); ++k) {
        const json& entry = list[k];
        if (!entry.is_object()) {
            return Error{
                fmt::format("hydrograph[{}] = {}: must be an object with time_s, discharge_m3ps and "
                            "velocity_mps",
                            k, shown(entry))};
        }
        if (Status s = check_keys(entry, {"time_s", "discharge_m3ps", "velocity_mps", "density_kgpm3"}); !s) {
            return Error{fmt::format("hydrograph[{}]: {}", k, s.error().message)};
        }
        const bool given = entry.contains("density_kgpm3") && !entry["density_kgpm3"].is_null();
        if (k == 0) has_density = given;
        if (given != has_density) {
            return Error{fmt::format("hydrograph[{}]: density_kgpm3 must be in every row or in none", k)};
        }
        const InflowSample row{number_of(entry, "time_s"), number_of(entry, "discharge_m3ps"),
                               number_of(entry, "velocity_mps"), given ? number_of(entry, "density_kgpm3") : 0};
        const std::string problem =
            problem_with_row(row, rows.empty() ? nullptr : &rows.back(), {may_be_still, has_density});
        if (!problem.empty()) return Error{fmt::format("hydrograph[{}]: {}", k, problem)};
        rows.push_back(row);
    }
    return rows;
}

}  // namespace talus::twin
