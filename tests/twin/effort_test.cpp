#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

TEST(Effort, is_bounded_before_an_action_starts) {
    const auto scenario = open(channel_scene());
    const json dam = {{"action", "put_barrier"},
                      {"line", {{west + 60, south + 20}, {west + 60.5, south + 40}}},
                      {"height_m", 3},
                      {"thickness_m", 1}};
    std::string refused;
    int placed = 0;
    for (; placed < 300 && refused.empty(); ++placed) {
        json one = dam;
        one["line"][0][0] = west + 60 + 0.01 * (placed % 10);
        const auto done = scenario->apply(one, "Ann");
        if (!done) refused = done.error().message;
    }
    EXPECT_THAT(refused, testing::HasSubstr("an action may take 10 s"));
    EXPECT_GT(placed, 10);
}

TEST(Effort, a_session_has_a_number_of_objects_at_most) {
    const auto scenario = open(channel_scene());
    for (int k = 0; k < 200; ++k) {
        act(*scenario, {{"action", "put_zone"},
                        {"polygon", ring(west + 60, south + 20, west + 62, south + 22)},
                        {"friction_coefficient", 0.3}});
    }
    EXPECT_THAT(refusal(*scenario, {{"action", "put_zone"},
                                    {"polygon", ring(west + 60, south + 20, west + 62, south + 22)},
                                    {"friction_coefficient", 0.3}}),
                testing::HasSubstr("200 zones are drawn, the most there can be; remove one first"));
}

}  // namespace
}  // namespace talus::twin::test
