#include "bench/table.hpp"

#include <algorithm>
#include <array>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace talus::bench {
namespace {

using Json = nlohmann::ordered_json;
using Line = std::vector<std::string>;

/// Columns as wide as their widest entry, the first `left` of them with their text on the left.
std::string aligned(const std::vector<Line>& lines, std::size_t left) {
    std::vector<std::size_t> width(lines.front().size());
    for (const Line& line : lines) {
        for (std::size_t i = 0; i < line.size(); ++i) width[i] = std::max(width[i], line[i].size());
    }
    std::string text;
    for (const Line& line : lines) {
        for (std::size_t i = 0; i < line.size(); ++i) {
            const std::string gap = i == 0 ? "" : "  ";
            text +=
                gap + (i < left ? fmt::format("{:<{}}", line[i], width[i]) : fmt::format("{:>{}}", line[i], width[i]));
        }
        text += "\n";
    }
    return text;
}

std::string hash_text(const Row& row) {
    return fmt::format("{:016x}", row.hash);
}

Line name_cells(const Row& row) {
    return {row.scene, row.method, fmt::format("{}", row.particles), fmt::format("{}", row.threads)};
}

std::string rates_text(const std::vector<Row>& rows) {
    std::vector<Line> lines = {{"scene", "method", "particles", "threads", "ms/step", "ns/p-it", "Mp-it/s", "steps/s",
                                "x real time", "neighbours", "B/particle", "relative", "hash"}};
    for (const Row& row : rows) {
        Line line = name_cells(row);
        for (std::string& cell :
             Line{fmt::format("{:.2f}", 1e3 * row.step_seconds),
                  fmt::format("{:.1f}", 1e9 / row.particle_iterations_per_second()),
                  fmt::format("{:.2f}", 1e-6 * row.particle_iterations_per_second()),
                  fmt::format("{:.4g}", row.steps_per_second()), fmt::format("{:.3g}", row.real_time_factor()),
                  fmt::format("{:.1f}", row.neighbours),
                  row.bytes_per_particle > 0 ? fmt::format("{:.0f}", row.bytes_per_particle) : "-",
                  fmt::format("{:.4f}", row.relative_rate), hash_text(row)}) {
            line.push_back(std::move(cell));
        }
        lines.push_back(std::move(line));
    }
    return aligned(lines, 2);
}

std::string shares_text(const std::vector<Row>& rows) {
    std::vector<Line> lines = {{"scene", "method", "particles", "threads"}};
    for (const Row& row : rows) lines.push_back(name_cells(row));
    for (std::size_t stage = 0; stage < sim::stage_count; ++stage) {
        const auto share = [stage](const Row& row) { return 100 * row.stage_seconds[stage] / row.step_seconds; };
        if (std::none_of(rows.begin(), rows.end(), [&](const Row& row) { return share(row) >= 0.05; })) continue;
        lines[0].emplace_back(sim::step_stages[stage].short_name);
        for (std::size_t row = 0; row < rows.size(); ++row) {
            lines[row + 1].push_back(fmt::format("{:.1f}", share(rows[row])));
        }
    }
    return aligned(lines, 2);
}

/// The values that rows have, each once: "4", "AVX2, SSE4".
template <class Get>
std::string distinct(const std::vector<Row>& rows, const Get& get) {
    std::set<std::string> values;
    for (const Row& row : rows) values.insert(fmt::format("{}", get(row)));
    return fmt::format("{}", fmt::join(values, ", "));
}

Json row_json(const Row& row) {
    Json stages = Json::object();
    for (std::size_t stage = 0; stage < sim::stage_count; ++stage) {
        stages[std::string(sim::step_stages[stage].name)] = 1e3 * row.stage_seconds[stage];
    }
    return {
        {"scene", row.scene},
        {"method", row.method},
        {"particles", row.particles},
        {"iterations", row.iterations},
        {"mean_iterations", row.mean_iterations},
        {"threads", row.threads},
        {"backend", row.backend},
        {"instruction_set", row.instruction_set},
        {"warm_up_steps", row.warm_up},
        {"steps", row.steps},
        {"repeats", row.repeats},
        {"time_step", row.fixed_time_step ? "fixed" : "adaptive"},
        {"time_step_s", row.time_step},
        {"step_ms", 1e3 * row.step_seconds},
        {"stages_ms", std::move(stages)},
        {"ns_per_particle_iteration", 1e9 / row.particle_iterations_per_second()},
        {"particle_iterations_per_second", row.particle_iterations_per_second()},
        {"steps_per_second", row.steps_per_second()},
        {"real_time_factor", row.real_time_factor()},
        {"neighbours_per_particle", row.neighbours},
        {"bytes_per_particle", row.bytes_per_particle > 0 ? Json(row.bytes_per_particle) : Json()},
        {"calibration_units_per_second", row.calibration_rate},
        {"relative_rate", row.relative_rate},
        {"hash", hash_text(row)},
    };
}

}  // namespace

std::string table_text(const std::vector<Row>& rows) {
    if (rows.empty()) return "nothing was measured\n";
    return fmt::format(
        "backend {}, {}; iterations {}; time step {}; medians of {} repeats\n\n{}\n"
        "share of each stage in a step, %; stages below 0.05 % are omitted\n{}",
        distinct(rows, [](const Row& r) { return r.backend; }),
        distinct(rows, [](const Row& r) { return r.instruction_set; }),
        distinct(rows, [](const Row& r) { return r.iterations; }),
        distinct(rows, [](const Row& r) { return r.fixed_time_step ? "fixed" : "adaptive"; }),
        distinct(rows, [](const Row& r) { return r.repeats; }), rates_text(rows), shares_text(rows));
}

std::string table_json(const std::vector<Row>& rows) {
    Json list = Json::array();
    for (const Row& row : rows) list.push_back(row_json(row));
    return list.dump(2) + "\n";
}

std::string rows_json(const std::vector<Row>& rows) {
    std::string lines;
    for (const Row& row : rows) {
        Json line = {{"event", "row"}};
        line.update(row_json(row));
        lines += line.dump() + "\n";
    }
    return lines;
}

std::string row_name(const Row& row) {
    return fmt::format("{} {} {}, {} thread{}", row.scene, row.particles, row.method, row.threads,
                       row.threads == 1 ? "" : "s");
}

}  // namespace talus::bench
