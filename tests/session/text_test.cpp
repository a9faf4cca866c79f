#include <limits>

#include <gtest/gtest.h>

#include "geo/json_text.hpp"
#include "session/json_text.hpp"
#include "session/pace.hpp"
#include "session/url.hpp"

namespace talus::session {
namespace {

TEST(Target, is_taken_apart_and_decoded) {
    const auto target = parse_target("/api/a%20b?x_m=1.5&name=A+d%C3%A4&flag&=no");
    ASSERT_TRUE(target);
    EXPECT_EQ(target->path, "/api/a b");
    EXPECT_EQ(target->query, (Arguments{{"x_m", "1.5"}, {"name", "A d\xc3\xa4"}, {"flag", ""}}));
    for (const char* bad :
         {"", "api", "*", "http://x/", "/%", "/%4", "/%zz", "/%00", "/a%0d%0ab", "/?a=%1", "/?x_m=1&x_m=2"}) {
        EXPECT_FALSE(parse_target(bad)) << bad;
    }
}

TEST(JsonText, reads_what_is_valid_and_not_too_deep) {
    EXPECT_EQ((*parse_json(R"({"a": [1, "]]]]"]})"))["a"][0], 1);
    for (const std::string& text :
         {std::string(), std::string("{"), std::string("nan"), std::string("{\"a\":1}x"), std::string("\"\xff\""),
          std::string("1e999"), std::string(R"({"a":{"b":1,"c":[{"b":2,"b":3}]}})"), std::string(1000, '['),
          std::string("{\"a\\\":1}"), std::string(3, '\0')}) {
        const auto read = parse_json(text);
        EXPECT_FALSE(read) << text;
        if (!read) {
            EXPECT_LT(read.error().message.size(), 100U);
        }
    }
    const auto nested = [](int depth) { return std::string(depth, '[') + std::string(depth, ']'); };
    EXPECT_TRUE(parse_json(nested(geo::deepest_json)));
    EXPECT_FALSE(parse_json(nested(geo::deepest_json + 1)));
    EXPECT_TRUE(parse_json(R"({"a":{"b":1},"c":{"b":1}})"));
    EXPECT_EQ(parse_json(R"({"b":2,"b":3})").error().message, "the body has the key \"b\" twice in one object");
}

TEST(JsonText, refuses_more_values_than_are_wanted_before_it_parses_them) {
    const std::string text = R"({"a": [1, 2, "[,{"], "b": {}})";
    EXPECT_EQ(geo::json_values(text), 6U) << "three brackets and three commas; those in texts are none";
    EXPECT_TRUE(parse_json(text, 6));
    EXPECT_EQ(parse_json(text, 5).error().message, "the body holds 6 values; at most 5 are read");
    EXPECT_FALSE(parse_json("[" + std::string(100, ',') + "]", 100));
}

TEST(JsonText, writes_text_that_every_reader_takes) {
    EXPECT_EQ(to_text({{"a", std::numeric_limits<double>::quiet_NaN()}}), R"({"a":null})");
    EXPECT_EQ(to_text("\xff"), "\"\xef\xbf\xbd\"");
    EXPECT_EQ(to_text("a\xe2\x80\xae"
                      "b"),
              R"("a\\u202Eb")")
        << "shown, not obeyed";
    EXPECT_EQ(to_text(0.1), "0.1");
    EXPECT_EQ(tidy_name("  \xc3\x9cn\xc2\x85\x7f  ", 40), "\xc3\x9cn");
    EXPECT_EQ(tidy_name("\xc3\x9c\xc3\x9c\xc3\x9c", 2), "\xc3\x9c\xc3\x9c");
}

TEST(Pace, keeps_simulated_time_at_its_factor) {
    Pace pace;
    pace.set_factor(2);
    const Clock::time_point begin{std::chrono::seconds(100)};
    const auto after = [&](double time) {
        return begin + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(time));
    };
    EXPECT_EQ(pace.due(5, begin), begin);
    EXPECT_EQ(pace.due(5.125, after(0.01)), after(0.0625));
    // A step that comes a little late does not move those after it; a long standstill is not run off.
    EXPECT_EQ(pace.due(5.25, after(0.15)), after(0.125));
    EXPECT_EQ(pace.due(5.375, after(2)), after(2));
    EXPECT_EQ(pace.due(5.5, after(2)), after(2.0625));
    // Another scenario leads, far ahead: no waiting for it.
    EXPECT_EQ(pace.due(50, after(3)), after(3));
    pace.set_factor({});
    EXPECT_EQ(pace.due(60, after(3)), after(3));
}

TEST(RateMeter, counts_steps_and_simulated_time) {
    RateMeter meter;
    Clock::time_point now{std::chrono::seconds(10)};
    for (int i = 0; i < 200; ++i) {
        meter.count(0.02, now);
        now += std::chrono::milliseconds(10);
    }
    EXPECT_NEAR(meter.steps_per_second(), 100, 1);
    EXPECT_NEAR(meter.real_time_factor(), 2, 0.02);
    meter.restart();
    EXPECT_EQ(meter.steps_per_second(), 0);
}

}  // namespace
}  // namespace talus::session
