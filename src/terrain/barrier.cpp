#include "terrain/barrier.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/coordinate_text.hpp"
#include "core/try.hpp"

namespace talus::terrain {
namespace {

constexpr double usual_part = 2;        ///< m of line
constexpr std::size_t max_parts = 500;  ///< a longer line gets longer parts
constexpr double sharpest_turn = 150;   ///< degrees; a mitre is then four times as long as the wall is thick

PlanPoint operator-(const PlanPoint& a, const PlanPoint& b) {
    return {a.x - b.x, a.y - b.y};
}
double cross(const PlanPoint& a, const PlanPoint& b) {
    return a.x * b.y - a.y * b.x;
}
double dot(const PlanPoint& a, const PlanPoint& b) {
    return a.x * b.x + a.y * b.y;
}
PlanPoint between(const PlanPoint& a, const PlanPoint& b, double share) {
    return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
}
double distance(const PlanPoint& a, const PlanPoint& b) {
    return std::hypot(b.x - a.x, b.y - a.y);
}

/// Half the wall across the line at each of its points, to the left: along the mitre where it bends.
Result<std::vector<PlanPoint>> find_mitres(const std::vector<PlanPoint>& line, double thickness) {
    std::vector<PlanPoint> normals;
    for (std::size_t k = 0; k + 1 < line.size(); ++k) {
        const double length = distance(line[k], line[k + 1]);
        normals.push_back({-(line[k + 1].y - line[k].y) / length, (line[k + 1].x - line[k].x) / length});
    }
    std::vector<PlanPoint> mitres;
    for (std::size_t k = 0; k < line.size(); ++k) {
        const PlanPoint before = normals[k == 0 ? 0 : k - 1], after = normals[std::min(k, normals.size() - 1)];
        const double turn = std::atan2(std::abs(cross(before, after)), dot(before, after)) * 180 / std::numbers::pi;
        if (turn > sharpest_turn) {
            return Error{fmt::format("line: turns by {:.0f} degrees at point {}; it must be at most {:.0f}", turn,
                                     k + 1, sharpest_turn)};
        }
        const PlanPoint sum{before.x + after.x, before.y + after.y};
        const double scale = thickness / 2 / (1 + dot(before, after));
        mitres.push_back({sum.x * scale, sum.y * scale});
    }
    return mitres;
}

Status check_line(const Terrain& terrain, const std::vector<PlanPoint>& line) {
    for (std::size_t k = 0; k < line.size(); ++k) {
        if (std::isnan(terrain.elevation_at(line[k]))) {
            return Error{fmt::format("line: point {} at ({}, {}) is not on known ground", k + 1,
                                     coordinate_text(line[k].x), coordinate_text(line[k].y))};
        }
        if (k > 0 && distance(line[k - 1], line[k]) < 0.01) {
            return Error{fmt::format("line: points {} and {} are the same", k, k + 1)};
        }
    }
    for (std::size_t k = 0; k + 1 < line.size(); ++k) {
        for (std::size_t other = k + 2; other + 1 < line.size(); ++other) {
            if (segments_meet(line[k], line[k + 1], line[other], line[other + 1])) {
                return Error{fmt::format("line: crosses itself between points {} and {}", other + 1, other + 2)};
            }
        }
    }
    return {};
}

Status check_openings(const params::BarrierSpec& shape) {
    const double length = length_of(shape.line);
    for (std::size_t k = 0; k < shape.openings.size(); ++k) {
        const params::BarrierOpeningSpec& a = shape.openings[k];
        if (a.position - a.width / 2 < 0 || a.position + a.width / 2 > length) {
            return Error{fmt::format("opening {}: reaches from {:.6g} to {:.6g} m along a line of {:.6g} m", k + 1,
                                     a.position - a.width / 2, a.position + a.width / 2, length)};
        }
        if (!shape.crest_elevation && a.sill >= shape.height.value_or(0)) {
            return Error{
                fmt::format("opening {}: sill_height_m = {:.6g} must be below the barrier's height of {:.6g} m", k + 1,
                            a.sill, shape.height.value_or(0))};
        }
        for (std::size_t other = 0; other < k; ++other) {
            const params::BarrierOpeningSpec& b = shape.openings[other];
            if (std::abs(a.position - b.position) < (a.width + b.width) / 2) {
                return Error{fmt::format("openings {} and {}: overlap", other + 1, k + 1)};
            }
        }
    }
    return {};
}

const params::BarrierOpeningSpec* opening_at(const params::BarrierSpec& shape, double chainage) {
    for (const params::BarrierOpeningSpec& opening : shape.openings) {
        if (std::abs(chainage - opening.position) < opening.width / 2) return &opening;
    }
    return nullptr;
}

/// Positions, as shares, at which a segment from chainage `from` to `to` is cut: into equal parts, and at the ends of
/// openings.
std::vector<double> find_cuts(const params::BarrierSpec& shape, double from, double to, double part_length) {
    const int parts = std::max(1, static_cast<int>(std::ceil((to - from) / part_length)));
    std::vector<double> cuts;
    cuts.reserve(static_cast<std::size_t>(parts) + 1 + 2 * shape.openings.size());
    for (int p = 0; p <= parts; ++p) cuts.push_back(static_cast<double>(p) / parts);
    for (const params::BarrierOpeningSpec& opening : shape.openings) {
        for (const double end : {opening.position - opening.width / 2, opening.position + opening.width / 2}) {
            const double share = (end - from) / (to - from);
            if (share > 0 && share < 1) cuts.push_back(share);
        }
    }
    std::sort(cuts.begin(), cuts.end());
    const auto same = [&](double a, double b) { return (b - a) * (to - from) < 1e-3; };
    cuts.erase(std::unique(cuts.begin(), cuts.end(), same), cuts.end());
    cuts.back() = 1;
    return cuts;
}

}  // namespace

Result<Building> make_barrier(const Terrain& terrain, const std::string& name, const params::BarrierSpec& shape) {
    const std::vector<PlanPoint>& line = shape.line;
    TALUS_TRY(check_line(terrain, line));
    TALUS_TRY(check_openings(shape));
    TALUS_ASSIGN(const std::vector<PlanPoint> mitres, find_mitres(line, shape.thickness));
    Building barrier;
    barrier.name = name;
    barrier.barrier = shape;
    barrier.barrier->name.clear();
    if (shape.resistance_force) barrier.resistance.force_per_metre = *shape.resistance_force;
    if (shape.resistance_pressure) barrier.resistance.pressure = *shape.resistance_pressure;
    const double part_length = std::max(usual_part, length_of(line) / max_parts);
    double roofs = 0, heights = 0, chainage = 0, highest = 0;
    for (std::size_t k = 0; k + 1 < line.size(); ++k) {
        const PlanPoint &a = line[k], &b = line[k + 1], &ma = mitres[k], &mb = mitres[k + 1];
        const PlanPoint left_a{a.x + ma.x, a.y + ma.y}, left_b{b.x + mb.x, b.y + mb.y};
        const PlanPoint right_a{a.x - ma.x, a.y - ma.y}, right_b{b.x - mb.x, b.y - mb.y};
        const double length = distance(a, b);
        if (dot(left_b - left_a, b - a) <= 0 || dot(right_b - right_a, b - a) <= 0) {
            return Error{
                fmt::format("thickness_m = {:.6g}: too thick for the bends at points {} and {}, {:.3g} m apart",
                            shape.thickness, k + 1, k + 2, length)};
        }
        const std::vector<double> cuts = find_cuts(shape, chainage, chainage + length, part_length);
        for (std::size_t p = 0; p + 1 < cuts.size(); ++p) {
            const double from = cuts[p], to = cuts[p + 1];
            double ground = 0;
            for (const double share : {from, (from + to) / 2, to}) {
                ground += terrain.elevation_at(between(a, b, share)) / 3;
            }
            if (std::isnan(ground)) {
                const PlanPoint middle = between(a, b, (from + to) / 2);
                return Error{fmt::format("line: leaves the known ground at ({}, {}), between points {} and {}",
                                         coordinate_text(middle.x), coordinate_text(middle.y), k + 1, k + 2)};
            }
            double roof = shape.crest_elevation.value_or(ground + shape.height.value_or(0));
            highest = std::max(highest, roof - ground);
            if (const params::BarrierOpeningSpec* opening = opening_at(shape, chainage + (from + to) / 2 * length)) {
                if (!(opening->sill > 0)) continue;
                roof = std::min(roof, ground + opening->sill);
            }
            barrier.footprint.push_back({{between(right_a, right_b, from), between(right_a, right_b, to),
                                          between(left_a, left_b, to), between(left_a, left_b, from)},
                                         {}});
            barrier.part_roof_elevations.push_back(roof);
            roofs += roof;
            heights += roof - ground;
        }
        chainage += length;
    }
    if (barrier.footprint.empty()) return Error{"openings: nothing of the barrier is left between them"};
    if (!(highest > 0)) {
        return Error{fmt::format("crest_elevation_m = {:.6g}: lies below the ground all along the line",
                                 shape.crest_elevation.value_or(0))};
    }
    const auto parts = static_cast<double>(barrier.footprint.size());
    barrier.roof_elevation = roofs / parts;
    barrier.height = shape.crest_elevation ? heights / parts : shape.height.value_or(0);
    return barrier;
}

double length_of(const std::vector<PlanPoint>& line) {
    double length = 0;
    for (std::size_t k = 0; k + 1 < line.size(); ++k) length += distance(line[k], line[k + 1]);
    return length;
}

bool segments_meet(const PlanPoint& a, const PlanPoint& b, const PlanPoint& c, const PlanPoint& d) {
    const auto side = [](const PlanPoint& p, const PlanPoint& q, const PlanPoint& r) {
        const double value = cross(q - p, r - p);
        return value > 0 ? 1 : value < 0 ? -1 : 0;
    };
    const auto in_box = [](const PlanPoint& p, const PlanPoint& q, const PlanPoint& r) {
        return r.x >= std::min(p.x, q.x) && r.x <= std::max(p.x, q.x) && r.y >= std::min(p.y, q.y) &&
               r.y <= std::max(p.y, q.y);
    };
    const int c_side = side(a, b, c), d_side = side(a, b, d), a_side = side(c, d, a), b_side = side(c, d, b);
    if (c_side * d_side < 0 && a_side * b_side < 0) return true;
    return (c_side == 0 && in_box(a, b, c)) || (d_side == 0 && in_box(a, b, d)) || (a_side == 0 && in_box(c, d, a)) ||
           (b_side == 0 && in_box(c, d, b));
}

bool meets_itself(const Ring& ring) {
    const std::size_t n = ring.size();
    for (std::size_t i = 0; i < n; ++i) {
        const PlanPoint &a = ring[i], &b = ring[(i + 1) % n], &next = ring[(i + 2) % n];
        if (distance(a, b) == 0) return true;
        if (cross(b - a, next - b) == 0 && dot(b - a, next - b) < 0) return true;  // back on itself
        for (std::size_t k = i + 2; k < n; ++k) {
            if (i == 0 && k == n - 1) continue;
            if (segments_meet(a, b, ring[k], ring[(k + 1) % n])) return true;
        }
    }
    return false;
}

}  // namespace talus::terrain
