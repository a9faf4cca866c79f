#include "scene/hydrograph.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "geo/vector.hpp"
#include "params/fields.hpp"
#include "scene/load.hpp"

namespace talus::scene {
namespace {

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

Result<std::vector<params::InflowSample>> read_hydrograph(const params::InflowSpec& inflow) {
    const std::string& file = inflow.hydrograph;
    std::ifstream in(file, std::ios::binary);
    std::error_code code;
    if (!in || std::filesystem::is_directory(file, code)) return Error{file + ": no such file, or it cannot be opened"};
    std::string line;
    std::getline(in, line);
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  // spreadsheets write it before UTF-8
    if (line.starts_with(byte_order_mark)) line.erase(0, byte_order_mark.size());
    const std::vector<std::string> header = fields_of(line.substr(0, 1000));
    const params::Section& table = params::live_section("hydrograph");
    std::vector<std::pair<const params::Parameter*, std::size_t>> columns;  // and its position in a line
    for (const params::Parameter& column : table.parameters) {
        const auto found = std::find(header.begin(), header.end(), column.key);
        if (found != header.end() && std::find(found + 1, header.end(), column.key) != header.end()) {
            return Error{fmt::format("{}:1: there are two columns {}; leave one of them out", file, column.key)};
        }
        if (found != header.end()) {
            columns.emplace_back(&column, found - header.begin());
        } else if (column.required) {
            return Error{
                fmt::format("{}:1: there is no column {}; the first line must name time_s, discharge_m3ps and "
                            "velocity_mps, separated by commas",
                            file, column.key)};
        }
    }
    params::SceneSpec read;
    read.inflows.push_back(inflow);
    for (std::size_t number = 2; std::getline(in, line); ++number) {
        if (trimmed(line).empty()) continue;
        const std::size_t row = read.hydrograph.size();
        if (row >= max_rows) return Error{fmt::format("{}: has more than {} rows", file, max_rows)};
        const std::vector<std::string> fields = fields_of(line.substr(0, 1000));
        read.hydrograph.emplace_back();
        for (const auto& [column, place] : columns) {
            const std::string text = place < fields.size() ? fields[place] : "";
            double value = 0;
            if (!read_number(text, value) || !problem_with(*column, value).empty()) {
                return Error{fmt::format("{}:{}: {} = \"{}\" is refused; it must be {}", file, number, column->key,
                                         one_line(text, 40), allowed_text(*column))};
            }
            column->set(read, row, value);
        }
        if (const auto broken = broken_rule(table, read, row, 0)) {
            return Error{fmt::format("{}:{}: {}{}", file, number, broken->key, broken->text)};
        }
    }
    if (read.hydrograph.size() < min_rows) {
        return Error{
            fmt::format("{}: has {} rows of values; it must have at least {}", file, read.hydrograph.size(), min_rows)};
    }
    return std::move(read.hydrograph);
}

Status check_hydrograph(const terrain::Inflow& inflow, const params::SolverSpec& solver, const std::string& at) {
    if (!(inflow.volume() > 0)) return Error{at + ": brings no debris at all"};
    const double start = inflow.hydrograph.front().time;
    if (start >= solver.end_time) {
        return Error{fmt::format("{}: begins at {:.6g} s; that must be below solver.end_time_s = {:.6g}", at, start,
                                 solver.end_time)};
    }
    if (inflow.over_area()) return {};
    const double width = std::hypot(inflow.to.x - inflow.from.x, inflow.to.y - inflow.from.y);
    const double thickest = params::parameter_of("release", "thickness_m").range.high;
    for (const params::InflowSample& row : inflow.hydrograph) {
        const double thickness = row.discharge > 0 ? row.discharge / (row.velocity * width) : 0;
        if (thickness <= thickest) continue;
        return Error{
            fmt::format("{}: at {:.6g} s, {:.4g} m3/s at {:.4g} m/s across {:.4g} m is a flow {:.4g} m thick; "
                        "it must be at most {:.0f} m",
                        at, row.time, row.discharge, row.velocity, width, thickness, thickest)};
    }
    return {};
}

Status check_line(const terrain::Inflow& inflow, const terrain::Terrain& terrain, const std::string& at) {
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

}  // namespace talus::scene
