#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "products/report_colour.hpp"
#include "products/report_map.hpp"
#include "products/report_plot.hpp"
#include "products/report_relief.hpp"
#include "products/report_text.hpp"

namespace talus::report {
namespace {

std::string path_data(const MapFrame& frame, const std::vector<PlanPoint>& points) {
    std::string d;
    for (const PlanPoint& p : points) {
        d += fmt::format("{}{} {}", d.empty() ? "M" : "L", coordinate(std::round(frame.x(p.x) * 10) / 10),
                         coordinate(std::round(frame.y(p.y) * 10) / 10));
    }
    return d;
}

std::string polygon_data(const MapFrame& frame, const Polygon& polygon) {
    std::string d = path_data(frame, polygon.outer) + "Z";
    for (const Ring& hole : polygon.holes) d += path_data(frame, hole) + "Z";
    return d;
}

/// The elevation of an index contour, written along its middle where the line is straight enough to carry it.
std::string contour_label(const MapFrame& frame, const Contour& contour) {
    const auto& points = contour.points;
    double length = 0;
    std::vector<double> along = {0};
    for (std::size_t i = 1; i < points.size(); ++i) {
        length += std::hypot(points[i].x - points[i - 1].x, points[i].y - points[i - 1].y) * frame.scale;
        along.push_back(length);
    }
    if (length < 110) return "";
    const auto at = [&](double s) {
        const std::size_t i = std::min<std::size_t>(
            static_cast<std::size_t>(std::lower_bound(along.begin(), along.end(), s) - along.begin()),
            points.size() - 1);
        return points[i];
    };
    std::string svg;
    const int labels = std::clamp(static_cast<int>(length / 600), 1, 3);
    for (int k = 0; k < labels; ++k) {
        // The straightest of some places around the wanted one.
        double best = 0, best_place = length / 2;
        for (int trial = -6; trial <= 6; ++trial) {
            const double s = length * (k + 0.5) / labels + trial * length / labels / 16;
            const PlanPoint a = at(s - 18), m = at(s), b = at(s + 18);
            const bool in_frame = frame.area.grown(-22 / frame.scale).contains(m);
            const double straight = std::hypot(b.x - a.x, b.y - a.y) * (in_frame ? 1 : 0);
            if (straight > best * 1.02) {
                best = straight;
                best_place = s;
            }
        }
        if (best * frame.scale < 30) continue;
        const PlanPoint a = at(best_place - 18), m = at(best_place), b = at(best_place + 18);
        double angle = -std::atan2(b.y - a.y, b.x - a.x) * 180 / std::numbers::pi;
        if (angle > 90) angle -= 180;
        if (angle < -90) angle += 180;
        svg += fmt::format(
            R"svg(<text class="contour-label" transform="translate({} {}) rotate({})" dy="3.5">{}</text>)svg",
            coordinate(frame.x(m.x)), coordinate(frame.y(m.y)), coordinate(angle), fixed(contour.elevation, 0));
    }
    return svg;
}

/// A building's name below it, centred.
struct Label {
    int rank;  ///< its class: where two names would run into each other, the one hit harder stays
    double x, y;
    std::string text;

    [[nodiscard]] double half_width() const { return 3.7 * static_cast<double>(text.size()); }
    [[nodiscard]] bool meets(const Label& other) const {
        return std::abs(x - other.x) < half_width() + other.half_width() && std::abs(y - other.y) < 14;
    }
};

std::string draw_labels(std::vector<Label> labels) {
    std::stable_sort(labels.begin(), labels.end(), [](const Label& a, const Label& b) { return a.rank > b.rank; });
    std::vector<Label> drawn;
    std::string svg;
    for (const Label& label : labels) {
        if (std::any_of(drawn.begin(), drawn.end(), [&](const Label& other) { return other.meets(label); })) continue;
        svg += fmt::format(R"(<text class="building-name" x="{}" y="{}">{}</text>)", coordinate(label.x),
                           coordinate(label.y), escape(label.text));
        drawn.push_back(label);
    }
    return svg;
}

std::string draw_flow_path(const Scene& scene, const MapFrame& frame) {
    const FlowPath& path = scene.flow_path;
    if (path.empty()) return "";
    const std::string d = path_data(frame, path.points());
    std::string svg = fmt::format(R"(<path class="flow-path-case" d="{0}"/><path class="flow-path" d="{0}"/>)", d);
    const double diagonal = std::hypot(frame.area.width(), frame.area.height());
    double step = round_step(std::min(path.length(), diagonal) / 9);
    for (double c = 0; c <= path.length(); c += step) {
        const PlanPoint p = path.point_at(c), before = path.point_at(c - 2), after = path.point_at(c + 2);
        if (!frame.area.contains(p)) continue;
        const double run = std::hypot(after.x - before.x, after.y - before.y);
        if (!(run > 0)) continue;
        // To the right, looking downstream; SVG's y points down.
        const double nx = (after.y - before.y) / run, ny = (after.x - before.x) / run;
        svg += fmt::format(R"(<line class="chainage-tick" x1="{}" y1="{}" x2="{}" y2="{}"/>)",
                           coordinate(frame.x(p.x) - 5 * nx), coordinate(frame.y(p.y) - 5 * ny),
                           coordinate(frame.x(p.x) + 5 * nx), coordinate(frame.y(p.y) + 5 * ny));
        const char* anchor = nx > 0.4 ? "start" : nx < -0.4 ? "end" : "middle";
        svg += fmt::format(R"(<text class="chainage" x="{}" y="{}" text-anchor="{}">{}</text>)",
                           coordinate(frame.x(p.x) + 9 * nx), coordinate(frame.y(p.y) + 12 * ny + 4), anchor,
                           fixed(c, step < 1 ? 1 : 0));
    }
    return svg;
}

std::string draw_observations(const Scene& scene, const MapFrame& frame) {
    std::string svg;
    if (scene.flow_path.empty()) return svg;
    for (const ObservationSpec& o : scene.spec.observations) {
        const PlanPoint p = scene.flow_path.point_at(o.chainage), before = scene.flow_path.point_at(o.chainage - 2),
                        after = scene.flow_path.point_at(o.chainage + 2);
        const double run = std::max(1e-9, std::hypot(after.x - before.x, after.y - before.y));
        const double nx = -(after.y - before.y) / run, ny = -(after.x - before.x) / run;  // to the left, downstream
        svg += fmt::format(R"(<path class="observation" d="M{} {}l7 7l-7 7l-7 -7Z"/>)", coordinate(frame.x(p.x)),
                           coordinate(frame.y(p.y) - 7));
        const char* anchor = nx >= 0 ? "start" : "end";
        svg += fmt::format(R"(<text class="observation-label" x="{}" y="{}" text-anchor="{}">{} m: {} m/s</text>)",
                           coordinate(frame.x(p.x) + 13 * nx), coordinate(frame.y(p.y) + 16 * ny + 4), anchor,
                           fixed(o.chainage, 0), plain(o.front_velocity));
    }
    return svg;
}

/// A line with an arrow where debris goes, or the outline of an area.
std::string draw_inflow(const Inflow& inflow, const MapFrame& frame) {
    std::string d;
    for (const Polygon& part : inflow.area) d += polygon_data(frame, part);
    if (!inflow.over_area()) {
        const double x0 = frame.x(inflow.from.x), y0 = frame.y(inflow.from.y), x1 = frame.x(inflow.to.x),
                     y1 = frame.y(inflow.to.y), length = std::hypot(x1 - x0, y1 - y0);
        // On the page north is up and y goes down: to the right of the line is (-dy, dx).
        const double along_x = (x1 - x0) / length, along_y = (y1 - y0) / length, x = (x0 + x1) / 2, y = (y0 + y1) / 2;
        const auto place = [&](double forward, double aside) {
            return fmt::format("{} {}", coordinate(x - along_y * forward + along_x * aside),
                               coordinate(y + along_x * forward + along_y * aside));
        };
        d = fmt::format("M{} {}L{} {}M{}L{}M{}L{}L{}", coordinate(x0), coordinate(y0), coordinate(x1), coordinate(y1),
                        place(0, 0), place(16, 0), place(10, -4.5), place(16, 0), place(10, 4.5));
    }
    return fmt::format(R"(<path class="inflow-case" d="{0}"/><path class="inflow" d="{0}"><title>{1}</title></path>)",
                       d, escape(inflow.name));
}

}  // namespace

std::string draw_contours(const Scene& scene, const MapFrame& frame, double& interval) {
    const Grid<float> ground = crop(scene.terrain.elevation(), frame.area, 320);
    ValueRange relief{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const float v : ground.values) relief.include(v);
    interval = 0;
    if (!(relief.high > relief.low)) return "";
    interval = round_step((relief.high - relief.low) / 40);
    if (std::abs(interval / std::pow(10, std::floor(std::log10(interval))) - 2.5) < 1e-6) interval *= 2;
    std::string svg, fine, index;
    for (const Contour& contour : contours(ground, interval)) {
        const bool labelled = std::lround(contour.elevation / interval) % 5 == 0;
        (labelled ? index : fine) += path_data(frame, contour.points);
        if (labelled) svg += contour_label(frame, contour);
    }
    return fmt::format(
        R"(<g class="contours"><path class="contour" d="{}"/><path class="index-contour" d="{}"/>{}</g>)", fine, index,
        svg);
}

std::string draw_vectors(const Scene& scene, const BuildingMarks& marks, const MapFrame& frame) {
    std::string svg;
    std::vector<Label> labels;
    for (std::size_t i = 0; i < scene.buildings.size(); ++i) {
        const Building& building = scene.buildings[i];
        std::string d;
        Extent around{1e300, 1e300, -1e300, -1e300};
        for (const Polygon& polygon : building.footprint) {
            const Extent e = extent_of(polygon);
            around.include({e.x_min, e.y_min});
            around.include({e.x_max, e.y_max});
            d += polygon_data(frame, polygon);
        }
        if (around.x_max < frame.area.x_min || around.x_min > frame.area.x_max || around.y_max < frame.area.y_min ||
            around.y_min > frame.area.y_max) {
            continue;
        }
        const int hit = i < marks.classes.size() ? marks.classes[i] : 0;
        const bool removed = i < marks.removed.size() && marks.removed[i];
        svg += fmt::format(R"(<path class="building hit-{}{}" d="{}"><title>{}</title></path>)", hit,
                           removed ? " removed" : "", d,
                           i < marks.titles.size() ? marks.titles[i] : escape(building.name));
        if (hit > 0 && !building.name.empty()) {
            labels.push_back({hit, frame.x((around.x_min + around.x_max) / 2), frame.y(around.y_min) + 13,
                              shortened(building.name, 24)});
        }
    }
    for (const Release& release : scene.releases) {
        std::string d;
        for (const ReleasePatch& patch : release.patches) d += polygon_data(frame, patch.polygon);
        svg += fmt::format(
            R"(<path class="release-case" d="{0}"/><path class="release" d="{0}"><title>{1}</title></path>)", d,
            escape(release.name));
    }
    for (const Inflow& inflow : scene.inflows) svg += draw_inflow(inflow, frame);
    return svg + draw_flow_path(scene, frame) + draw_observations(scene, frame) + draw_labels(std::move(labels));
}

std::string draw_frame(const Scene& scene, const MapFrame& frame) {
    std::string svg;
    const double step = round_step(std::max(frame.area.width(), frame.area.height()) / 6);
    const int digits = step < 1 ? 1 : 0;
    std::vector<double> east, north;
    for (double v = std::ceil(frame.area.x_min / step) * step; v <= frame.area.x_max; v += step) east.push_back(v);
    for (double v = std::ceil(frame.area.y_min / step) * step; v <= frame.area.y_max; v += step) north.push_back(v);
    for (const double e : east) {
        for (const double n : north) {
            svg += fmt::format(R"(<path class="grid-cross" d="M{0} {1}h8M{2} {3}v8"/>)", coordinate(frame.x(e) - 4),
                               coordinate(frame.y(n)), coordinate(frame.x(e)), coordinate(frame.y(n) - 4));
        }
    }
    for (const double e : east) {
        svg += fmt::format(R"(<line class="frame-tick" x1="{0}" y1="{1}" x2="{0}" y2="{2}"/>)", coordinate(frame.x(e)),
                           coordinate(frame.bottom()), coordinate(frame.bottom() + 5));
        const double room = std::min(frame.x(e) - frame.left, frame.right() - frame.x(e));
        if (room < 28) continue;
        svg += fmt::format(R"(<text class="grid-number" x="{}" y="{}" text-anchor="middle">{} E</text>)",
                           coordinate(frame.x(e)), coordinate(frame.bottom() + 18), fixed(e, digits));
    }
    for (const double n : north) {
        svg += fmt::format(R"(<line class="frame-tick" x1="{0}" y1="{2}" x2="{1}" y2="{2}"/>)",
                           coordinate(frame.left - 5), coordinate(frame.left), coordinate(frame.y(n)));
        const double room = std::min(frame.y(n) - frame.top, frame.bottom() - frame.y(n));
        if (room < 28) continue;
        svg += fmt::format(
            R"svg(<text class="grid-number" transform="translate({} {}) rotate(-90)" text-anchor="middle">{} N</text>)svg",
            coordinate(frame.left - 9), coordinate(frame.y(n)), fixed(n, digits));
    }
    svg += fmt::format(R"(<rect class="map-frame" x="{}" y="{}" width="{}" height="{}"/>)", coordinate(frame.left),
                       coordinate(frame.top), coordinate(frame.width()), coordinate(frame.height()));
    if (scene.spec.scene.reconstruction) {
        svg += fmt::format(R"(<text class="map-flag" x="{}" y="{}">RECONSTRUCTION</text>)", coordinate(frame.left + 10),
                           coordinate(frame.top + 20));
    }
    return svg;
}

double key_height(const Scene& scene) {
    const int rows = 2 + (scene.releases.empty() ? 0 : 1) + (scene.inflows.empty() ? 0 : 1) +
                     (scene.spec.observations.empty() ? 0 : 1) + (scene.buildings.empty() ? 0 : 5);
    return 20.0 * rows + 100;
}

std::string draw_key(const Scene& scene, const BuildingMarks& marks, const MapFrame& frame, double contour_interval) {
    const double x = frame.right() + 20;
    double y = 0;
    std::string svg;
    const auto row = [&](const std::string& symbol, const std::string& text) {
        svg +=
            fmt::format(R"svg(<g transform="translate({} {})">{}<text class="legend" x="39" y="14">{}</text></g>)svg",
                        coordinate(x), coordinate(y), symbol, text);
        y += 20;
    };
    if (!scene.releases.empty()) {
        row(R"(<rect class="release-case" x="2" y="3" width="26" height="13"/><rect class="release" x="2" y="3" width="26" height="13"/>)",
            "Release area");
    }
    if (!scene.inflows.empty()) {
        row(R"(<path class="inflow-case" d="M3 15h24M15 15v-10m-4 4l4 -5l4 5"/><path class="inflow" d="M3 15h24M15 15v-10m-4 4l4 -5l4 5"/>)",
            "Inflow");
    }
    if (!scene.flow_path.empty()) {
        row(R"(<path class="flow-path-case" d="M0 10h30"/><path class="flow-path" d="M0 10h30"/><path class="chainage-tick" d="M15 5v10"/>)",
            scene.flow_path_traced ? "Flow path (traced)" : "Flow path, chainage");
    }
    if (!scene.spec.observations.empty())
        row(R"(<path class="observation" d="M15 3l7 7l-7 7l-7 -7Z"/>)", "Field observation");
    if (contour_interval > 0) {
        row(R"(<path class="index-contour" d="M0 10h30"/>)",
            fmt::format("Contours every {} m", coordinate(contour_interval)));
    }
    if (!scene.buildings.empty()) {
        y += 4;
        svg += fmt::format(R"(<text class="legend-unit" x="{}" y="{}">{}</text>)", coordinate(x), coordinate(y + 12),
                           escape(marks.title));
        y += 18;
        for (int k = 3; k >= 0; --k) {
            row(fmt::format(R"(<rect class="building hit-{}" x="2" y="3" width="26" height="13"/>)", k),
                escape(marks.class_names.at(static_cast<std::size_t>(k))));
        }
    }
    // Scale bar: two halves of a round length, 70 to 140 units together, and north of the grid.
    const double half = round_step(35 / frame.scale), length = half * frame.scale;
    y += 20;
    svg += fmt::format(
        R"svg(<g transform="translate({0} {1})"><rect class="scale-dark" x="0" y="18" width="{2}" height="6"/><rect class="scale-light" x="{2}" y="18" width="{2}" height="6"/><text class="legend-unit" x="0" y="12" text-anchor="start">0</text><text class="legend-unit" x="{2}" y="12" text-anchor="middle">{3}</text><text class="legend-unit" x="{4}" y="12" text-anchor="middle">{5} m</text></g>)svg",
        coordinate(x), coordinate(y), coordinate(length), coordinate(half), coordinate(2 * length),
        coordinate(2 * half));
    svg += fmt::format(
        R"svg(<g transform="translate({} {})"><path class="north" d="M0 0l8 30l-8 -6l-8 6Z"/><text class="north-letter" x="0" y="-5">N</text></g>)svg",
        coordinate(x + MapFrame::key_width - 22), coordinate(y + 4));
    return svg;
}

}  // namespace talus::report
