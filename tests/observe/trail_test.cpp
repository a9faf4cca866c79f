#include "observe/trail.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace talus::observe {
namespace {

constexpr double cell = 2;  // m
constexpr double unconnected = std::numeric_limits<double>::infinity();

/// A map of covered cells, `#`; `o` is covered, too. From north to south.
class Map {
  public:
    explicit Map(const std::vector<std::string>& rows) : rows_(rows) {
        const auto columns = static_cast<int>(rows.front().size()), count = static_cast<int>(rows.size());
        grid_ = Grid<float>(GridGeometry{900, 1900, cell, columns, count}, std::nanf(""));
        for (int r = 0; r < count; ++r) {
            for (int c = 0; c < columns; ++c) {
                if (sign(c, r) != '.') grid_.at(c, r) = 1;
            }
        }
    }
    [[nodiscard]] const Grid<float>& grid() const { return grid_; }
    [[nodiscard]] const GridGeometry& geometry() const { return grid_.geometry; }
    /// Row 0 is the southern one, as in the grid.
    [[nodiscard]] char sign(int column, int row) const {
        return rows_[rows_.size() - 1 - static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
    }
    [[nodiscard]] char sign(std::size_t k) const {
        const auto columns = static_cast<std::size_t>(geometry().columns);
        return sign(static_cast<int>(k % columns), static_cast<int>(k / columns));
    }
    [[nodiscard]] bool covered(std::size_t k) const { return sign(k) != '.'; }
    [[nodiscard]] PlanPoint centre(std::size_t k) const {
        const auto columns = static_cast<std::size_t>(geometry().columns);
        return geometry().centre(static_cast<int>(k % columns), static_cast<int>(k / columns));
    }
    [[nodiscard]] std::vector<std::size_t> cells(char with) const {
        std::vector<std::size_t> found;
        for (std::size_t k = 0; k < geometry().size(); ++k) {
            if (sign(k) == with) found.push_back(k);
        }
        return found;
    }
    [[nodiscard]] Map without(char which) const {
        std::vector<std::string> rows = rows_;
        for (std::string& row : rows) std::replace(row.begin(), row.end(), which, '.');
        return Map(rows);
    }

  private:
    std::vector<std::string> rows_;
    Grid<float> grid_;
};

double apart(const PlanPoint& a, const PlanPoint& b) {
    return std::hypot(a.x - b.x, a.y - b.y);
}

/// Whether the line from a to b passes through the inside of a square.
bool crosses(const PlanPoint& a, const PlanPoint& b, const PlanPoint& middle) {
    constexpr double half = cell / 2 - 1e-6;
    double enters = 0, leaves = 1;
    for (const auto& [from, to, centre] : {std::array{a.x, b.x, middle.x}, std::array{a.y, b.y, middle.y}}) {
        const double step = to - from;
        if (std::abs(step) < 1e-12) {
            if (std::abs(from - centre) >= half) return false;
            continue;
        }
        const double one = (centre - half - from) / step, other = (centre + half - from) / step;
        enters = std::max(enters, std::min(one, other));
        leaves = std::min(leaves, std::max(one, other));
    }
    return enters < leaves;
}

/// Shortest ways from a cell to all that are connected with it, independent of the program's: over every pair of
/// covered cells between which the straight line crosses no other ground (a visibility graph), by Bellman and Ford's
/// relaxation.
std::vector<double> shortest_ways(const Map& map, std::size_t first) {
    const std::vector<std::size_t> dry = map.cells('.');
    std::vector<std::size_t> cells;
    for (std::size_t k = 0; k < map.geometry().size(); ++k) {
        if (map.covered(k)) cells.push_back(k);
    }
    const auto visible = [&](std::size_t a, std::size_t b) {
        const PlanPoint p = map.centre(a), q = map.centre(b);
        if (apart(p, q) < 1.5 * cell) return true;  // neighbours, also across a corner
        return std::none_of(dry.begin(), dry.end(), [&](std::size_t k) { return crosses(p, q, map.centre(k)); });
    };
    struct Line {
        std::size_t a, b;
        double length;
    };
    std::vector<Line> lines;
    for (const std::size_t a : cells) {
        for (const std::size_t b : cells) {
            if (a < b && visible(a, b)) lines.push_back({a, b, apart(map.centre(a), map.centre(b))});
        }
    }
    std::vector<double> ways(map.geometry().size(), unconnected);
    ways[first] = 0;
    for (bool shorter = true; shorter;) {
        shorter = false;
        for (const Line& line : lines) {
            for (const auto& [from, to] : {std::pair{line.a, line.b}, std::pair{line.b, line.a}}) {
                if (!(ways[from] + line.length < ways[to] - 1e-9)) continue;
                ways[to] = ways[from] + line.length;
                shorter = true;
            }
        }
    }
    return ways;
}

/// Down the left arm, round the bottom, up the right one, with dry ground of six cells between.
const std::vector<std::string> hairpin = {
    "###......###",  //
    "#S#......###",  //
    "###......###",  //
    "###......###",  //
    "###......###",  //
    "###......###",  //
    "###......###",  //
    "############",  //
    "############",  //
    ".##########.",  //
};

const std::vector<std::string> fork = {
    "..........####...",  //
    "........#####....",  //
    ".......####......",  //
    "S########........",  //
    "########.........",  //
    "#########........",  //
    "......#####......",  //
    "........####.....",  //
    "..........####...",  //
    "...........#####.",  //
    ".............####",  //
};

void expect_shortest_ways(const std::vector<std::string>& rows) {
    const Map map(rows);
    const std::size_t first = map.cells('S').front();
    const std::vector<double> expected = shortest_ways(map, first);
    const TrailDistances ways(map.grid(), map.centre(first));
    for (std::size_t k = 0; k < expected.size(); ++k) {
        if (!map.covered(k)) {
            EXPECT_TRUE(std::isnan(ways.at(k))) << k;
            continue;
        }
        // Lines may graze the corner of a dry cell, by less than half of it, and bends lie at cell centres.
        EXPECT_NEAR(ways.at(k), expected[k], 0.01 * expected[k] + 1e-9) << k;
    }
}

TEST(TrailDistances, are_the_shortest_ways_round_a_bend) {
    expect_shortest_ways(hairpin);
}

TEST(TrailDistances, are_the_shortest_ways_into_both_arms_of_a_fork) {
    expect_shortest_ways(fork);
}

/// `rows` with islands: what they change elsewhere, which is nothing.
TrailDistances with_islands(const Map& map) {
    const std::size_t first = map.cells('S').front();
    TrailDistances ways(map.grid(), map.centre(first));
    const TrailDistances alone(map.without('o').grid(), map.centre(first));
    for (std::size_t k = 0; k < map.geometry().size(); ++k) {
        if (map.covered(k) && map.sign(k) != 'o') {
            EXPECT_EQ(ways.at(k), alone.at(k)) << k;
        }
    }
    return ways;
}

TEST(TrailDistances, change_nowhere_because_of_an_isolated_cell) {
    std::vector<std::string> rows = hairpin;
    rows[1][7] = 'o';  // a cell of dry ground from the right arm
    const Map map(rows);
    const TrailDistances ways = with_islands(map);
    const std::size_t island = map.cells('o').front();
    const std::vector<double> expected = shortest_ways(map.without('o'), map.cells('S').front());
    const double by_the_arm = expected[island + 2] + 2 * cell;
    EXPECT_NEAR(ways.at(island), by_the_arm, 0.01 * by_the_arm);
    EXPECT_GT(ways.at(island), 2.5 * apart(map.centre(island), map.centre(map.cells('S').front())));
}

TEST(TrailDistances, lead_to_an_island_beyond_another_over_that_one) {
    std::vector<std::string> rows = hairpin;
    rows[1] = "#S#..o.o.###";  // the left of them lies as near to the left arm
    rows[3] = "###..o...###";  // and is no way to this one
    const Map map(rows);
    const TrailDistances ways = with_islands(map);
    const auto at = [&](int column, int row) { return ways.at(map.geometry().index(column, row)); };
    EXPECT_NEAR(at(7, 8), at(9, 8) + 2 * cell, 1e-9);
    EXPECT_NEAR(at(5, 8), at(7, 8) + 2 * cell, 1e-9);
    EXPECT_NEAR(at(5, 6), at(5, 8) + 2 * cell, 1e-9);
}

TEST(TrailDistances, do_not_go_back_along_an_island_beside_the_trail) {
    const Map map({
        "..ooooooooooooooo.",  //
        ".................o",  //
        "..................",  //
        "S#################",  //
    });
    const TrailDistances ways = with_islands(map);
    const GridGeometry& g = map.geometry();
    for (int c = 2; c < 17; ++c) {
        EXPECT_LT(ways.at(g.index(c, 3)), (c + 4) * cell) << c;
        EXPECT_GT(ways.at(g.index(c, 3)), std::hypot(c, 3) * cell) << c;
    }
}

TEST(TrailDistances, lead_round_the_bends_of_an_island) {
    std::vector<std::string> rows = hairpin;
    for (int r : {7, 8, 9})
        std::replace(rows[static_cast<std::size_t>(r)].begin(), rows[static_cast<std::size_t>(r)].end(), '#', 'o');
    for (int r = 0; r < 7; ++r) rows[static_cast<std::size_t>(r)].replace(9, 3, "ooo");
    rows[6] = "............";
    rows[6].replace(9, 3, "ooo");
    const Map map(rows);
    const TrailDistances ways = with_islands(map);
    const auto at = [&](int column, int row) { return ways.at(map.geometry().index(column, row)); };
    EXPECT_NEAR(at(1, 2), 6 * cell, 1e-9) << "straight on over a gap of one cell";
    const std::vector<double> whole = shortest_ways(Map(hairpin), map.cells('S').front());
    const double expected = whole[map.geometry().index(10, 9)];
    EXPECT_NEAR(at(10, 9), expected, 2 * cell) << "not over the dry ground between the arms";
}

TEST(TrailDistances, name_the_cell_at_a_distance_on_the_way) {
    const Map map(hairpin);
    const PlanPoint from = map.centre(map.cells('S').front()), to = map.geometry().centre(10, 9);
    const TrailDistances ways(map.grid(), from);
    for (double along = 0.5; along < ways.to(to); along += 1.7) {
        const auto k = ways.cell_on_way(to, along);
        ASSERT_TRUE(k) << along;
        EXPECT_NEAR(ways.at(*k), along, cell) << along;
    }
    const Grid<float> dry(map.geometry(), std::nanf(""));
    EXPECT_FALSE(TrailDistances(dry, from).cell_on_way(to, 5));
    EXPECT_TRUE(std::isnan(TrailDistances(dry, from).to(to)));
}

TEST(TrailDistances, run_straight_over_open_ground) {
    const GridGeometry g{900, 1900, cell, 100, 100};
    const TrailDistances open(Grid<float>(g, 1), {925, 1950});
    for (const PlanPoint& p : {PlanPoint{1090, 1951}, PlanPoint{930, 2090}, PlanPoint{1060, 2033}}) {
        EXPECT_NEAR(open.to(p), apart(p, {925, 1950}), 1e-9);
    }
}

}  // namespace
}  // namespace talus::observe
