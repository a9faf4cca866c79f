#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <fmt/format.h>

#include "design/sheet_parts.hpp"
#include "observe/barrier_line.hpp"
#include "report/svg.hpp"

namespace talus::design {

using report::coordinate;
using report::Json;

namespace {

/// Ground across the middle of a line, from `from` to `to` m downstream of it.
struct Profile {
    std::vector<double> x, z;
};
Profile profile_of(const DesignResult& result, const LineResult& line, double from, double to) {
    const std::vector<PlanPoint>& points = line.line.points;
    const PlanPoint middle = observe::point_at(points, line.length / 2);
    const PlanPoint a = observe::point_at(points, 0.45 * line.length),
                    b = observe::point_at(points, 0.55 * line.length);
    const double d = std::hypot(b.x - a.x, b.y - a.y);
    // Downstream: away from the side from which debris comes.
    const PlanPoint down{line.side * (b.y - a.y) / d, -line.side * (b.x - a.x) / d};
    Profile made;
    constexpr int count = 160;
    for (int k = 0; k <= count; ++k) {
        const double s = from + (to - from) * k / count;
        const double z = result.design->scene->terrain.elevation_at({middle.x + s * down.x, middle.y + s * down.y});
        if (std::isnan(z)) continue;
        made.x.push_back(s);
        made.z.push_back(z);
    }
    return made;
}

/// A value of each run at common times: median and greatest.
struct Course {
    std::vector<double> time, median, greatest;
};
Course course_of(const std::vector<std::optional<BarrierRun>>& runs, double observe::StructureSample::*member,
                 double factor) {
    double end = 0;
    for (const auto& run : runs) {
        if (run && !run->history.empty()) end = std::max(end, run->history.back().time);
    }
    Course made;
    constexpr int count = 300;
    for (int k = 0; k <= count && end > 0; ++k) {
        const double t = end * k / count, before = end * (k - 1) / count;
        std::vector<double> values;
        for (const auto& run : runs) {
            if (!run) continue;
            // The greatest since the time before, so that no peak is lost; then the last one before.
            const auto after = [](double time, const observe::StructureSample& s) { return time < s.time; };
            const auto& rows = run->history;
            const auto last = std::upper_bound(rows.begin(), rows.end(), t, after);
            auto at = std::upper_bound(rows.begin(), rows.end(), before, after);
            double value = last == rows.begin() ? 0 : (*std::prev(last)).*member;
            for (; at < last; ++at) value = std::max(value, (*at).*member);
            values.push_back(value * factor);
        }
        const Spread spread = spread_of(std::move(values));
        made.time.push_back(t);
        made.median.push_back(spread.median);
        made.greatest.push_back(spread.greatest);
    }
    return made;
}

double greatest_of(const std::vector<double>& values) {
    return values.empty() ? 0 : *std::max_element(values.begin(), values.end());
}

}  // namespace

std::string section_svg(const DesignResult& result) {
    const LineResult& line = result.lines.front();
    const double height = line.shown().height;
    double thickness = 1;
    for (const terrain::Building& b : result.design->scene->buildings) {
        if (b.barrier && b.name == result.design->request.barrier) thickness = b.barrier->thickness;
    }
    const double span = std::clamp(1.2 * std::max(line.level.reach, line.sloped.reach), 4 * height, 12 * height);
    const Profile ground = profile_of(result, line, -span, span / 2);
    if (ground.x.size() < 3) return "";
    const auto ground_at = [&](double x) {
        const auto after = std::lower_bound(ground.x.begin(), ground.x.end(), x);
        const auto k = static_cast<std::size_t>(after - ground.x.begin());
        if (k == 0) return ground.z.front();
        if (k == ground.x.size()) return ground.z.back();
        return std::lerp(ground.z[k - 1], ground.z[k], (x - ground.x[k - 1]) / (ground.x[k] - ground.x[k - 1]));
    };
    const double crest = ground_at(0) + height;
    const double run_up = peaks_of(line).run_up.p95;
    const double top_z =
        std::max(greatest_of(ground.z), ground_at(-thickness / 2) + std::max(height, run_up)) + 0.4 * height;
    const double low_z = *std::min_element(ground.z.begin(), ground.z.end()) - 0.3 * height;
    constexpr double left = 8, top = 8, width = 620;
    const double scale = std::min(width / (1.5 * span), 300 / (top_z - low_z));  // the same along and up
    const double drawn = scale * 1.5 * span;
    const auto px = [&](double x) { return left + (x + span) * scale; };
    const auto py = [&](double z) { return top + (top_z - z) * scale; };
    report::Svg svg;
    // What is held at the deposition slope, then the level part of it, up to where the ground meets them.
    const auto fill = [&](double slope, const char* style) {
        std::string path =
            fmt::format("M{} {}", coordinate(px(-thickness / 2)), coordinate(py(ground_at(-thickness / 2))));
        std::string back;
        for (double x = -thickness / 2; x > -span; x -= span / 200) {
            const double z = crest + slope * (-x - thickness / 2);
            path += fmt::format("L{} {}", coordinate(px(x)), coordinate(py(std::max(z, ground_at(x)))));
            back.insert(0, fmt::format("L{} {}", coordinate(px(x)), coordinate(py(ground_at(x)))));
            if (z <= ground_at(x)) break;
        }
        svg.path(style, path + back + "Z");
    };
    fill(line.deposition_slope, "held-sloped");
    fill(0, "held-level");
    std::string surface, flow;
    for (std::size_t k = 0; k < ground.x.size(); ++k) {
        surface += fmt::format("{}{} {}", k == 0 ? "M" : "L", coordinate(px(ground.x[k])), coordinate(py(ground.z[k])));
        if (ground.x[k] < -thickness / 2) {
            flow += fmt::format("{}{} {}", k == 0 ? "M" : "L", coordinate(px(ground.x[k])),
                                coordinate(py(ground.z[k] + line.depth.p95)));
        }
    }
    const double bottom = py(low_z);
    svg.path("ground-fill", surface + fmt::format("L{} {}L{} {}Z", coordinate(px(ground.x.back())), coordinate(bottom),
                                                  coordinate(px(ground.x.front())), coordinate(bottom)));
    svg.path("ground-line", surface);
    svg.path("series blue dashed", flow);
    const double foot = std::min(ground_at(-thickness / 2), ground_at(thickness / 2));
    svg.rect("wall", px(-thickness / 2), py(crest), thickness * scale, (crest - foot) * scale);
    const double mark = py(ground_at(-thickness / 2) + run_up);
    svg.line("series red", px(-thickness / 2) - 26, mark, px(-thickness / 2), mark);
    // Names to the right, one below the other.
    const double key = left + drawn + 18;
    const auto name = [&](int row, const char* style, bool area, const std::string& text) {
        const double y = top + 14 + 24 * row;
        if (area) {
            svg.rect(style, key, y - 11, 24, 12);
        } else {
            svg.line(style, key, y - 4, key + 24, y - 4);
        }
        svg.text("key", key + 32, y, text);
    };
    name(0, "wall", true, fmt::format("barrier, {:g} m above the ground", height));
    name(1, "held-level", true, fmt::format("held, level: {} m³", report::fixed(line.level.volume, 0)));
    name(2, "held-sloped", true,
         fmt::format("held at the deposition slope: {} m³", report::fixed(line.sloped.volume, 0)));
    name(3, "series blue dashed", false,
         fmt::format("flow without the barrier, 95 %: {} m", report::fixed(line.depth.p95, 2)));
    name(4, "series red", false, fmt::format("debris at the face, 95 %: {} m", report::fixed(run_up, 2)));
    const double bar = std::pow(10, std::floor(std::log10(span)));
    const double y = top + 14 + 24 * 5.6;
    svg.line("axis", key, y, key + bar * scale, y);
    svg.text("note", key + bar * scale + 8, y + 4, fmt::format("{:g} m, the same upwards", bar));
    return figure_svg(key + 330, std::max(bottom, y) + 8, "Section across the barrier", svg);
}

Json capacity_chart(const DesignResult& result) {
    const LineResult& line = result.lines.front();
    std::vector<double> heights, volumes;
    for (const auto& [height, volume] : line.capacity) {
        heights.push_back(height);
        volumes.push_back(volume);
    }
    const double most = std::max(greatest_of(volumes), 1.05 * line.volume.p95);
    report::Plot plot(74, 30, 400, 220, {0, heights.back()}, {0, std::max(most, 1.0)});
    plot.axes("height of the barrier, m", "m³");
    plot.line(heights, volumes, "series blue", "held, level");
    plot.horizontal(line.volume.p95, "limit purple", "volume across, 95 %");
    plot.vertical(line.shown().height, "limit");
    report::Chart chart{"Capacity", 500, 304, {std::move(plot)}};
    return chart_json(chart);
}

Json time_chart(const DesignResult& result) {
    const LineResult& line = result.lines.front();
    const auto& runs = line.shown().runs;
    const Course filling = course_of(runs, &observe::StructureSample::retained_volume, 1);
    const Course force = course_of(runs, &observe::StructureSample::force, 1e-3 / line.length);
    if (filling.time.empty()) return {};
    const report::ValueRange time{0, filling.time.back()};
    report::Plot left(74, 52, 400, 200, time, {0, std::max(1.0, 1.1 * greatest_of(filling.greatest))});
    left.axes("time, s", "held behind, m³");
    left.line(filling.time, filling.greatest, "series orange", "greatest of the runs");
    left.line(filling.time, filling.median, "series blue", "median");
    report::ValueRange forces{0, 1.1 * greatest_of(force.greatest)};
    const Approach approach = approach_of(result, line);
    std::vector<const LoadMethod*> drawn;
    for (const LoadMethod& method : load_methods()) {
        if (method.name == "kwan_2012_rigid" || method.name == "hydrostatic") drawn.push_back(&method);
    }
    for (const LoadMethod* method : drawn) forces.include(1.1 * load_of(*method, approach).force_per_metre / 1e3);
    report::Plot right(574, 52, 400, 200, time, forces);
    right.axes("time, s", "force, kN per m");
    right.line(force.time, force.greatest, "series orange", "greatest of the runs");
    right.line(force.time, force.median, "series blue", "median");
    for (const LoadMethod* method : drawn) {
        right.horizontal(load_of(*method, approach).force_per_metre / 1e3,
                         method->kind == LoadKind::hydrostatic ? "limit blue" : "limit purple", method->formula());
    }
    report::Chart chart{"Filling and load over time", 1000, 304, {std::move(left), std::move(right)}};
    return chart_json(chart);
}

}  // namespace talus::design
