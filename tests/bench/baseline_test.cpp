#include "bench/baseline.hpp"

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/fixtures.hpp"

namespace talus::bench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Baseline, slower_is_below_the_share_or_missing) {
    const Rates expected = {{"a", 1.0}, {"b", 2.0}, {"c", 1.0}, {"d", 1.0}};
    EXPECT_THAT(slower(expected, {{"a", 0.76}, {"b", 1.49}, {"c", 1.5}}, 0.75), ElementsAre("b", "d"));
    EXPECT_THAT(slower(expected, expected, 0.75), IsEmpty());
    EXPECT_THAT(slower({{"a", 1.0}}, {{"a", std::nan("")}}, 0.75), ElementsAre("a"));
    EXPECT_THAT(slower({}, {{"new", 1.0}}, 0.75), IsEmpty());
}

TEST(Baseline, the_better_of_two_attempts_counts) {
    EXPECT_EQ(better_of({{"a", 1.0}, {"b", 3.0}}, {{"a", 2.0}, {"c", 4.0}}),
              (Rates{{"a", 2.0}, {"b", 3.0}, {"c", 4.0}}));
}

TEST(Baseline, is_read_as_it_was_written) {
    const test::TemporaryFolder folder;
    const Baseline baseline = {{"AVX2", {{"slab 20000 pair, 1 thread", 0.0625}}}, {"SSE4", {{"x", 0.5}}}};
    ASSERT_TRUE(write_baseline(folder.file("b.json"), baseline));
    const Result<Baseline> read = read_baseline(folder.file("b.json"));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(*read, baseline);
}

TEST(Baseline, what_is_wrong_with_a_file_is_said) {
    const test::TemporaryFolder folder;
    const auto error_of = [&](const std::string& text) {
        const Result<Baseline> read = read_baseline(test::write_text(folder.file("b.json"), text));
        return read ? std::string("accepted") : read.error().message;
    };
    EXPECT_THAT(error_of("{"), HasSubstr("b.json"));
    EXPECT_THAT(error_of("[1]"), HasSubstr("object"));
    EXPECT_THAT(error_of(R"({"AVX2": 1})"), HasSubstr("AVX2"));
    EXPECT_THAT(error_of(R"({"AVX2": {"a": -1}})"), HasSubstr("above 0: -1"));
    EXPECT_THAT(error_of(R"({"AVX2": {"a": "fast"}})"), HasSubstr("fast"));
    EXPECT_FALSE(read_baseline(folder.file("none.json")));
}

TEST(Baseline, the_committed_one_can_be_read) {
    const Result<Baseline> read = read_baseline(TALUS_SOURCE_DIR "/tests/bench/baseline.json");
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_FALSE(read->empty());
}

}  // namespace
}  // namespace talus::bench
