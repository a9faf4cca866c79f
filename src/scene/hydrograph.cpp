#include "scene/hydrograph.hpp"

#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "geo/vector.hpp"
#include "params/fields.hpp"
#include "scene/load.hpp"

namespace talus {
namespace {

constexpr std::size_t most_rows = 1'000'000;
constexpr std::size_t needed_columns = 3;
constexpr const char* columns[] = {"time_s", "discharge_m3ps", "velocity_mps", "density_kgpm3"};

std::string trimmed(const std::string& text) {
    const std::size_t first = text.find_first_not_of(" \t\r\"");
    if (first == std::string::npos) return "";
    return text.substr(first, text.find_last_not_of(" \t\r\"") - first + 1);
}

std::vector<std::string> fields_of(const std::string& line) {
    std::vector<std::string> fields;
    std::stringstream in(line);
    for (std::string field; std::getline(in, field, ',');) fields.push_back(trimmed(field));
    return fields;
}

bool read_number(const std::string& text, double& value) {
    const char* end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, value);
    return read.ec == std::errc() && read.ptr == end && std::isfinite(value);
}

}  // namespace

std::string problem_with_row(const InflowSample& row, const InflowSample* before, const HydrographKind& kind) {
    const double values[] = {row.time, row.discharge, row.velocity};
    for (std::size_t c = 0; c < needed_columns; ++c) {
        if (std::isfinite(values[c]) && values[c] >= 0) continue;
        return fmt::format("{} = {:.6g} is refused; it must be a number of at least 0", columns[c], values[c]);
    }
    if (kind.has_density) {
        const std::string allowed = problem_with(*find_section("material")->find("rest_density_kgpm3"), row.density);
        if (!allowed.empty()) {
            return fmt::format("density_kgpm3 = {:.6g} is refused; it must be {}", row.density, allowed);
        }
    }
    if (before != nullptr && row.time <= before->time) {
        return fmt::format("time_s = {:.6g} is refused; it must be above that of the row before, {:.6g}", row.time,
                           before->time);
    }
    if (row.discharge > 0 && !(row.velocity > 0) && !kind.may_be_still) {
        return fmt::format("velocity_mps = {:.6g} is refused; it must be above 0 where there is discharge",
                           row.velocity);
    }
    return "";
}

Result<std::vector<InflowSample>> read_hydrograph(const std::string& file, bool may_be_still) {
    std::ifstream in(file, std::ios::binary);
    std::error_code code;
    if (!in || std::filesystem::is_directory(file, code)) return Error{file + ": no such file, or it cannot be opened"};
    std::string line;
    std::getline(in, line);
    const std::vector<std::string> header = fields_of(line.substr(0, 1000));
    std::size_t place[4] = {}, count = 4;
    for (std::size_t c = 0; c < 4; ++c) {
        while (place[c] < header.size() && header[place[c]] != columns[c]) ++place[c];
        if (place[c] < header.size()) continue;
        if (c >= needed_columns) {
            count = needed_columns;
            break;
        }
        return Error{
            fmt::format("{}:1: there is no column {}; the first line must name time_s, discharge_m3ps and "
                        "velocity_mps, separated by commas",
                        file, columns[c])};
    }
    std::vector<InflowSample> rows;
    for (std::size_t number = 2; std::getline(in, line); ++number) {
        if (trimmed(line).empty()) continue;
        if (rows.size() >= most_rows) return Error{fmt::format("{}: has more than {} rows", file, most_rows)};
        const std::vector<std::string> fields = fields_of(line.substr(0, 1000));
        double values[4] = {};
        for (std::size_t c = 0; c < count; ++c) {
            const std::string text = place[c] < fields.size() ? fields[place[c]] : "";
            if (!read_number(text, values[c]) || values[c] < 0) {
                return Error{fmt::format("{}:{}: {} = \"{}\" is refused; it must be a number of at least 0", file,
                                         number, columns[c], one_line(text, 40))};
            }
        }
        const InflowSample row{values[0], values[1], values[2], values[3]};
        const std::string problem =
            problem_with_row(row, rows.empty() ? nullptr : &rows.back(), {may_be_still, count > needed_columns});
        if (!problem.empty()) return Error{fmt::format("{}:{}: {}", file, number, problem)};
        rows.push_back(row);
    }
    if (rows.size() < 2)
        return Error{fmt::format("{}: has {} rows of values; it must have at least 2", file, rows.size())};
    return rows;
}

Status check_line(const Inflow& inflow, const Terrain& terrain, const std::string& at) {
    const double east = inflow.to.x - inflow.from.x, north = inflow.to.y - inflow.from.y;
    if (!(std::hypot(east, north) > 0)) return Error{at + ": both ends of the line are the same place"};
    for (int k = 0; k <= 100; ++k) {
        const PlanPoint p{inflow.from.x + east * k / 100, inflow.from.y + north * k / 100};
        if (!std::isnan(terrain.elevation_at(p))) continue;
        return Error{fmt::format("{}: is not on known ground at {}; the terrain covers {}", at, place_text(p),
                                 extent_text(covered_extent(terrain)))};
    }
    return {};
}

}  // namespace talus
