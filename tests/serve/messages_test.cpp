#include "messages/messages.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace talus::messages {
namespace {

using nlohmann::json;

TEST(Messages, a_field_that_may_be_null_is_there_and_one_that_may_be_absent_is_not) {
    EXPECT_EQ(json(Done{.done = "ended", .created = {}}), (json{{"done", "ended"}, {"created", nullptr}}));
    EXPECT_EQ(json(Session::Links{}), json::object());
    EXPECT_EQ(json(Session::Links{.viewer = "v"}), (json{{"viewer", "v"}}));
}

TEST(Messages, a_number_that_is_not_finite_is_null) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(json(FrontSeries{.chainage_m = {0, 5},
                               .arrival_time_s = {1, none},
                               .front_velocity_mps = {},
                               .particle_speed_mps = {none, 2}}),
              (json{{"chainage_m", {0, 5}},
                    {"arrival_time_s", {1, nullptr}},
                    {"front_velocity_mps", json::array()},
                    {"particle_speed_mps", {nullptr, 2}}}));
    EXPECT_TRUE(json(GaugePlace{.name = "A", .x_m = 1, .y_m = 2, .chainage_m = none})["chainage_m"].is_null());
}

TEST(Messages, one_that_has_the_fields_of_another_has_them_beside_its_own) {
    EXPECT_EQ(json(IntensityClass{.category = {.name = "low", .colour = "#fff"}, .criterion = "v < 1"}),
              (json{{"name", "low"}, {"colour", "#fff"}, {"criterion", "v < 1"}}));
}

TEST(Messages, what_is_sent_over_the_websocket_says_what_it_is) {
    EXPECT_EQ(json(ScenariosMessage{.scenarios = {"A", "B"}}),
              (json{{"type", "scenarios"}, {"scenarios", {"A", "B"}}}));
    EXPECT_EQ(json(EndedMessage{}), (json{{"type", "ended"}}));
}

}  // namespace
}  // namespace talus::messages
