#include <fmt/format.h>
#include <gmock/gmock.h>

#include "support/fixtures.hpp"
#include "terrain/barrier.hpp"
#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

using ::testing::HasSubstr;

/// Across the whole channel, banks included.
json barrier(double x, double height, double thickness = 1.2) {
    return {{"action", "put_barrier"},
            {"line", {{west + x, south + 8}, {west + x + 3, south + 30}, {west + x, south + 52}}},
            {"height_m", height},
            {"thickness_m", thickness}};
}

json barrier_impact(const Scenario& scenario) {
    return impacts_json(scenario)["barriers"][0];
}

TEST(Barrier, follows_the_ground_with_joints_that_leave_no_gap) {
    const scene::Scene scene = channel_scene();
    const std::vector<PlanPoint> line{{west + 30, south + 10}, {west + 40, south + 30}, {west + 28, south + 50}};
    const auto made = make_barrier(scene.terrain, "dam", {line, 3, {}, 1.5});
    ASSERT_TRUE(made);
    ASSERT_EQ(made->footprint.size(), made->part_roof_elevations.size());
    EXPECT_GE(made->footprint.size(), 22U);
    double area = 0;
    for (const Polygon& part : made->footprint) area += plan_area(part);
    EXPECT_NEAR(area, 1.5 * terrain::length_of(line), 0.01 * area);
    const terrain::BuildingSolids solids(scene.terrain, {*made}, 1);
    const WorldPoint origin = scene.terrain.frame().origin;
    for (std::size_t k = 0; k + 1 < line.size(); ++k) {
        for (double share = 0.005; share < 1; share += 0.01) {
            const double x = line[k].x + share * (line[k + 1].x - line[k].x) - origin.x;
            const double y = line[k].y + share * (line[k + 1].y - line[k].y) - origin.y;
            const double ground = scene.terrain.sample(x, y).height;
            EXPECT_TRUE(solids.inside(Vec3<double>{x, y, ground + 2.2})) << x << " " << y;
            EXPECT_FALSE(solids.inside(Vec3<double>{x, y, ground + 3.8})) << x << " " << y;
        }
    }
    // At the outside of the bend, too.
    EXPECT_TRUE(solids.inside(
        Vec3<double>{line[1].x + 0.7 - origin.x, 0, scene.terrain.sample(line[1].x - origin.x, 0.0).height + 1}));
}

TEST(Barrier, higher_than_the_flow_keeps_all_of_it) {
    const auto scenario = open(channel_scene());
    act(*scenario, barrier(55, 6));
    run_until(*scenario, 14);
    ASSERT_NE(scenario->phase(), run::RunPhase::fault) << scenario->message();
    const json impact = barrier_impact(*scenario);
    EXPECT_EQ(impact["hit"], true);
    EXPECT_GT(impact["peak_force_kN"], 10);
    EXPECT_GT(impact["peak_impact_pressure_kPa"], 1);
    EXPECT_GT(impact["first_hit_s"], 1);
    EXPECT_EQ(impact["overtopped_m3"], 0);
    EXPECT_EQ(impact["first_overtopped_s"], nullptr);
    EXPECT_LT(number(*scenario, "front_chainage_m"), 54);
    EXPECT_GT(impact["retained_m3"].get<double>(), 0.5 * number(*scenario, "volume_released_m3"));
    EXPECT_EQ(number(*scenario, "volume_left_m3"), 0);
}

TEST(Barrier, lower_than_the_flow_is_overtopped_by_what_lies_beyond_it) {
    const auto scenario = open(channel_scene());
    act(*scenario, barrier(52, 0.7));
    run_until(*scenario, 14);
    ASSERT_NE(scenario->phase(), run::RunPhase::fault) << scenario->message();
    const json impact = barrier_impact(*scenario);
    const double over = impact["overtopped_m3"];
    EXPECT_GT(over, 2);
    EXPECT_LT(over, number(*scenario, "volume_released_m3"));
    EXPECT_GE(impact["first_overtopped_s"], impact["first_hit_s"]);
    // Nothing can get there but over it.
    const Grid<float> deposit = layer(*scenario, "deposit_depth");
    double beyond = 0;
    for (int row = 0; row < deposit.geometry.rows; ++row) {
        for (int column = 0; column < deposit.geometry.columns; ++column) {
            const PlanPoint p = deposit.geometry.centre(column, row);
            const double depth = deposit.at(column, row);
            const double line = west + 52 + 3 * (1 - std::abs(p.y - south - 30) / 22);
            if (p.x > line && depth > 0) beyond += depth * deposit.geometry.cell * deposit.geometry.cell;
        }
    }
    EXPECT_NEAR(over, beyond, 0.15 * over + 1);
}

double kinetic_energy(const Scenario& scenario) {
    const json series = series_json(scenario);
    return series["time"]["kinetic_energy_J"].back().get<double>();
}

TEST(Barrier, put_into_moving_debris_gives_it_no_energy) {
    for (const double depth_in_debris : {0.5, 4.0}) {
        const auto scenario = open(channel_scene()), free = open(channel_scene());
        run_until(*scenario, 2.5);
        run_until(*free, 2.5);
        const double speed = number(*scenario, "largest_speed_mps");
        const double front = number(*scenario, "front_chainage_m") + 5;  // from the western edge
        act(*scenario, barrier(front - 3 - depth_in_debris, 3, 2));
        EXPECT_LE(number(*scenario, "largest_speed_mps"), speed * 1.0001);
        for (int k = 0; k < 60; ++k) {
            scenario->advance();
            free->advance();
            ASSERT_EQ(scenario->phase(), run::RunPhase::ready) << scenario->message();
            run_until(*free, scenario->time());
            ASSERT_LT(kinetic_energy(*scenario), 1.01 * kinetic_energy(*free)) << "step " << k;
            ASSERT_LT(number(*scenario, "largest_speed_mps"), 1.1 * number(*free, "largest_speed_mps")) << "step " << k;
        }
        EXPECT_LT(kinetic_energy(*scenario), 0.8 * kinetic_energy(*free)) << "it does hold debris back";
        expect_balance(*scenario);
    }
}

TEST(Barrier, moved_begins_its_record_anew_and_removed_lets_go_what_it_held) {
    const auto scenario = open(channel_scene());
    const std::string id = act(*scenario, barrier(40, 5)).created;
    run_until(*scenario, 12);
    EXPECT_EQ(barrier_impact(*scenario)["hit"], true);
    const double front = number(*scenario, "front_chainage_m");
    EXPECT_LT(front, 39);
    act(*scenario, {{"action", "put_barrier"}, {"id", id}, {"name", "renamed"}});
    EXPECT_EQ(barrier_impact(*scenario)["hit"], true);
    EXPECT_EQ(barrier_impact(*scenario)["name"], "renamed");
    json moved = barrier(80, 5);
    moved["id"] = id;
    act(*scenario, moved);
    EXPECT_EQ(barrier_impact(*scenario)["hit"], false);
    run_until(*scenario, 16);
    EXPECT_GT(number(*scenario, "front_chainage_m"), front + 5) << "what it held lies on a slope of 30 degrees";
    act(*scenario, {{"action", "remove_barrier"}, {"id", id}});
    EXPECT_EQ(impacts_json(*scenario)["barriers"].size(), 0U);
    scenario->advance();
}

TEST(Obstacle, taken_away_stays_in_tables_and_report_with_the_time_of_it) {
    scene::Scene scene = channel_scene();
    scene.crs.epsg = 2326;
    add_building(scene, "house", rectangle(west + 20, south + 27, west + 24, south + 33), 6);
    const auto scenario = open(scene);
    const std::string never_there = act(*scenario, barrier(90, 2)).created;
    act(*scenario, {{"action", "remove_barrier"}, {"id", never_there}});
    const std::string dam = act(*scenario, barrier(40, 0.8)).created;
    run_until(*scenario, 6);
    const json then = barrier_impact(*scenario);
    ASSERT_EQ(then["hit"], true);
    act(*scenario, {{"action", "remove_barrier"}, {"id", dam}});
    act(*scenario, {{"action", "remove_building"}, {"id", "building-1"}});
    const double time = scenario->time();
    run_until(*scenario, 7);

    const json removed = impacts_json(*scenario)["removed"];
    ASSERT_EQ(removed.size(), 2U) << "what came and went between two steps was never there: " << removed;
    EXPECT_EQ(removed[0]["kind"], "building");
    EXPECT_EQ(removed[0]["hit"], true);
    EXPECT_EQ(removed[1]["kind"], "barrier");
    EXPECT_EQ(removed[1]["removed_s"], time);
    for (const char* key : {"peak_force_kN", "overtopped_m3", "retained_m3"})
        EXPECT_EQ(removed[1][key], then[key]) << key;

    talus::test::TemporaryFolder folder;
    ASSERT_TRUE(products_of(*scenario)(folder.path()));
    const std::string table = talus::test::read_text(folder.file("buildings.csv"));
    EXPECT_THAT(table, HasSubstr("\nhouse,yes,"));
    EXPECT_THAT(table, HasSubstr("\nbarrier 2,yes,"));
    EXPECT_THAT(table, HasSubstr(fmt::format(",{:.4g}", time).substr(0, 4)));
    const std::string report = talus::test::read_text(folder.file("report.html"));
    EXPECT_THAT(report, HasSubstr("Removed during the run: house at 6.0 s."));
    EXPECT_THAT(report, HasSubstr("Removed during the run: barrier 2 at 6.0 s."));
    EXPECT_THAT(report, HasSubstr("<h3>Barriers</h3>"));

    // Back again it stands, and is told as what stands.
    act(*scenario, {{"action", "undo"}});
    act(*scenario, {{"action", "undo"}});
    EXPECT_EQ(impacts_json(*scenario)["removed"].size(), 0U);
    EXPECT_EQ(barrier_impact(*scenario)["hit"], true);
}

TEST(Obstacle, impacts_of_an_earlier_time_are_those_that_were_told_then) {
    scene::Scene scene = channel_scene();
    add_building(scene, "house", rectangle(west + 60, south + 27, west + 66, south + 33), 6);
    const auto scenario = open(scene);
    act(*scenario, barrier(45, 0.8));
    std::vector<std::pair<double, json>> told;
    for (double time = 0.5; time < 9; time += 1.5) {
        run_until(*scenario, time);
        const std::size_t frames = recording_json(*scenario)["times_s"].size();
        while (recording_json(*scenario)["times_s"].size() == frames) scenario->advance();
        told.emplace_back(scenario->time(), impacts_json(*scenario));
    }
    ASSERT_EQ(told.front().second["barriers"][0]["hit"], false);
    ASSERT_GT(told.back().second["barriers"][0]["overtopped_m3"], 1);
    ASSERT_EQ(told.back().second["buildings"][0]["hit"], true);
    for (const auto& [time, impacts] : told) {
        EXPECT_EQ(impacts_json(*scenario, time), impacts) << time;
        EXPECT_EQ(impacts_json(*scenario, time + 0.05), impacts) << "until the next frame";
    }
}

TEST(Barrier, refuses_lines_that_make_no_wall) {
    const auto scenario = open(channel_scene());
    const auto with = [](const char* key, const json& value) {
        json action = barrier(50, 3);
        action[key] = value;
        return action;
    };
    const auto at = [](double x, double y) { return json{west + x, south + y}; };
    EXPECT_THAT(refusal(*scenario, with("height_m", 0)),
                HasSubstr("height_m = 0: must be a number greater than 0 and at most 200 (m)"));
    EXPECT_THAT(refusal(*scenario, with("thickness_m", 0.1)),
                HasSubstr("thickness_m = 0.1 is refused; with particles of 0.6 m it must be at least 0.3 m"));
    EXPECT_THAT(refusal(*scenario, with("line", {at(50, 20)})), HasSubstr("must be 2 to 500 points"));
    EXPECT_THAT(refusal(*scenario, with("line", {at(50, 20), at(-20, 20)})), HasSubstr("point 2"));
    EXPECT_THAT(refusal(*scenario, with("line", {at(50, 20), at(60, 20), at(50, 20.1)})), HasSubstr("turns by"));
    EXPECT_THAT(refusal(*scenario, with("line", {at(50, 20), at(60, 20), at(60, 30), at(55, 10)})),
                HasSubstr("crosses itself"));
    EXPECT_THAT(refusal(*scenario, with("line", {at(50, 20), at(50, 20), at(60, 30)})), HasSubstr("are the same"));
    EXPECT_THAT(refusal(*scenario, with("line", {at(50, 20), at(50, 30), at(50.3, 30), at(50.3, 20)})),
                HasSubstr("too thick for the bends"));
}

TEST(Building, is_put_moved_and_removed_also_one_of_the_scene) {
    scene::Scene scene = channel_scene();
    add_building(scene, "house", rectangle(west + 60, south + 27, west + 66, south + 33), 6);
    const auto scenario = open(scene);
    EXPECT_EQ(setup_json(*scenario)["buildings"][0]["id"], "building-1");
    const std::string id = act(*scenario, {{"action", "put_building"},
                                           {"name", "shed"},
                                           {"polygon", ring(west + 35, south + 27, west + 38, south + 33)},
                                           {"height_m", 4}})
                               .created;
    EXPECT_EQ(id, "building-2");
    run_until(*scenario, 4);
    json impacts = impacts_json(*scenario)["buildings"];
    EXPECT_EQ(impacts[1]["name"], "shed");
    EXPECT_EQ(impacts[1]["hit"], true);
    act(*scenario, {{"action", "remove_building"}, {"id", id}});
    act(*scenario, {{"action", "put_building"},
                    {"id", "building-1"},
                    {"polygon", ring(west + 45, south + 24, west + 49, south + 36)}});
    const json house = setup_json(*scenario)["buildings"][0];
    EXPECT_EQ(house["height_m"], 6);
    EXPECT_EQ(house["from_scene"], true);
    EXPECT_NEAR(house["base_m"].get<double>(), 3 * std::tan(M_PI / 6), 0.7);
    run_until(*scenario, 7);
    impacts = impacts_json(*scenario)["buildings"];
    ASSERT_EQ(impacts.size(), 1U);
    EXPECT_EQ(impacts[0]["hit"], true);
    ASSERT_EQ(scenario->phase(), run::RunPhase::ready) << scenario->message();
    // Back again, with what had hit it.
    act(*scenario, {{"action", "undo"}});
    act(*scenario, {{"action", "undo"}});
    impacts = impacts_json(*scenario)["buildings"];
    ASSERT_EQ(impacts.size(), 2U);
    EXPECT_EQ(impacts[1]["hit"], true);
    EXPECT_THAT(refusal(*scenario, {{"action", "put_building"}, {"polygon", ring(0, 0, 5, 5)}, {"height_m", 3}}),
                HasSubstr("the ground is not known"));
    EXPECT_THAT(refusal(*scenario, {{"action", "put_building"}, {"polygon", ring(west, south, west + 9, south + 9)}}),
                HasSubstr("height_m: missing"));
}

TEST(Building, of_several_parts_with_a_courtyard_moves_as_a_whole) {
    scene::Scene scene = channel_scene();
    add_building(scene, "farm", rectangle(west + 60, south + 24, west + 70, south + 36), 6);
    terrain::Building& farm = scene.buildings.front();
    farm.footprint[0].holes.push_back(rectangle(west + 63, south + 28, west + 67, south + 32).outer);
    farm.footprint.push_back(rectangle(west + 72, south + 27, west + 75, south + 33));
    const auto scenario = open(scene);
    const json before = setup_json(*scenario)["buildings"][0];
    act(*scenario, {{"action", "put_building"}, {"id", "building-1"}, {"move_m", {-20, 1.5}}});
    const json after = setup_json(*scenario)["buildings"][0];
    ASSERT_EQ(after["polygons"].size(), 2U);
    ASSERT_EQ(after["polygons"][0].size(), 2U);
    for (std::size_t part = 0; part < 2; ++part) {
        for (std::size_t ring = 0; ring < before["polygons"][part].size(); ++ring) {
            for (std::size_t k = 0; k < before["polygons"][part][ring].size(); ++k) {
                const json& was = before["polygons"][part][ring][k];
                const json& is = after["polygons"][part][ring][k];
                EXPECT_DOUBLE_EQ(is[0].get<double>(), was[0].get<double>() - 20);
                EXPECT_DOUBLE_EQ(is[1].get<double>(), was[1].get<double>() + 1.5);
            }
        }
    }
    EXPECT_EQ(after["height_m"], 6);
    EXPECT_GT(after["base_m"].get<double>(), before["base_m"].get<double>() + 2);  // uphill
    run_until(*scenario, 4);
    EXPECT_EQ(impacts_json(*scenario)["buildings"][0]["hit"], true);
    act(*scenario, {{"action", "undo"}});
    EXPECT_EQ(setup_json(*scenario)["buildings"][0], before);

    const auto put = [](const json& keys) {
        json action = {{"action", "put_building"}};
        action.update(keys);
        return action;
    };
    EXPECT_THAT(refusal(*scenario, put({{"id", "building-1"}, {"move_m", {1e300, 0}}})), HasSubstr("move_m: reaches"));
    EXPECT_THAT(refusal(*scenario, put({{"id", "building-1"}, {"move_m", {1, "north"}}})),
                HasSubstr("must be [east, north] in metres"));
    EXPECT_THAT(refusal(*scenario, put({{"height_m", 3}, {"move_m", {1, 1}}})), HasSubstr("needs the id"));
    EXPECT_THAT(refusal(*scenario, put({{"id", "building-1"},
                                        {"move_m", {1, 1}},
                                        {"polygon", ring(west + 60, south + 24, west + 70, south + 36)}})),
                HasSubstr("cannot go with polygon"));
    EXPECT_EQ(setup_json(*scenario)["buildings"][0], before);
}

}  // namespace
}  // namespace talus::twin::test
