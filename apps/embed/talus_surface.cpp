// The functions of talus.h that read ground and surface.
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "names.hpp"
#include "products/debris_surface.hpp"

namespace {

using talus::LocalPoint;
using talus::embed::Buffer;

constexpr float thinnest = 0.01F;  // m; thinner debris has no surface of its own

Buffer<float> flat(const std::vector<LocalPoint>& points) {
    Buffer<float> values;
    values.reserve(3 * points.size());
    for (const LocalPoint& p : points) values.insert(values.end(), {p.x, p.y, p.z});
    return values;
}

Answers::Surface surface_of(const Scenario& scenario) {
    const auto present = scenario.run().observer().maps().present();
    if (present.depth.values.empty()) return {};
    // With a border of a cell, on which the surface comes down to the ground.
    const GridGeometry& g = present.depth.geometry;
    const GridGeometry wider{g.x_min - g.cell, g.y_min - g.cell, g.cell, g.columns + 2, g.rows + 2};
    Grid<float> ground(wider), depth(wider), speed(wider);
    const talus::terrain::Terrain& terrain = scenario.run().ground().terrain;
    for (int row = 0; row < wider.rows; ++row) {
        for (int column = 0; column < wider.columns; ++column) {
            const double z = terrain.elevation_at(wider.centre(column, row)) - terrain.frame().origin.z;
            ground.at(column, row) = static_cast<float>(z);
        }
    }
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            const float deep = present.depth.at(column, row);
            if (deep < thinnest) continue;
            depth.at(column + 1, row + 1) = deep;
            speed.at(column + 1, row + 1) = present.speed.at(column, row);
        }
    }
    const auto mesh = talus::products::mesh_debris(terrain.frame(), ground, depth, speed, 0);
    return {flat(mesh.points), flat(mesh.normals), buffer_of(mesh.depth), buffer_of(mesh.speed),
            buffer_of(mesh.corners)};
}

}  // namespace

extern "C" {

int talus_get_elevation(const talus_simulation* simulation, double x, double y, double* elevation, talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_TRY(need(simulation, "simulation"));
        TALUS_TRY(need(elevation, "elevation"));
        for (const auto& [name, value] : {std::pair{"x", x}, std::pair{"y", y}}) {
            if (!std::isfinite(value)) return Error{fmt::format("{} = {}: must be a finite number", name, value)};
        }
        const talus::terrain::Terrain& terrain = simulation->scenario->run().ground().terrain;
        const double z = terrain.elevation_at({x, y});
        if (std::isnan(z)) {
            const talus::Extent known = terrain.elevation().geometry.extent();
            return Error{
                fmt::format("x = {}, y = {}: the ground is not known there; the terrain has x {} to {}, y {} to {}", x,
                            y, known.x_min, known.x_max, known.y_min, known.y_max)};
        }
        *elevation = z;
        return {};
    });
}

int talus_get_elevations(const talus_simulation* simulation, const double* x_y, size_t count, double* elevations,
                         talus_error* error) {
    return guarded(error, [&]() -> Status {
        constexpr std::size_t most = 100'000'000;
        TALUS_TRY(need(simulation, "simulation"));
        TALUS_TRY(need(x_y, "x_y"));
        TALUS_TRY(need(elevations, "elevations"));
        if (count > most) return Error{fmt::format("count = {}: must be at most {}", count, most)};
        for (std::size_t i = 0; i < 2 * count; ++i) {
            if (!std::isfinite(x_y[i])) return Error{fmt::format("x_y[{}] = {}: must be a finite number", i, x_y[i])};
        }
        const talus::terrain::Terrain& terrain = simulation->scenario->run().ground().terrain;
        for (std::size_t i = 0; i < count; ++i) elevations[i] = terrain.elevation_at({x_y[2 * i], x_y[2 * i + 1]});
        return {};
    });
}

int talus_get_surface(const talus_simulation* simulation, talus_surface* surface, talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_TRY(need(simulation, "simulation"));
        TALUS_TRY(check_size(surface, "surface"));
        std::optional<Answers::Surface>& made = simulation->answers.surface;
        if (!made) made = surface_of(*simulation->scenario);
        give<talus_surface>({0, made->depth.size(), made->positions.data(), made->normals.data(), made->depth.data(),
                             made->speed.data(), made->indices.size(), made->indices.data()},
                            surface);
        return {};
    });
}

}  // extern "C"
