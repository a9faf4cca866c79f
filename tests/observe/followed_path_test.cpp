#include "observe/followed_path.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "observe/trail.hpp"
#include "particles.hpp"

namespace talus::observe {
namespace {

constexpr float none = std::numeric_limits<float>::quiet_NaN();
constexpr double trail_speed = 6;  // m/s

/// Debris at `trail_speed` along a line within 6 m of it, on cells of 1 m: the observation of a run whose toe is the
/// line's end.
struct Trail {
    explicit Trail(const std::vector<PlanPoint>& points) : line(points, 12) {
        const Grid<float> empty(GridGeometry{1000, 2000, 1, 260, 140}, none);
        HazardMaps& maps = o.maps;
        maps = {empty, empty, empty, empty, empty, empty};
        cover(line, 0);
        o.run_out.crown = points.front();
        o.run_out.toe = points.back();
        o.run_out.along_flow = TrailDistances(maps.peak_depth, points.front()).to(points.back());
        o.run_out.front_chainage = 205.661545;
    }
    /// Deepest and fastest in the middle.
    void cover(const terrain::FlowPath& path, double start_time) {
        HazardMaps& maps = o.maps;
        const GridGeometry& g = maps.peak_depth.geometry;
        for (int row = 0; row < g.rows; ++row) {
            for (int column = 0; column < g.columns; ++column) {
                const auto at = path.locate(g.centre(column, row));
                const std::size_t k = g.index(column, row);
                if (!at || !std::isnan(maps.peak_depth.values[k])) continue;
                maps.peak_depth.values[k] = static_cast<float>(1.2 - 0.15 * at->offset);
                maps.peak_speed.values[k] = static_cast<float>(trail_speed * (1.2 - 0.1 * at->offset));
                maps.arrival_time.values[k] = static_cast<float>(start_time + at->chainage / trail_speed);
                maps.arrival_speed.values[k] = static_cast<float>(trail_speed);
            }
        }
    }
    [[nodiscard]] Observation& follow() {
        follow_debris(ground, 40, outputs, o);
        return o;
    }

    terrain::FlowPath line;
    Observation o;
    sim::Ground ground = test::make_ground();
    params::OutputSpec outputs;
};

std::vector<PlanPoint> winding_line() {
    std::vector<PlanPoint> points;
    for (int x = 0; x <= 220; x += 2) {
        points.push_back({1010.0 + x, 2070 + 30 * std::sin(x * std::numbers::pi / 70)});
    }
    return points;
}

TEST(FollowDebris, finds_the_middle_of_a_winding_trail) {
    Trail trail(winding_line());
    const Observation& o = trail.follow();
    ASSERT_TRUE(o.followed_path);
    EXPECT_EQ(o.followed_path->points().front().x, 1010);
    EXPECT_EQ(o.followed_path->points().back().x, 1230);
    for (const PlanPoint& p : o.followed_path->points()) {
        const auto at = trail.line.locate(p);
        ASSERT_TRUE(at) << p.x << ", " << p.y;
        EXPECT_LT(at->offset, 1.5) << p.x << ", " << p.y;
    }
    // The shortest way over the covered ground cuts the corners, the line does not.
    EXPECT_NEAR(o.followed_path->length(), trail.line.length(), 0.03 * trail.line.length());
    EXPECT_LT(o.run_out.along_flow, 0.95 * trail.line.length());
}

TEST(FollowDebris, measures_the_front_along_it) {
    Trail trail(winding_line());
    const Observation& o = trail.follow();
    ASSERT_GT(o.front.size(), 200U);
    for (const FrontSample& s : o.front) {
        if (s.chainage < 15 || s.chainage > trail.line.length() - 15) continue;
        EXPECT_NEAR(s.arrival_time, s.chainage / trail_speed, 1.2) << s.chainage;
        EXPECT_NEAR(s.front_velocity, trail_speed, 0.15 * trail_speed) << s.chainage;
        EXPECT_NEAR(s.particle_speed, trail_speed, 1e-5) << s.chainage;
    }
    EXPECT_NEAR(o.run_out.front_chainage, o.followed_path->length(), 3);
}

TEST(FollowDebris, has_no_front_that_outruns_the_debris_at_a_sharp_corner) {
    Trail trail({{1010, 2120}, {1120, 2120}, {1120, 2020}, {1240, 2020}});
    const Observation& o = trail.follow();
    ASSERT_TRUE(o.followed_path);
    int known = 0;
    for (const FrontSample& s : o.front) {
        if (std::isnan(s.front_velocity)) continue;
        ++known;
        EXPECT_LE(s.front_velocity, 1.5 * trail_speed + 1e-6) << s.chainage;
        EXPECT_GT(s.front_velocity, 0.5 * trail_speed) << s.chainage;
    }
    EXPECT_GT(known, 0.9 * static_cast<double>(o.front.size()));
}

TEST(FollowDebris, has_no_velocity_where_other_debris_was_beyond_the_front_before) {
    Trail trail({{1010, 2070}, {1230, 2070}});
    Grid<float>& arrival = trail.o.maps.arrival_time;
    for (std::size_t k = 0; k < arrival.values.size(); ++k) {
        const int column = static_cast<int>(k % static_cast<std::size_t>(arrival.geometry.columns));
        if (arrival.geometry.centre(column, 0).x > 1120) arrival.values[k] -= 8;
    }
    const Observation& o = trail.follow();
    int none_there = 0;
    for (std::size_t k = 0; k < o.front.size(); ++k) {
        const FrontSample& s = o.front[k];
        if (k > 0) {
            EXPECT_GE(s.arrival_time, o.front[k - 1].arrival_time) << s.chainage;
        }
        if (std::isnan(s.front_velocity)) {
            ++none_there;
            EXPECT_NEAR(s.chainage, 85, 35);
        } else {
            EXPECT_LE(s.front_velocity, 1.5 * trail_speed + 1e-6) << s.chainage;
        }
    }
    EXPECT_GT(none_there, 20);
}

TEST(FollowDebris, does_not_cross_dry_ground_because_of_an_isolated_cell) {
    const std::vector<PlanPoint> hairpin = {{1010, 2020}, {1200, 2020}, {1200, 2100}, {1010, 2100}};
    Trail plain(hairpin), splashed(hairpin);
    Observation& o = splashed.o;
    const std::size_t k = o.maps.peak_depth.geometry.index(100, 60);  // between the arms
    ASSERT_TRUE(std::isnan(o.maps.peak_depth.values[k]));
    o.maps.peak_depth.values[k] = 0.05F;  // too thin to arrive
    o.maps.peak_speed.values[k] = 1;
    o.run_out.along_flow = TrailDistances(o.maps.peak_depth, o.run_out.crown).to(o.run_out.toe);
    EXPECT_EQ(o.run_out.along_flow, plain.o.run_out.along_flow);
    EXPECT_GT(o.run_out.along_flow, 400);
    const Observation &expected = plain.follow(), &found = splashed.follow();
    ASSERT_TRUE(found.followed_path);
    EXPECT_EQ(found.run_out.front_chainage, expected.run_out.front_chainage);
    ASSERT_EQ(found.front.size(), expected.front.size());
    for (std::size_t i = 0; i < found.front.size(); ++i) {
        EXPECT_EQ(found.front[i].arrival_time, expected.front[i].arrival_time) << i;
    }
}

TEST(FollowDebris, has_a_front_chainage_where_releases_cover_the_whole_path) {
    Trail trail({{1010, 2070}, {1230, 2070}});
    for (float& time : trail.o.maps.arrival_time.values) time = std::isnan(time) ? time : 0;
    const Observation& o = trail.follow();
    EXPECT_TRUE(o.front.empty());
    EXPECT_NEAR(o.run_out.front_chainage, o.followed_path->length(), 3);
}

TEST(FollowDebris, goes_with_the_branch_that_leads_to_the_toe) {
    Trail trail({{1010, 2070}, {1230, 2070}});
    trail.cover(terrain::FlowPath({{1060, 2070}, {1110, 2130}}, 12), 50 / trail_speed);
    const Observation& o = trail.follow();
    ASSERT_TRUE(o.followed_path);
    for (const PlanPoint& p : o.followed_path->points()) {
        if (p.x > 1085) {
            EXPECT_NEAR(p.y, 2070, 1.5) << p.x;
        }
        EXPECT_LT(p.y, 2084) << p.x << ": where it parts, the middle of both";
    }
}

TEST(FollowDebris, tells_where_the_front_was_over_time) {
    Trail trail(winding_line());
    TimeSample before, early, late, after;
    before.time = 0;
    early.time = 10;
    early.front_chainage = 7;  // along another path
    late.time = 30;
    after.time = 1000;
    trail.o.timeseries = {before, early, late, after};
    const Observation& o = trail.follow();
    EXPECT_LT(o.timeseries[0].front_chainage, 4) << "what the release covers";
    EXPECT_NEAR(o.timeseries[1].front_chainage, 10 * trail_speed, 8);
    EXPECT_NEAR(o.timeseries[2].front_chainage, 30 * trail_speed, 8);
    EXPECT_EQ(o.timeseries[3].front_chainage, o.run_out.front_chainage);
}

TEST(FollowDebris, leaves_all_as_it_was_where_debris_hardly_left_its_release) {
    Trail trail({{1010, 2070}, {1016, 2070}});
    trail.o.front = {{3, 1, 2, 2}};
    const Observation& o = trail.follow();
    EXPECT_FALSE(o.followed_path);
    EXPECT_EQ(o.front.size(), 1U);
    EXPECT_EQ(o.run_out.front_chainage, 205.661545);
}

}  // namespace
}  // namespace talus::observe
