#include "terrain/buildings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace talus::terrain {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double touching = 1e-6;  ///< m, walls closer than this touch

double signed_area(const Ring& ring) {
    double twice = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const PlanPoint &a = ring[i], &b = ring[(i + 1) % ring.size()];
        twice += (a.x - ring[0].x) * (b.y - ring[0].y) - (b.x - ring[0].x) * (a.y - ring[0].y);
    }
    return twice / 2;
}

/// Appends the ring's edges, turned so that the solid lies to their left: outer rings run counter-clockwise, holes not.
template <class Edge>
void append_edges(const Ring& world, const LocalFrame& frame, bool hole, std::vector<Edge>& edges) {
    Ring ring;
    for (const PlanPoint& p : world) {
        const PlanPoint local{p.x - frame.origin.x, p.y - frame.origin.y};
        if (ring.empty() || ring.back().x != local.x || ring.back().y != local.y) ring.push_back(local);
    }
    while (ring.size() > 1 && ring.front().x == ring.back().x && ring.front().y == ring.back().y) ring.pop_back();
    if (ring.size() < 3) return;
    if ((signed_area(ring) < 0) != hole) std::reverse(ring.begin(), ring.end());
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const PlanPoint &a = ring[i], &b = ring[(i + 1) % ring.size()];
        edges.push_back({a.x, a.y, b.x, b.y, -infinity});
    }
}

/// Appends the parameters in (0, 1) at which edge `e` meets another edge or its start.
template <class Edge>
void append_meeting_points(const Edge& e, const Edge& other, std::vector<double>& at) {
    const double dx = e.bx - e.ax, dy = e.by - e.ay, length = std::hypot(dx, dy);
    const double rx = other.ax - e.ax, ry = other.ay - e.ay;
    const auto append = [&](double t) {
        if (t * length > touching && (1 - t) * length > touching) at.push_back(t);
    };
    if (std::abs(rx * dy - ry * dx) <= touching * length) append((rx * dx + ry * dy) / (length * length));
    const double ox = other.bx - other.ax, oy = other.by - other.ay, cross = dx * oy - dy * ox;
    if (cross == 0) return;
    const double s = (rx * dy - ry * dx) / cross;
    if (s >= 0 && s <= 1) append((rx * oy - ry * ox) / cross);
}

double mean_ground(const Terrain& terrain, const std::vector<Polygon>& footprint) {
    double sum = 0, area = 0;
    const auto add = [&](const PlanPoint& p, double weight) {
        const double z = terrain.elevation_at(p);
        if (std::isnan(z)) return;
        sum += weight * z;
        area += weight;
    };
    for (const Polygon& part : footprint) {
        const Extent extent = extent_of(part);
        const double size = std::max(extent.width(), extent.height());
        const double step = std::max(std::min(terrain.cell() / 2, size / 32), size / 512);
        if (!(step > 0)) continue;
        const int columns = static_cast<int>(std::ceil(extent.width() / step));
        const int rows = static_cast<int>(std::ceil(extent.height() / step));
        const double dx = extent.width() / columns, dy = extent.height() / rows;
        for (int r = 0; r < rows; ++r) {
            for (int c = 0; c < columns; ++c) {
                const PlanPoint p{extent.x_min + (c + 0.5) * dx, extent.y_min + (r + 0.5) * dy};
                if (contains(part, p)) add(p, dx * dy);
            }
        }
    }
    if (area == 0) {  // too thin for any sample
        for (const Polygon& part : footprint) {
            for (const PlanPoint& p : part.outer) add(p, 1);
        }
    }
    return area > 0 ? sum / area : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

bool stands(const Building& building) {
    return std::isfinite(building.roof_elevation) || !building.part_roof_elevations.empty();
}

Building without_solid(Building building) {
    building.roof_elevation = std::numeric_limits<double>::quiet_NaN();
    building.part_roof_elevations.clear();
    return building;
}

Extent extent_of(const Building& building) {
    Extent extent = extent_of(building.footprint.front());
    for (const Polygon& part : building.footprint) {
        const Extent e = extent_of(part);
        extent.include({e.x_min, e.y_min});
        extent.include({e.x_max, e.y_max});
    }
    return extent;
}

void place_buildings(const Terrain& terrain, std::vector<Building>& buildings) {
    for (Building& building : buildings) {
        building.roof_elevation = mean_ground(terrain, building.footprint) + building.height;
    }
}

BuildingSolids::BuildingSolids(const Terrain& terrain, const std::vector<Building>& buildings, double range)
    : range_(range) {
    // A solid per part of a footprint: parts may touch or overlap like different buildings.
    for (std::size_t b = 0; b < buildings.size(); ++b) {
        const Building& building = buildings[b];
        for (std::size_t p = 0; p < building.footprint.size(); ++p) {
            const Polygon& part = building.footprint[p];
            const double elevation =
                building.part_roof_elevations.empty() ? building.roof_elevation : building.part_roof_elevations[p];
            const double roof = elevation - terrain.frame().origin.z;
            if (!std::isfinite(roof)) continue;
            double floor = -infinity;
            if (building.barrier && building.barrier->clearance) {
                floor = mean_ground(terrain, {part}) + *building.barrier->clearance - terrain.frame().origin.z;
                if (!(floor < roof)) continue;
            }
            const std::size_t first = edges_.size();
            append_edges(part.outer, terrain.frame(), false, edges_);
            if (edges_.size() == first) continue;
            for (const Ring& hole : part.holes) append_edges(hole, terrain.frame(), true, edges_);
            Solid solid{static_cast<std::uint32_t>(first),
                        static_cast<std::uint32_t>(edges_.size()),
                        static_cast<int>(b),
                        edges_[first].ax,
                        edges_[first].ay,
                        edges_[first].ax,
                        edges_[first].ay,
                        floor,
                        roof,
                        building.barrier ? static_cast<float>(building.barrier->passing_share.value_or(0)) : 0};
            for (std::size_t e = first; e < edges_.size(); ++e) {
                solid.x_min = std::min(solid.x_min, edges_[e].ax);
                solid.y_min = std::min(solid.y_min, edges_[e].ay);
                solid.x_max = std::max(solid.x_max, edges_[e].ax);
                solid.y_max = std::max(solid.y_max, edges_[e].ay);
            }
            solids_.push_back(solid);
        }
    }
    split_walls();
    fill_bins();
}

/// Cuts every wall where other solids meet it and stores up to which height each piece is hidden by them. Without this,
/// debris inside one of two terraced houses would be pushed through their common wall into the other, and back.
void BuildingSolids::split_walls() {
    std::vector<Edge> pieces;
    std::vector<Solid> solids = solids_;
    std::vector<std::uint32_t> near;
    std::vector<double> cuts;
    for (std::size_t s = 0; s < solids_.size(); ++s) {
        const Solid& solid = solids_[s];
        near.clear();
        for (std::uint32_t o = 0; o < solids_.size(); ++o) {
            const Solid& other = solids_[o];
            if (o != s && other.x_min <= solid.x_max + touching && other.x_max >= solid.x_min - touching &&
                other.y_min <= solid.y_max + touching && other.y_max >= solid.y_min - touching) {
                near.push_back(o);
            }
        }
        // Where many overlap, the highest of those that hide a piece are found first, and most of the others need no
        // test.
        std::sort(near.begin(), near.end(),
                  [&](std::uint32_t a, std::uint32_t b) { return solids_[a].roof > solids_[b].roof; });
        solids[s].first_edge = static_cast<std::uint32_t>(pieces.size());
        for (std::uint32_t i = solid.first_edge; i < solid.last_edge; ++i) {
            const Edge& edge = edges_[i];
            const double dx = edge.bx - edge.ax, dy = edge.by - edge.ay, length = std::hypot(dx, dy);
            cuts.assign({0.0, 1.0});
            for (const std::uint32_t o : near) {
                for (std::uint32_t k = solids_[o].first_edge; k < solids_[o].last_edge; ++k) {
                    append_meeting_points(edge, edges_[k], cuts);
                }
            }
            std::sort(cuts.begin(), cuts.end());
            // Two solids that meet the wall at one place give two cuts that differ by rounding: no piece lies between.
            const auto same = [&](double a, double b) { return (b - a) * length <= touching; };
            cuts.erase(std::unique(cuts.begin(), cuts.end(), same), cuts.end());
            for (std::size_t c = 0; c + 1 < cuts.size(); ++c) {
                Edge piece{edge.ax + cuts[c] * dx, edge.ay + cuts[c] * dy, edge.ax + cuts[c + 1] * dx,
                           edge.ay + cuts[c + 1] * dy, -infinity};
                if (cuts[c + 1] == 1) piece.bx = edge.bx, piece.by = edge.by;
                const double outside_x = (piece.ax + piece.bx) / 2 + 2 * touching * dy / length;
                const double outside_y = (piece.ay + piece.by) / 2 - 2 * touching * dx / length;
                for (const std::uint32_t o : near) {
                    const Solid& other = solids_[o];
                    const bool hides_as_net = other.passing_share > solid.passing_share;
                    if (other.roof <= (hides_as_net ? piece.hidden_by_nets : piece.hidden_below) &&
                        !(hides_as_net && other.passing_share > piece.net_share)) {
                        continue;  // adds nothing
                    }
                    if (!walls().in_plan(other, outside_x, outside_y)) continue;
                    if (other.floor > solid.floor && solid.floor == -infinity) continue;  // open below it
                    if (hides_as_net) {
                        piece.hidden_by_nets = std::max(piece.hidden_by_nets, other.roof);
                        piece.net_share = std::max(piece.net_share, other.passing_share);
                    } else {
                        piece.hidden_below = std::max(piece.hidden_below, other.roof);
                    }
                }
                pieces.push_back(piece);
            }
        }
        solids[s].last_edge = static_cast<std::uint32_t>(pieces.size());
    }
    edges_ = std::move(pieces);
    solids_ = std::move(solids);
}

void BuildingSolids::fill_bins() {
    std::vector<Extent> extents;
    for (const Solid& solid : solids_) {
        extents.push_back(Extent{solid.x_min, solid.y_min, solid.x_max, solid.y_max}.grown(range_));
    }
    constexpr double smallest_bin = 0.25;  // m; in a larger one, particles out of a solid's range look at it too
    bins_ = PlanBins(extents, std::max(range_, smallest_bin));
}

template <class Real>
SolidSample<Real> BuildingSolids::nearest(const Vec3<Real>& p, float grain_rank) const {
    return walls().nearest(p, grain_rank);
}

template <class Real>
SolidSample<Real> BuildingSolids::second_nearest(const Vec3<Real>& p, const SolidSample<Real>& first,
                                                 float grain_rank) const {
    return walls().second_nearest(p, first, grain_rank);
}

template <class Real>
bool BuildingSolids::inside(const Vec3<Real>& p, float grain_rank) const {
    return walls().inside(p, grain_rank);
}

template SolidSample<float> BuildingSolids::nearest(const Vec3<float>&, float) const;
template SolidSample<double> BuildingSolids::nearest(const Vec3<double>&, float) const;
template SolidSample<float> BuildingSolids::second_nearest(const Vec3<float>&, const SolidSample<float>&, float) const;
template SolidSample<double> BuildingSolids::second_nearest(const Vec3<double>&, const SolidSample<double>&,
                                                            float) const;
template bool BuildingSolids::inside(const Vec3<float>&, float) const;
template bool BuildingSolids::inside(const Vec3<double>&, float) const;

}  // namespace talus::terrain
