#include "products/report_relief.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>

namespace talus::report {
namespace {

constexpr float no_data = std::numeric_limits<float>::quiet_NaN();

/// Mean of the cells of a block that have a value.
float block_mean(const Grid<float>& grid, int column, int row, int size) {
    double sum = 0;
    int count = 0;
    for (int r = row; r < std::min(row + size, grid.geometry.rows); ++r) {
        for (int c = column; c < std::min(column + size, grid.geometry.columns); ++c) {
            if (const float v = grid.at(c, r); !std::isnan(v)) {
                sum += v;
                ++count;
            }
        }
    }
    return count > 0 ? static_cast<float>(sum / count) : no_data;
}

/// Light on a cell, 0 to 1; NaN without elevation. Neighbours without one count as level with the cell.
float shade(const Grid<float>& elevation, int column, int row) {
    const float centre = elevation.at(column, row);
    if (std::isnan(centre)) return no_data;
    const auto z = [&](int dc, int dr) {
        const int c = std::clamp(column + dc, 0, elevation.geometry.columns - 1);
        const int r = std::clamp(row + dr, 0, elevation.geometry.rows - 1);
        const float v = elevation.at(c, r);
        return double{std::isnan(v) ? centre : v};
    };
    const double reach = 8 * elevation.geometry.cell;
    const double east = (z(1, 1) + 2 * z(1, 0) + z(1, -1) - z(-1, 1) - 2 * z(-1, 0) - z(-1, -1)) / reach;
    const double north = (z(-1, 1) + 2 * z(0, 1) + z(1, 1) - z(-1, -1) - 2 * z(0, -1) - z(1, -1)) / reach;
    const double flat = 1 / std::sqrt(1 + east * east + north * north);
    // Several lights keep slopes readable that face away from the main one.
    double light = 0;
    for (const auto& [azimuth_deg, weight] : {std::pair{315.0, 0.6}, {270.0, 0.2}, {0.0, 0.2}}) {
        const double azimuth = azimuth_deg * std::numbers::pi / 180, altitude = std::numbers::pi / 4;
        const double towards_light = -east * std::sin(azimuth) - north * std::cos(azimuth);
        const double cosine = flat * (std::cos(altitude) * towards_light + std::sin(altitude));
        light += weight * std::max(0.0, cosine);
    }
    return static_cast<float>(light);
}

}  // namespace

Grid<float> crop(const Grid<float>& grid, const Extent& extent, int longest_side) {
    const GridGeometry& g = grid.geometry;
    const auto first = [&](double edge, double origin, int count) {
        return std::clamp(static_cast<int>(std::floor((edge - origin) / g.cell)) - 1, 0, count - 1);
    };
    const auto last = [&](double edge, double origin, int count) {
        return std::clamp(static_cast<int>(std::ceil((edge - origin) / g.cell)) + 1, 1, count);
    };
    const int c0 = first(extent.x_min, g.x_min, g.columns), c1 = last(extent.x_max, g.x_min, g.columns);
    const int r0 = first(extent.y_min, g.y_min, g.rows), r1 = last(extent.y_max, g.y_min, g.rows);
    const int widest = std::max(c1 - c0, r1 - r0);
    const int step = std::max(1, (widest + longest_side - 1) / longest_side);
    const GridGeometry part{g.x_min + c0 * g.cell, g.y_min + r0 * g.cell, g.cell * step,
                            std::max(1, (c1 - c0 + step - 1) / step), std::max(1, (r1 - r0 + step - 1) / step)};
    Grid<float> out(part, no_data);
    for (int r = 0; r < part.rows; ++r) {
        for (int c = 0; c < part.columns; ++c) out.at(c, r) = block_mean(grid, c0 + c * step, r0 + r * step, step);
    }
    return out;
}

double interpolate(const Grid<float>& grid, const PlanPoint& p) {
    const GridGeometry& g = grid.geometry;
    const double u = (p.x - g.x_min) / g.cell - 0.5, v = (p.y - g.y_min) / g.cell - 0.5;
    const int c = static_cast<int>(std::floor(u)), r = static_cast<int>(std::floor(v));
    const double fu = u - c, fv = v - r;
    double sum = 0, weight = 0;
    for (const auto& [dc, dr, w] :
         {std::tuple{0, 0, (1 - fu) * (1 - fv)}, {1, 0, fu * (1 - fv)}, {0, 1, (1 - fu) * fv}, {1, 1, fu * fv}}) {
        if (c + dc < 0 || c + dc >= g.columns || r + dr < 0 || r + dr >= g.rows) continue;
        if (const float value = grid.at(c + dc, r + dr); !std::isnan(value)) {
            sum += w * value;
            weight += w;
        }
    }
    return weight >= 0.5 ? sum / weight : std::numeric_limits<double>::quiet_NaN();
}

GreyImage hillshade(const Grid<float>& elevation, const Extent& extent, double pixels_per_metre) {
    Grid<float> light(elevation.geometry);
    for (int r = 0; r < light.geometry.rows; ++r) {
        for (int c = 0; c < light.geometry.columns; ++c) light.at(c, r) = shade(elevation, c, r);
    }
    GreyImage image{std::max(1, static_cast<int>(std::lround(extent.width() * pixels_per_metre))),
                    std::max(1, static_cast<int>(std::lround(extent.height() * pixels_per_metre))),
                    {}};
    image.pixels.reserve(2 * static_cast<std::size_t>(image.width) * image.height);
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const PlanPoint p{extent.x_min + (x + 0.5) / image.width * extent.width(),
                              extent.y_max - (y + 0.5) / image.height * extent.height()};
            const double l = interpolate(light, p);
            // Kept light, so that debris, lines and text stand out on it; 64 greys are enough and pack well.
            const double grey = std::isnan(l) ? 255 : 136 + 116 * std::clamp((l - 0.10) / 0.90, 0.0, 1.0);
            image.pixels.push_back(static_cast<std::uint8_t>(std::min(255L, std::lround(grey / 2) * 2)));
            image.pixels.push_back(std::isnan(l) ? 0 : 255);
        }
    }
    return image;
}

std::vector<Contour> contours(const Grid<float>& elevation, double interval) {
    const GridGeometry& g = elevation.geometry;
    float lowest = std::numeric_limits<float>::infinity(), highest = -lowest;
    for (const float v : elevation.values) {
        if (std::isnan(v)) continue;
        lowest = std::min(lowest, v);
        highest = std::max(highest, v);
    }
    std::vector<Contour> out;
    if (!(lowest < highest) || !(interval > 0)) return out;

    // A crossing lies on the edge from a cell centre to its east (2 i) or north (2 i + 1) neighbour.
    struct Links {
        std::array<std::size_t, 2> next{};
        int count = 0;
        bool taken = false;
    };
    for (double level = std::ceil(lowest / interval) * interval; level < highest; level += interval) {
        std::unordered_map<std::size_t, Links> crossings;
        const auto above = [&](int c, int r) { return elevation.at(c, r) >= level; };
        const auto link = [&](std::size_t a, std::size_t b) {
            for (const auto& [from, to] : {std::pair{a, b}, {b, a}}) {
                Links& l = crossings[from];
                if (l.count < 2) l.next[static_cast<std::size_t>(l.count++)] = to;
            }
        };
        for (int r = 0; r + 1 < g.rows; ++r) {
            for (int c = 0; c + 1 < g.columns; ++c) {
                const double sum = double{elevation.at(c, r)} + elevation.at(c + 1, r) + elevation.at(c, r + 1) +
                                   elevation.at(c + 1, r + 1);
                if (std::isnan(sum)) continue;
                const std::size_t south = 2 * g.index(c, r), west = south + 1;
                const std::size_t north = 2 * g.index(c, r + 1), east = 2 * g.index(c + 1, r) + 1;
                const int corners = (above(c, r) ? 1 : 0) | (above(c + 1, r) ? 2 : 0) | (above(c + 1, r + 1) ? 4 : 0) |
                                    (above(c, r + 1) ? 8 : 0);
                switch (corners) {
                    case 1:
                    case 14:
                        link(south, west);
                        break;
                    case 2:
                    case 13:
                        link(south, east);
                        break;
                    case 4:
                    case 11:
                        link(east, north);
                        break;
                    case 8:
                    case 7:
                        link(north, west);
                        break;
                    case 3:
                    case 12:
                        link(west, east);
                        break;
                    case 6:
                    case 9:
                        link(south, north);
                        break;
                    case 5:
                    case 10: {  // a saddle: its middle decides which corners belong together
                        if ((sum / 4 >= level) == (corners == 5)) {
                            link(south, east);
                            link(north, west);
                        } else {
                            link(south, west);
                            link(north, east);
                        }
                        break;
                    }
                    default:
                        break;
                }
            }
        }
        const auto place = [&](std::size_t edge) {
            const int c = static_cast<int>(edge / 2 % static_cast<std::size_t>(g.columns));
            const int r = static_cast<int>(edge / 2 / static_cast<std::size_t>(g.columns));
            const PlanPoint a = g.centre(c, r);
            const bool northward = edge % 2 == 1;
            const double za = elevation.at(c, r), zb = northward ? elevation.at(c, r + 1) : elevation.at(c + 1, r);
            const double t = (level - za) / (zb - za) * g.cell;
            return northward ? PlanPoint{a.x, a.y + t} : PlanPoint{a.x + t, a.y};
        };
        const auto follow = [&](std::size_t edge) {
            Contour contour{level, {}};
            const std::size_t start = edge;
            while (true) {
                Links& l = crossings[edge];
                l.taken = true;
                contour.points.push_back(place(edge));
                std::size_t next = edge;
                for (int k = 0; k < l.count; ++k) {
                    const std::size_t to = l.next[static_cast<std::size_t>(k)];
                    if (!crossings[to].taken) next = to;
                }
                if (next == edge) {
                    const bool closes =
                        l.count == 2 && contour.points.size() > 2 && (l.next[0] == start || l.next[1] == start);
                    if (closes) contour.points.push_back(contour.points.front());
                    break;
                }
                edge = next;
            }
            if (contour.points.size() > 1) out.push_back(std::move(contour));
        };
        // In order of place, not of the hash table, so that the same terrain gives the same page.
        std::vector<std::size_t> edges;
        edges.reserve(crossings.size());
        for (const auto& [edge, links] : crossings) edges.push_back(edge);
        std::sort(edges.begin(), edges.end());
        for (const std::size_t e : edges) {  // open lines from their ends first
            if (crossings[e].count == 1 && !crossings[e].taken) follow(e);
        }
        for (const std::size_t e : edges) {
            if (!crossings[e].taken) follow(e);
        }
    }
    return out;
}

}  // namespace talus::report
