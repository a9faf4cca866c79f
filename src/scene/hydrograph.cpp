#include "scene/hydrograph.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "core/csv_table.hpp"
#include "core/quantity.hpp"
#include "core/try.hpp"
#include "params/fields.hpp"
#include "scene/load.hpp"

namespace talus::scene {

Result<std::vector<params::InflowSample>> read_hydrograph(const params::InflowSpec& inflow) {
    const std::string& file = inflow.hydrograph;
    TALUS_ASSIGN(CsvTable csv, read_csv_table(file, max_rows));
    const std::vector<std::string>& header = csv.columns;
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
                            "velocity_mps, separated by commas, semicolons or tabs",
                            file, column.key)};
        }
    }
    params::SceneSpec read;
    read.inflows.push_back(inflow);
    for (const CsvRow& line : csv.rows) {
        const std::size_t row = read.hydrograph.size();
        read.hydrograph.emplace_back();
        for (const auto& [column, place] : columns) {
            const std::string& text = line.fields[place];
            const Result<double> value = read_quantity(text, Dimension::none, csv.comma);
            if (!value || !problem_with(*column, *value).empty()) {
                const std::string why = value || text.empty() ? "" : ", because " + value.error().message;
                return Error{fmt::format("{}:{}: {} = \"{}\" is refused{}; it must be {}", file, line.line, column->key,
                                         one_line(text, 40), why, allowed_text(*column))};
            }
            column->set(read, row, *value);
        }
        if (const auto broken = broken_rule(table, read, row, 0)) {
            return Error{fmt::format("{}:{}: {}{}", file, line.line, broken->key, broken->text)};
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
