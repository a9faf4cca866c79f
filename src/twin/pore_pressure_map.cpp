#include "twin/pore_pressure_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "sim/physics/resistance.hpp"

namespace talus::twin {
namespace {

struct Mean {
    double sum = 0, count = 0;
};

std::uint8_t whole(const Mean& mean) {
    if (!(mean.count > 0)) return no_pore_pressure;
    return static_cast<std::uint8_t>(
        std::clamp(std::round(mean.sum / mean.count / pore_pressure_step), 0.0, no_pore_pressure - 1.0));
}

double ratio_of(const sim::Model& model, const sim::State& state, std::uint32_t id) {
    if (model.evolving_pressure.on) {
        return static_cast<double>(soil_of(model, state.soil_of_id, state.entry_of_id, id).pressure_ratio);
    }
    return 1 - share_of_grains(model, state, id, state.time);
}

}  // namespace

bool knows_pore_pressure(const sim::Model& model) {
    return model.evolving_pressure.on || has_pore_pressure(model);
}

std::vector<std::uint8_t> pore_pressure_map(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
                                            const Grid<float>& depth) {
    if (!knows_pore_pressure(model)) return {};
    const GridGeometry& g = depth.geometry;
    const WorldPoint& origin = ground.terrain.frame().origin;
    std::vector<Mean> means(depth.values.size());
    for (std::uint32_t i = 0; i < state.count; ++i) {
        if (state.held[i] != 0) continue;
        const LocalPoint p = state.position.at(i);
        const double column = std::floor((origin.x + static_cast<double>(p.x) - g.x_min) / g.cell),
                     row = std::floor((origin.y + static_cast<double>(p.y) - g.y_min) / g.cell);
        if (!(column >= 0 && row >= 0 && column < g.columns && row < g.rows)) continue;
        Mean& mean = means[static_cast<std::size_t>(row) * static_cast<std::size_t>(g.columns) +
                           static_cast<std::size_t>(column)];
        mean.sum += ratio_of(model, state, state.id[i]);
        ++mean.count;
    }
    std::vector<std::uint8_t> map(means.size(), no_pore_pressure);
    const int columns = g.columns, rows = g.rows;
    const auto index = [columns](int column, int row) {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
    };
    const auto around = [&](int column, int row) {
        Mean mean;
        for (int r = std::max(0, row - 1); r <= std::min(rows - 1, row + 1); ++r) {
            for (int c = std::max(0, column - 1); c <= std::min(columns - 1, column + 1); ++c) {
                mean.sum += means[index(c, r)].sum;
                mean.count += means[index(c, r)].count;
            }
        }
        return mean;
    };
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            if (!(depth.values[index(column, row)] > 0)) continue;
            const Mean& own = means[index(column, row)];
            map[index(column, row)] = whole(own.count > 0 ? own : around(column, row));
        }
    }
    return map;
}

}  // namespace talus::twin
