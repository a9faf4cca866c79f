#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "geo/contours.hpp"
#include "report/chart.hpp"
#include "report/colour.hpp"
#include "report/map.hpp"
#include "report/number_text.hpp"
#include "report/relief.hpp"
#include "report/results.hpp"

namespace talus::report {
namespace {

std::string path_data(const MapFrame& frame, const std::vector<PlanPoint>& points, bool closed = false) {
    PathData data;
    for (std::size_t k = 0; k < points.size(); ++k) {
        const double x = frame.x(points[k].x), y = frame.y(points[k].y);
        k == 0 ? data.move_to(x, y) : data.line_to(x, y);
    }
    if (closed) data.close();
    return data.take();
}

std::string polygon_data(const MapFrame& frame, const Polygon& polygon) {
    std::string d = path_data(frame, polygon.outer, true);
    for (const Ring& hole : polygon.holes) d += path_data(frame, hole, true);
    return d;
}

/// Decimals that tell multiples of a step apart, whose digits are 1, 2, 2.5 or 5.
int decimals_of_step(double step) {
    constexpr double rounding = 1e-6;
    int decimals = 0;
    for (double rest = step; decimals < 6 && std::abs(rest - std::round(rest)) > rounding * rest; rest *= 10)
        ++decimals;
    return decimals;
}

/// The elevation of an index contour, written along its middle where the line is straight enough to carry it.
void draw_contour_label(Svg& svg, const MapFrame& frame, const geo::Contour& contour, int decimals) {
    const auto& points = contour.points;
    double length = 0;
    std::vector<double> along = {0};
    for (std::size_t i = 1; i < points.size(); ++i) {
        length += std::hypot(points[i].x - points[i - 1].x, points[i].y - points[i - 1].y) * frame.scale;
        along.push_back(length);
    }
    if (length < 110) return;
    const auto at = [&](double s) {
        const std::size_t i = std::min<std::size_t>(
            static_cast<std::size_t>(std::lower_bound(along.begin(), along.end(), s) - along.begin()),
            points.size() - 1);
        return points[i];
    };
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
        svg.turned_text("contour-label", frame.x(m.x), frame.y(m.y), angle, fixed(contour.elevation, decimals), {},
                        "3.5");
    }
}

/// The name of a building, gauge or cross-section below it, centred.
struct Label {
    int rank;  ///< its class: where two names would overlap, that of the higher class is kept
    double x, y;
    std::string text;
    const char* style = "building-name";

    [[nodiscard]] double half_width() const { return 3.7 * static_cast<double>(text.size()); }
    [[nodiscard]] bool meets(const Label& other) const {
        return std::abs(x - other.x) < half_width() + other.half_width() && std::abs(y - other.y) < 14;
    }
};

void draw_labels(Svg& svg, std::vector<Label> labels) {
    std::stable_sort(labels.begin(), labels.end(), [](const Label& a, const Label& b) { return a.rank > b.rank; });
    std::vector<Label> drawn;
    for (const Label& label : labels) {
        if (std::any_of(drawn.begin(), drawn.end(), [&](const Label& other) { return other.meets(label); })) continue;
        svg.text(label.style, label.x, label.y, label.text);
        drawn.push_back(label);
    }
}

/// A coloured line on a broader pale one that makes it stand out from the background.
void draw_cased(Svg& svg, const std::string& style, const std::string& data, std::string_view title = {}) {
    svg.path(style + "-case", data);
    svg.path(style, data, title);
}

void draw_flow_path(Svg& svg, const scene::Scene& scene, const MapFrame& frame) {
    const terrain::FlowPath& path = scene.flow_path;
    if (path.empty()) return;
    const std::string d = path_data(frame, path.points());
    draw_cased(svg, "flow-path", d);
    const double diagonal = std::hypot(frame.area.width(), frame.area.height());
    double step = round_step(std::min(path.length(), diagonal) / 9);
    for (double c = 0; c <= path.length(); c += step) {
        const PlanPoint p = path.point_at(c), before = path.point_at(c - 2), after = path.point_at(c + 2);
        if (!frame.area.contains(p)) continue;
        const double run = std::hypot(after.x - before.x, after.y - before.y);
        if (!(run > 0)) continue;
        // To the right, looking downstream; SVG's y points down.
        const double nx = (after.y - before.y) / run, ny = (after.x - before.x) / run;
        const double at_x = frame.x(p.x), at_y = frame.y(p.y);
        svg.line("chainage-tick", at_x - 5 * nx, at_y - 5 * ny, at_x + 5 * nx, at_y + 5 * ny);
        const char* anchor = nx > 0.4 ? "start" : nx < -0.4 ? "end" : "middle";
        svg.text("chainage", at_x + 9 * nx, at_y + 12 * ny + 4, fixed(c, decimals_of_step(step)), anchor);
    }
}

/// Observations are given by chainage.
bool has_observations(const scene::Scene& scene) {
    return !scene.spec.observations.empty() && !scene.flow_path.empty();
}

void draw_observations(Svg& svg, const scene::Scene& scene, const MapFrame& frame) {
    if (!has_observations(scene)) return;
    for (const params::ObservationSpec& o : scene.spec.observations) {
        const PlanPoint p = scene.flow_path.point_at(o.chainage), before = scene.flow_path.point_at(o.chainage - 2),
                        after = scene.flow_path.point_at(o.chainage + 2);
        const double run = std::max(1e-9, std::hypot(after.x - before.x, after.y - before.y));
        const double nx = -(after.y - before.y) / run, ny = -(after.x - before.x) / run;  // to the left, downstream
        svg.path("observation", diamond(frame.x(p.x), frame.y(p.y)));
        svg.text("observation-label", frame.x(p.x) + 13 * nx, frame.y(p.y) + 16 * ny + 4,
                 fmt::format("{} m: {} m/s", fixed(o.chainage, length_decimals(scene)), plain(o.value())),
                 nx >= 0 ? "start" : "end");
    }
}

/// An observation at the same place has a label there already.
void draw_gauges(Svg& svg, const scene::Scene& scene, const MapFrame& frame, std::vector<Label>& labels) {
    for (const terrain::Gauge& gauge : scene.gauges) {
        if (!frame.area.contains(gauge.at)) continue;
        const double x = frame.x(gauge.at.x), y = frame.y(gauge.at.y);
        svg.path("gauge", disc(x, y), gauge.name);
        const auto& observed = scene.spec.observations;
        const bool named = std::any_of(observed.begin(), observed.end(), [&](const params::ObservationSpec& o) {
            return std::abs(o.chainage - gauge.chainage) * frame.scale < 14;
        });
        if (!named) labels.push_back({0, x, y + 18, shortened(gauge.name, 24), "gauge-name"});
    }
}

/// Halfway along a line.
PlanPoint middle_of(const std::vector<PlanPoint>& line) {
    double left = 0;
    const auto length = [&](std::size_t k) { return std::hypot(line[k].x - line[k - 1].x, line[k].y - line[k - 1].y); };
    for (std::size_t k = 1; k < line.size(); ++k) left += length(k) / 2;
    std::size_t k = 1;
    for (; k + 1 < line.size() && length(k) < left; ++k) left -= length(k);
    const double share = left / length(k);
    return {line[k - 1].x + share * (line[k].x - line[k - 1].x), line[k - 1].y + share * (line[k].y - line[k - 1].y)};
}

/// With the name at the middle of the line.
void draw_cross_sections(Svg& svg, const scene::Scene& scene, const MapFrame& frame, std::vector<Label>& labels) {
    for (const terrain::CrossSection& section : scene.cross_sections) {
        draw_cased(svg, "cross-section", path_data(frame, section.line), section.name);
        const PlanPoint middle = middle_of(section.line);
        if (!frame.area.contains(middle)) continue;
        labels.push_back({0, frame.x(middle.x), frame.y(middle.y) + 18, shortened(section.name, 24), "section-name"});
    }
}

/// A line with an arrow in the direction of flow, or the outline of an area.
void draw_inflow(Svg& svg, const terrain::Inflow& inflow, const MapFrame& frame) {
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
    draw_cased(svg, "inflow", d, inflow.name);
}

}  // namespace

void draw_contours(Svg& svg, const scene::Scene& scene, const MapFrame& frame, double& interval) {
    const Grid<float> ground = crop(scene.terrain.elevation(), frame.area, 320);
    ValueRange relief{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const float v : ground.values) relief.include(v);
    interval = 0;
    if (!(relief.high > relief.low)) return;
    interval = round_step((relief.high - relief.low) / 40);
    if (std::abs(interval / std::pow(10, std::floor(std::log10(interval))) - 2.5) < 1e-6) interval *= 2;
    std::string fine, index;
    Svg labels;
    for (const geo::Contour& contour : geo::contours(ground, interval)) {
        const bool labelled = std::lround(contour.elevation / interval) % 5 == 0;
        (labelled ? index : fine) += path_data(frame, contour.points);
        if (labelled) draw_contour_label(labels, frame, contour, decimals_of_step(5 * interval));
    }
    svg.path("contour", fine);
    svg.path("index-contour", index);
    svg.append(labels);
}

void draw_vectors(Svg& svg, const scene::Scene& scene, const MapContent& content, const MapFrame& frame) {
    const BuildingMarks& marks = content.buildings;
    std::vector<Label> labels;
    for (std::size_t i = 0; i < scene.buildings.size(); ++i) {
        const terrain::Building& building = scene.buildings[i];
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
        svg.path(fmt::format("building hit-{}{}", hit, removed ? " removed" : ""), d,
                 i < marks.titles.size() ? marks.titles[i] : building.name);
        if (hit > 0 && !building.name.empty()) {
            labels.push_back({hit, frame.x((around.x_min + around.x_max) / 2), frame.y(around.y_min) + 13,
                              shortened(building.name, 24)});
        }
    }
    for (const terrain::Release& release : scene.releases) {
        std::string d;
        for (const terrain::ReleasePatch& patch : release.patches) d += polygon_data(frame, patch.polygon);
        draw_cased(svg, "release", d, release.name);
    }
    for (const terrain::Inflow& inflow : scene.inflows) draw_inflow(svg, inflow, frame);
    draw_flow_path(svg, scene, frame);
    draw_observations(svg, scene, frame);
    draw_cross_sections(svg, scene, frame, labels);
    draw_gauges(svg, scene, frame, labels);
    if (content.zoom) draw_cased(svg, "zoom-boundary", polygon_data(frame, *content.zoom), "boundary of the zoom");
    draw_labels(svg, std::move(labels));
}

void draw_frame(Svg& svg, const scene::Scene& scene, const MapContent& content, const MapFrame& frame) {
    const double step = round_step(std::max(frame.area.width(), frame.area.height()) / 6);
    const int digits = decimals_of_step(step);
    std::vector<double> east, north;
    for (double v = std::ceil(frame.area.x_min / step) * step; v <= frame.area.x_max; v += step) east.push_back(v);
    for (double v = std::ceil(frame.area.y_min / step) * step; v <= frame.area.y_max; v += step) north.push_back(v);
    for (const double e : east) {
        for (const double n : north) {
            svg.path("grid-cross", fmt::format("M{} {}h8M{} {}v8", coordinate(frame.x(e) - 4), coordinate(frame.y(n)),
                                               coordinate(frame.x(e)), coordinate(frame.y(n) - 4)));
        }
    }
    for (const double e : east) {
        svg.line("frame-tick", frame.x(e), frame.bottom(), frame.x(e), frame.bottom() + 5);
        const double room = std::min(frame.x(e) - frame.left, frame.right() - frame.x(e));
        if (room < 28) continue;
        svg.text("grid-number", frame.x(e), frame.bottom() + 18, fixed(e, digits) + " E", "middle");
    }
    for (const double n : north) {
        svg.line("frame-tick", frame.left - 5, frame.y(n), frame.left, frame.y(n));
        const double room = std::min(frame.y(n) - frame.top, frame.bottom() - frame.y(n));
        if (room < 28) continue;
        svg.turned_text("grid-number", frame.left - 9, frame.y(n), -90, fixed(n, digits) + " N", "middle");
    }
    svg.rect("map-frame", frame.left, frame.top, frame.width(), frame.height());
    const double left = frame.left + 10, first = frame.top + 20, line_height = 18;
    const bool reconstruction = scene.spec.scene.reconstruction;
    if (reconstruction) svg.text("map-flag", left, first, "RECONSTRUCTION");
    if (content.beyond_limits.empty()) return;
    std::string flag = content.beyond_limits;
    for (char& letter : flag) letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
    svg.text("map-flag", left, first + (reconstruction ? line_height : 0), flag);
}

double key_height(const scene::Scene& scene, const MapContent& content) {
    const int rows = 2 + (scene.releases.empty() ? 0 : 1) + (scene.inflows.empty() ? 0 : 1) +
                     (has_observations(scene) ? 1 : 0) + (scene.gauges.empty() ? 0 : 1) +
                     (scene.cross_sections.empty() ? 0 : 1) + (content.zoom ? 1 : 0) +
                     (scene.buildings.empty() ? 0 : 5);
    return 20.0 * rows + 100;
}

void draw_key(Svg& svg, const scene::Scene& scene, const MapContent& content, const MapFrame& frame,
              double contour_interval) {
    const double x = frame.right() + 20;
    double y = 0;
    const auto row = [&](std::string_view text, const auto& draw_symbol) {
        svg.open("g", {{"transform", translation(x, y)}});
        draw_symbol();
        svg.text("legend", 39, 14, text);
        svg.close("g");
        y += 20;
    };
    if (!scene.releases.empty()) row("Release area", [&] { draw_cased(svg, "release", "M2 3h26v13h-26Z"); });
    if (!scene.inflows.empty()) row("Inflow", [&] { draw_cased(svg, "inflow", "M3 15h24M15 15v-10m-4 4l4 -5l4 5"); });
    if (!scene.flow_path.empty()) {
        const char* label = scene.flow_path_origin == scene::PathOrigin::traced     ? "Flow path (traced)"
                            : scene.flow_path_origin == scene::PathOrigin::followed ? "Path of the debris"
                                                                                    : "Flow path, chainage";
        row(label, [&] {
            draw_cased(svg, "flow-path", "M0 10h30");
            svg.path("chainage-tick", "M15 5v10");
        });
    }
    if (has_observations(scene)) row("Field observation", [&] { svg.path("observation", diamond(15, 10)); });
    if (!scene.gauges.empty()) row("Gauge", [&] { svg.path("gauge", disc(15, 10)); });
    if (!scene.cross_sections.empty()) row("Cross-section", [&] { draw_cased(svg, "cross-section", "M2 10h26"); });
    if (content.zoom) row("Boundary of the zoom", [&] { draw_cased(svg, "zoom-boundary", "M2 3h26v13h-26Z"); });
    if (contour_interval > 0) {
        row(fmt::format("Contours every {} m", coordinate(contour_interval)),
            [&] { svg.path("index-contour", "M0 10h30"); });
    }
    if (!scene.buildings.empty()) {
        y += 4;
        const BuildingMarks& marks = content.buildings;
        svg.text("legend-unit", x, y + 12, marks.title);
        y += 18;
        for (int k = 3; k >= 0; --k) {
            row(marks.class_names.at(static_cast<std::size_t>(k)),
                [&] { svg.rect(fmt::format("building hit-{}", k), 2, 3, 26, 13); });
        }
    }
    draw_scale(svg, frame, x, y + 20);
}

void draw_scale(Svg& svg, const MapFrame& frame, double x, double y) {
    // Two halves of a round length, 70 to 140 units together.
    const double half = round_step(35 / frame.scale), length = half * frame.scale;
    svg.open("g", {{"transform", translation(x, y)}});
    svg.rect("scale-dark", 0, 18, length, 6);
    svg.rect("scale-light", length, 18, length, 6);
    svg.text("legend-unit", 0, 12, "0", "start");
    svg.text("legend-unit", length, 12, coordinate(half), "middle");
    svg.text("legend-unit", 2 * length, 12, coordinate(2 * half) + " m", "middle");
    svg.text("legend-unit", 0, 42, fmt::format("1 : {} printed on A4", fixed(print_ratio(frame), 0)));
    svg.close("g");
    svg.open("g", {{"transform", translation(x + MapFrame::key_width - 22, y + 4)}});
    svg.path("north", "M0 0l8 30l-8 -6l-8 6Z");
    svg.text("north-letter", 0, -5, "N");
    svg.close("g");
}

namespace {

double whole_width(const MapFrame& frame) {
    return frame.right() + 20 + MapFrame::key_width;
}

}  // namespace

double print_ratio(const MapFrame& frame) {
    constexpr double paper_width = 182, paper_height = 108;  // mm, within report.css's margins; two maps to a page
    const double largest = std::min(paper_width / whole_width(frame), paper_height / (frame.bottom() + 30));
    const double least = 1000 / (frame.scale * largest);
    const double decade = std::pow(10, std::floor(std::log10(least)));
    for (const double round : {1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.5}) {
        if (round * decade >= least * (1 - 1e-9)) return round * decade;
    }
    return 10 * decade;
}

double print_width(const MapFrame& frame) {
    return whole_width(frame) * 1000 / (print_ratio(frame) * frame.scale);
}

}  // namespace talus::report
