#include "twin/zone_blocks.hpp"

#include <algorithm>

#include <gmock/gmock.h>

#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

/// A zone of the cells of the channel's terrain that `wanted` chooses, as a raster gives them.
template <class Wanted>
scene::Zone wood(const GridGeometry& terrain, const Wanted& wanted) {
    auto cells = std::make_shared<scene::ZoneCells>();
    for (int row = 0; row < terrain.rows; ++row) {
        for (int column = 0; column < terrain.columns; ++column) {
            if (!wanted(column, row)) continue;
            cells->cell.push_back(terrain.index(column, row));
            cells->value.push_back(1);
        }
    }
    scene::Zone zone;
    zone.spec.name = "wood";
    zone.spec.stem_density = 0.1;
    zone.cells = cells;
    return zone;
}

TEST(ZoneBlocks, cover_the_cells_of_a_raster_and_nothing_else) {
    const scene::Scene scene = channel_scene();
    const GridGeometry& terrain = scene.terrain.elevation().geometry;
    const auto in_ring = [](int column, int row) {
        return column >= 20 && column < 50 && row >= 10 && row < 40 && !(column >= 30 && column < 35 && row == 20);
    };
    const auto blocks = blocks_of(wood(terrain, in_ring), terrain);
    EXPECT_EQ(blocks.size(), 4U) << "below the gap, on both sides of it, above it";
    for (int row = 0; row < terrain.rows; ++row) {
        for (int column = 0; column < terrain.columns; ++column) {
            const PlanPoint p = terrain.centre(column, row);
            const auto covering =
                std::count_if(blocks.begin(), blocks.end(), [&](const Extent& block) { return block.contains(p); });
            ASSERT_EQ(covering, in_ring(column, row) ? 1 : 0) << column << ", " << row;
        }
    }
}

TEST(ZoneBlocks, are_coarser_where_there_would_be_too_many) {
    const scene::Scene scene = channel_scene();
    const GridGeometry& terrain = scene.terrain.elevation().geometry;
    const auto chequered = [](int column, int row) { return (column + row) % 2 == 0; };
    const auto blocks = blocks_of(wood(terrain, chequered), terrain, 50);
    ASSERT_FALSE(blocks.empty());
    EXPECT_LE(blocks.size(), 50U);
    double area = 0;
    for (const Extent& block : blocks) area += block.width() * block.height();
    EXPECT_GE(area, 0.5 * 120 * 60) << "half of the ground is forest";
}

TEST(ZoneBlocks, are_told_of_a_forest_from_a_raster_alone) {
    scene::Scene scene = channel_scene();
    const GridGeometry terrain = scene.terrain.elevation().geometry;
    scene.zones.push_back(wood(terrain, [](int column, int) { return column >= 60 && column < 80; }));
    scene.zones.push_back(scene.zones.front());
    scene.zones.back().spec.stem_density = 0;
    scene.zones.back().spec.friction_coefficient = 0.4;
    const auto scenario = open(std::move(scene));
    const json zones = setup_json(*scenario)["zones"];
    EXPECT_EQ(zones[0]["blocks"], json({{west + 60, south, 20, 60}}));
    EXPECT_TRUE(zones[0]["polygons"].empty());
    EXPECT_FALSE(zones[1].contains("blocks")) << zones[1];
    EXPECT_EQ(setup_json(*scenario)["zones"], zones) << "as they were found before";
    act(*scenario, {{"action", "remove_zone"}, {"id", zones[0]["id"]}});
    EXPECT_FALSE(setup_json(*scenario)["zones"][0].contains("blocks"));
    act(*scenario, {{"action", "undo"}});
    EXPECT_EQ(setup_json(*scenario)["zones"], zones);
}

}  // namespace
}  // namespace talus::twin::test
