#include "stats/distribution.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/value_of.hpp"

namespace talus::stats {
namespace {

using testing::HasSubstr;

Distribution parsed(const std::string& text) {
    return test::value_of(parse_distribution(text));
}

TEST(Distribution, quantiles_are_those_of_its_kind) {
    EXPECT_DOUBLE_EQ(parsed("0.2:0.6").quantile(0.25), 0.3);
    EXPECT_NEAR(parsed("log:0.01:100").quantile(0.5), 1, 1e-12);
    const Distribution normal = parsed("normal:10:2");
    EXPECT_NEAR(normal.quantile(0.5), 10, 1e-9);
    EXPECT_NEAR(normal.quantile(0.975), 10 + 2 * 1.959963985, 1e-6);
    const Distribution triangular = parsed("triangular:0:1:4");
    EXPECT_NEAR(triangular.quantile(0.25), 1, 1e-12);  // a quarter of the area lies left of the mode
    EXPECT_NEAR(triangular.quantile(0.0625), 0.5, 1e-12);
    EXPECT_NEAR(triangular.quantile(1), 4, 1e-12);
}

TEST(Distribution, a_cut_normal_stays_within_its_limits_and_keeps_its_shape) {
    const Distribution d = parsed("normal:0:1:-1:1");
    EXPECT_DOUBLE_EQ(d.quantile(0), -1);
    EXPECT_DOUBLE_EQ(d.quantile(1), 1);
    EXPECT_NEAR(d.quantile(0.5), 0, 1e-9);
    // Half of the 68.27 % within one deviation, and of that half again: 17.07 % between 0 and this.
    EXPECT_NEAR(std::erf(d.quantile(0.75) / std::sqrt(2.0)) / 2, 0.6826894921 / 4, 1e-9);
}

TEST(Distribution, a_list_gives_its_entries_equally_often) {
    const Distribution d = parsed("a,b,c");
    int count[3] = {};
    for (int i = 0; i < 300; ++i) ++count[d.entry((i + 0.5) / 300)[0] - 'a'];
    for (const int c : count) EXPECT_EQ(c, 100);
    EXPECT_EQ(d.entry(1), "c");
}

TEST(Distribution, a_list_gives_its_entries_by_their_weights) {
    const Distribution d = parsed("a@1,b@6,c@3");
    int count[3] = {};
    for (int i = 0; i < 300; ++i) ++count[d.entry((i + 0.5) / 300)[0] - 'a'];
    EXPECT_EQ(count[0], 30);
    EXPECT_EQ(count[1], 180);
    EXPECT_EQ(count[2], 90);
    EXPECT_EQ(d.entry(1), "c");
    EXPECT_EQ(d.text(), "one of a (10 %), b (60 %), c (30 %)");
    EXPECT_EQ(parsed("a@x,b@2").entries[0], "a@x") << "a text that has the sign";
}

TEST(Distribution, what_is_written_reads_back_the_same) {
    for (const char* text : {"0.1:0.3", "log:0.001:7", "normal:0.4:0.05", "normal:0.4:0.05:0.2:0.6", "triangular:1:2:3",
                             "spiky,cubic_spline", "400@3,900@0.5"}) {
        EXPECT_EQ(parsed(text).written(), text);
    }
}

TEST(Distribution, bad_ones_are_refused_with_the_reason) {
    const auto why = [](const std::string& text) {
        const auto d = parse_distribution(text);
        return d ? std::string("(accepted)") : d.error().message;
    };
    EXPECT_THAT(why("0.5:0.2"), HasSubstr("the range is empty"));
    EXPECT_THAT(why("0.5:0.5"), HasSubstr("the range is empty"));
    EXPECT_THAT(why("0.5:x"), HasSubstr("\"x\" is not a number"));
    EXPECT_THAT(why("log:0:1"), HasSubstr("must be above 0"));
    EXPECT_THAT(why("normal:1:0"), HasSubstr("must be above 0"));
    EXPECT_THAT(why("triangular:0:5:4"), HasSubstr("must lie from 0 to 4"));
    EXPECT_THAT(why("gauss:0:5"), HasSubstr("write low:high"));
    EXPECT_THAT(why("1:2:3"), HasSubstr("write low:high"));
    EXPECT_THAT(why("a,,b"), HasSubstr("empty"));
    EXPECT_THAT(why("a@1,b@0"), HasSubstr("weight must be a number above 0"));
    EXPECT_THAT(why("0:inf"), HasSubstr("not a number"));
}

}  // namespace
}  // namespace talus::stats
