#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "geo/vector.hpp"
#include "scene/load.hpp"

namespace talus {
namespace {

constexpr std::size_t most_rows = 1'000'000;
constexpr const char* columns[] = {"time_s", "discharge_m3ps", "velocity_mps"};

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

/// Errors name file, line, column and what is allowed.
Result<std::vector<InflowSample>> read_hydrograph(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    std::error_code code;
    if (!in || std::filesystem::is_directory(file, code)) return Error{file + ": no such file, or it cannot be opened"};
    std::string line;
    std::getline(in, line);
    const std::vector<std::string> header = fields_of(line.substr(0, 1000));
    std::size_t place[3] = {};
    for (std::size_t c = 0; c < 3; ++c) {
        while (place[c] < header.size() && header[place[c]] != columns[c]) ++place[c];
        if (place[c] == header.size()) {
            return Error{
                fmt::format("{}:1: there is no column {}; the first line must name time_s, discharge_m3ps and "
                            "velocity_mps, separated by commas",
                            file, columns[c])};
        }
    }
    std::vector<InflowSample> rows;
    for (std::size_t number = 2; std::getline(in, line); ++number) {
        if (trimmed(line).empty()) continue;
        if (rows.size() >= most_rows) return Error{fmt::format("{}: has more than {} rows", file, most_rows)};
        const std::vector<std::string> fields = fields_of(line.substr(0, 1000));
        double values[3] = {};
        for (std::size_t c = 0; c < 3; ++c) {
            const std::string text = place[c] < fields.size() ? fields[place[c]] : "";
            if (!read_number(text, values[c]) || values[c] < 0) {
                return Error{fmt::format("{}:{}: {} = \"{}\" is refused; it must be a number of at least 0", file,
                                         number, columns[c], one_line(text, 40))};
            }
        }
        if (!rows.empty() && values[0] <= rows.back().time) {
            return Error{
                fmt::format("{}:{}: time_s = {:.6g} is refused; it must be above that of the row before, {:.6g}", file,
                            number, values[0], rows.back().time)};
        }
        if (values[1] > 0 && !(values[2] > 0)) {
            return Error{
                fmt::format("{}:{}: velocity_mps = {:.6g} is refused; it must be above 0 where there is discharge",
                            file, number, values[2])};
        }
        rows.push_back({values[0], values[1], values[2]});
    }
    if (rows.size() < 2)
        return Error{fmt::format("{}: has {} rows of values; it must have at least 2", file, rows.size())};
    return rows;
}

Result<Inflow> load_inflow(const ParsedScene& parsed, std::size_t index, Scene& scene) {
    const InflowSpec& spec = scene.spec.inflows[index];
    const std::string path = fmt::format("inflow[{}].", index);
    Inflow inflow;
    inflow.name = spec.name.empty() ? fmt::format("inflow {}", index + 1) : spec.name;
    const std::string label = fmt::format("inflow \"{}\"", inflow.name);
    if (spec.line.empty() == spec.file.empty()) {
        return Error{fmt::format("{}: exactly one of line_m and file must be given; {}",
                                 parsed.at(path + (spec.line.empty() ? "line_m" : "file")),
                                 spec.line.empty() ? "there is none" : "both are")};
    }
    std::vector<PlanPoint> line = spec.line;
    if (!spec.file.empty()) {
        auto layer = read_line(spec.file, spec.layer, scene.crs);
        if (!layer) return Error{parsed.at(path + "file") + ": " + layer.error().message};
        record_input(label, spec.file, scene);
        if (!layer->reprojection.empty()) scene.notes.push_back(label + ": " + layer->reprojection);
        line = std::move(layer->points);
    }
    const std::string at = parsed.at(path + (spec.file.empty() ? "line_m" : "file"));
    if (line.size() != 2) {
        return Error{fmt::format("{}: has {} places; an inflow's line is straight, with exactly two", at, line.size())};
    }
    inflow.from = line[0];
    inflow.to = line[1];
    const double width = std::hypot(inflow.to.x - inflow.from.x, inflow.to.y - inflow.from.y);
    if (!(width > 0)) return Error{at + ": both ends of the line are the same place"};
    for (int k = 0; k <= 100; ++k) {
        const PlanPoint p{inflow.from.x + (inflow.to.x - inflow.from.x) * k / 100,
                          inflow.from.y + (inflow.to.y - inflow.from.y) * k / 100};
        if (!std::isnan(scene.terrain.elevation_at(p))) continue;
        return Error{fmt::format("{}: is not on known ground at {}; the terrain covers {}", at, place_text(p),
                                 extent_text(covered_extent(scene.terrain)))};
    }
    Result<std::vector<InflowSample>> rows = read_hydrograph(spec.hydrograph);
    if (!rows) return Error{parsed.at(path + "hydrograph") + ": " + rows.error().message};
    record_input(label + " hydrograph", spec.hydrograph, scene);
    inflow.hydrograph = std::move(*rows);
    if (!(inflow.volume() > 0)) return Error{parsed.at(path + "hydrograph") + ": brings no debris at all"};
    const PlanPoint middle{(inflow.from.x + inflow.to.x) / 2, (inflow.from.y + inflow.to.y) / 2};
    const double cell = scene.terrain.cell();
    const PlanPoint ahead{middle.x + (inflow.to.y - inflow.from.y) / width * cell,
                          middle.y - (inflow.to.x - inflow.from.x) / width * cell};
    const double rise = (scene.terrain.elevation_at(ahead) - scene.terrain.elevation_at(middle)) / cell;
    scene.notes.push_back(fmt::format("{}: {:.6g} m3 across {:.4g} m, where the ground {} by {:.2g} in its direction{}",
                                      label, inflow.volume(), width, rise > 0 ? "rises" : "falls", std::abs(rise),
                                      rise > 0.05 ? "; turn the line if it should come from the other side" : ""));
    return Result<Inflow>(std::move(inflow));
}

}  // namespace

Status load_inflows(const ParsedScene& parsed, Scene& scene) {
    for (std::size_t index = 0; index < scene.spec.inflows.size(); ++index) {
        Result<Inflow> inflow = load_inflow(parsed, index, scene);
        if (!inflow) return inflow.error();
        if (inflow->hydrograph.front().time >= scene.spec.solver.end_time) {
            return Error{fmt::format("{}: begins at {:.6g} s; that must be below solver.end_time_s = {:.6g}",
                                     parsed.at(fmt::format("inflow[{}].hydrograph", index)),
                                     inflow->hydrograph.front().time, scene.spec.solver.end_time)};
        }
        scene.inflows.push_back(std::move(*inflow));
    }
    return {};
}

}  // namespace talus
