#include "run/grid_fault.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/number_or_null.hpp"
#include "sim/fault.hpp"

namespace talus::run {
namespace {

using nlohmann::json;

/// The first cell that is not finite; where all are, the fastest.
struct BadCells {
    std::optional<std::pair<int, int>> cell;  ///< column, row
    std::uint64_t count = 0;                  ///< of those that are not finite
};

BadCells find_bad(const depth::Solver& solver) {
    BadCells bad;
    std::optional<std::pair<int, int>> fastest;
    float largest = -1;
    for (int row = 0; row < solver.geometry().rows; ++row) {
        for (int column = 0; column < solver.geometry().columns; ++column) {
            const float u = solver.u_at(column, row), v = solver.v_at(column, row), square = u * u + v * v;
            if (!std::isfinite(solver.depth_at(column, row)) || !std::isfinite(u) || !std::isfinite(v)) {
                if (bad.count++ == 0) bad.cell = {column, row};
            } else if (square > largest) {
                largest = square;
                fastest = {column, row};
            }
        }
    }
    if (!bad.cell) bad.cell = fastest;
    return bad;
}

GridState::Cell cell_of(const GridState& state, int column, int row) {
    const auto before = [](const GridState::Cell& cell, std::pair<int, int> place) {
        return std::pair(cell.row, cell.column) < place;
    };
    const auto found = std::lower_bound(state.cells.begin(), state.cells.end(), std::pair(row, column), before);
    if (found != state.cells.end() && found->column == column && found->row == row) return *found;
    return {column, row};
}

json cell_json(const GridState::Cell& cell, const Grid<double>& bed) {
    const PlanPoint centre = bed.geometry.centre(cell.column, cell.row);
    return {{"column", cell.column},
            {"row", cell.row},
            {"x_m", centre.x},
            {"y_m", centre.y},
            {"ground_m", number_or_null<json>(bed.at(cell.column, cell.row))},
            {"depth_m", cell.depth},
            {"u_mps", cell.u},
            {"v_mps", cell.v}};
}

std::string state_table(const GridState& state, const GridGeometry& grid) {
    std::string text = "column,row,x_m,y_m,depth_m,u_mps,v_mps\n";
    for (const GridState::Cell& cell : state.cells) {
        const PlanPoint centre = grid.centre(cell.column, cell.row);
        text += fmt::format("{},{},{},{},{},{},{}\n", cell.column, cell.row, centre.x, centre.y, cell.depth, cell.u,
                            cell.v);
    }
    return text;
}

}  // namespace

GridState::GridState(const depth::Solver& solver) : time(solver.time()), step(solver.steps()) {
    for (int r = 0; r < solver.geometry().rows; ++r) {
        const depth::CellRow row = solver.row(r);
        depth::for_each_deeper(row, 0, [&](int column) {
            cells.push_back({column, r, row.depth[column], row.u[column], row.v[column]});
        });
    }
}

Status find_grid_fault(const depth::Solver& solver, const observe::GridObserver& observer) {
    const double bound = sim::speed_margin * observer.greatest_speed() + 1;
    // The next step says whether anything is as fast, without a look at the cells.
    if (!(solver.next_step(std::numeric_limits<double>::max()) < solver.stable_step(bound))) return {};
    const double fastest = observer.fastest(solver);
    if (!(fastest > bound)) return {};
    return Error{
        fmt::format("at t = {:.4g} s debris of the depth-averaged model moves at {:.4g} m/s, more than its fall can "
                    "explain ({:.4g} m/s): check the terrain for single cells that stand out, or choose another "
                    "solver.grid_cell_m",
                    solver.time(), fastest, bound)};
}

FaultRecord record_grid_fault(const Grid<double>& bed, const GridState& good, const depth::Solver& bad,
                              const std::string& reason) {
    const GridGeometry& grid = bed.geometry;
    const BadCells found = find_bad(bad);
    FaultRecord record;
    record.state_table = state_table(good, grid);
    record.content = {{"fault", reason},
                      {"time_s", bad.time()},
                      {"step", bad.steps()},
                      {"last_good", {{"time_s", good.time}, {"step", good.step}, {"cells", good.cells.size()}}},
                      {"cells_not_finite", found.count},
                      {"cell", nullptr}};
    if (!found.cell) return record;

    const auto [column, row] = *found.cell;
    const GridState::Cell cell = cell_of(good, column, row);
    constexpr std::array<std::pair<std::string_view, std::pair<int, int>>, 4> sides{
        {{"west", {-1, 0}}, {"east", {1, 0}}, {"south", {0, -1}}, {"north", {0, 1}}}};
    json neighbours = json::array();
    std::string depths;
    for (const auto& [side, offset] : sides) {
        const int c = column + offset.first, r = row + offset.second;
        if (c < 0 || c >= grid.columns || r < 0 || r >= grid.rows) continue;
        const GridState::Cell neighbour = cell_of(good, c, r);
        json entry = cell_json(neighbour, bed);
        entry["side"] = side;
        neighbours.push_back(std::move(entry));
        depths += fmt::format("{}{:.3g} m {}", depths.empty() ? "" : ", ", neighbour.depth, side);
    }
    const PlanPoint centre = grid.centre(column, row);
    record.sentence = fmt::format(
        "; the cell in column {} and row {} of the grid from its south-west corner{}, at ({:.2f}, {:.2f}), had {:.3g} "
        "m "
        "of debris at {:.3g} m/s at t = {:.4g} s, and beside it {}",
        column, row, found.count > 1 ? fmt::format(", the first of {}", found.count) : "", centre.x, centre.y,
        cell.depth, std::hypot(cell.u, cell.v), good.time, depths);
    record.content["cell"] = cell_json(cell, bed);
    record.content["cell"]["neighbours"] = std::move(neighbours);
    return record;
}

}  // namespace talus::run
