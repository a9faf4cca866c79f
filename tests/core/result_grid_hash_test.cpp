#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/grid.hpp"
#include "core/hash.hpp"
#include "core/try.hpp"
#include "core/visible_text.hpp"

namespace talus {
namespace {

Result<int> half(int n) {
    if (n % 2 != 0) return Error{"odd: " + std::to_string(n)};
    return n / 2;
}

TEST(Result, carries_a_value_or_the_error) {
    EXPECT_TRUE(half(4).ok());
    EXPECT_EQ(*half(4), 2);
    EXPECT_FALSE(half(3));
    EXPECT_EQ(half(3).error().message, "odd: 3");
}

TEST(Result, gives_up_values_that_can_only_be_moved) {
    Result<std::unique_ptr<int>> made = std::make_unique<int>(7);
    const std::unique_ptr<int> taken = std::move(made).value();
    EXPECT_EQ(*taken, 7);
}

TEST(Status, is_success_unless_given_an_error) {
    EXPECT_TRUE(Status{}.ok());
    const Status failed = Error{"disk full"};
    EXPECT_FALSE(failed);
    EXPECT_EQ(failed.error().message, "disk full");
}

Status is_even(int n) {
    TALUS_TRY(half(n));
    return {};
}

Result<int> sum_of_halves(int a, int b) {
    TALUS_TRY(is_even(a));
    int sum = 0;
    TALUS_ASSIGN(sum, half(a));
    TALUS_ASSIGN(const int other, half(b));
    return sum + other;
}

TEST(Result, is_passed_on) {
    EXPECT_TRUE(is_even(2));
    EXPECT_EQ(is_even(7).error().message, "odd: 7");
    EXPECT_EQ(*sum_of_halves(2, 6), 4);
    EXPECT_EQ(sum_of_halves(3, 6).error().message, "odd: 3");
    EXPECT_EQ(sum_of_halves(2, 5).error().message, "odd: 5");
}

TEST(Grid, row_zero_is_the_southernmost) {
    Grid<int> grid(GridGeometry{100, 200, 5, 4, 3}, -1);
    ASSERT_EQ(grid.values.size(), 12U);
    grid.at(3, 2) = 7;
    EXPECT_EQ(grid.values.back(), 7);
    const PlanPoint first = grid.geometry.centre(0, 0);
    EXPECT_EQ(first.x, 102.5);
    EXPECT_EQ(first.y, 202.5);
    EXPECT_EQ(grid.geometry.extent().x_max, 120);
    EXPECT_EQ(grid.geometry.extent().y_max, 215);
}

// Published test values of FNV-1a 64.
TEST(StateHash, agrees_with_the_published_values) {
    const auto hash_of = [](const std::string& text) {
        StateHash hash;
        hash.add(text.data(), text.size());
        return to_hex(hash.value());
    };
    EXPECT_EQ(hash_of(""), "cbf29ce484222325");
    EXPECT_EQ(hash_of("a"), "af63dc4c8601ec8c");
    EXPECT_EQ(hash_of("foobar"), "85944171f73967e8");
}

TEST(StateHash, in_pieces_as_in_one) {
    const std::vector<float> values{1, 2, 3, 4};
    StateHash whole, pieces;
    whole.add(std::span<const float>(values));
    pieces.add(std::span<const float>(values).first(1));
    pieces.add(std::span<const float>(values).last(3));
    EXPECT_EQ(whole.value(), pieces.value());
}

TEST(VisibleText, shows_what_changes_the_text_around_it) {
    EXPECT_EQ(visible("a\u202Eb\u2066\u200F\u061C\u2028"), R"(a\u202Eb\u2066\u200F\u061C\u2028)");
    EXPECT_EQ(visible(std::string("\x1b[31m\x7f\0\u0085", 9)), R"(\u001B[31m\u007F\u0000\u0085)");
    const std::string plain = "Łódź, 深水埗, \u00e9\u2013\u202f1\u2265\n\ttab \xff\xe2\x80";
    EXPECT_EQ(visible(plain), plain);
    EXPECT_EQ(visible("\u202E", "\\\\"), R"(\\u202E)");
}

}  // namespace
}  // namespace talus
