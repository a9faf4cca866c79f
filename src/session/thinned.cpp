#include "session/thinned.hpp"

#include <algorithm>

#include "twin/frame.hpp"

namespace talus::session {
namespace {

int reduced(int count, int factor) {
    return (count + factor - 1) / factor;
}

}  // namespace

int thinning(const GridGeometry& grid, double max_cells) {
    int factor = 1;
    while (static_cast<double>(reduced(grid.columns, factor)) * reduced(grid.rows, factor) > max_cells) ++factor;
    return factor;
}

Grid<float> thinned_by(const Grid<float>& whole, int factor) {
    const GridGeometry& from = whole.geometry;
    GridGeometry to = from;
    to.cell = from.cell * factor;
    to.columns = reduced(from.columns, factor);
    to.rows = reduced(from.rows, factor);
    // A value holds at its cell's centre; for an even factor the chosen one is half a cell off the middle.
    const int middle = factor / 2;
    const double shift = (middle + 0.5 - 0.5 * factor) * from.cell;
    to.x_min += shift;
    to.y_min += shift;
    Grid<float> thin(to);
    for (int row = 0; row < to.rows; ++row) {
        for (int column = 0; column < to.columns; ++column) {
            thin.at(column, row) = whole.at(std::min(column * factor + middle, from.columns - 1),
                                            std::min(row * factor + middle, from.rows - 1));
        }
    }
    return thin;
}

std::shared_ptr<const std::string> terrain_message(const Grid<float>& elevation, int factor) {
    return std::make_shared<const std::string>(
        twin::encode_grid(thinned_by(elevation, factor), twin::GridCoding::differences));
}

}  // namespace talus::session
