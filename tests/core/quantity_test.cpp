#include "core/quantity.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace talus {
namespace {

using testing::HasSubstr;

/// NaN: refused.
double length(const char* text) {
    const Result<double> read = read_quantity(text, Dimension::length);
    return read ? *read : std::nan("");
}

std::string refusal(const char* text, Dimension dimension = Dimension::length) {
    const Result<double> read = read_quantity(text, dimension);
    return read ? "accepted" : read.error().message;
}

TEST(Quantity, lengths_as_people_write_them) {
    for (const auto& [text, metres] : {std::pair{"7", 7.0},
                                       {"12 m", 12.0},
                                       {"9m", 9.0},
                                       {" 12.5 ", 12.5},
                                       {"12,5", 12.5},
                                       {"1e1", 10.0},
                                       {"-3", -3.0},
                                       {"+3", 3.0},
                                       {"30 ft", 9.144},
                                       {"30ft", 9.144},
                                       {"40'", 12.192},
                                       {"40\xE2\x80\xB2", 12.192},
                                       {"5'6\"", 1.6764},
                                       {"5\xE2\x80\x99 6\"", 1.6764},
                                       {"66 in", 1.6764},
                                       {"250 cm", 2.5},
                                       {"12\xC2\xA0m", 12.0},
                                       {"0,125", 0.125},
                                       {"12,25 m", 12.25},
                                       {"1250,500", 1250.5},
                                       {"3 metres", 3.0},
                                       {".5", 0.5},
                                       {"5.", 5.0}}) {
        EXPECT_NEAR(length(text), metres, 1e-12 * std::abs(metres)) << text;
    }
}

TEST(Quantity, pressures_as_people_write_them) {
    for (const auto& [text, pascals] : {std::pair{"500", 500.0},
                                        {"500 Pa", 500.0},
                                        {"500 kPa", 5e5},
                                        {"0,5 MPa", 5e5},
                                        {"35 kN/m2", 3.5e4},
                                        {"35 kN/m²", 3.5e4}}) {
        const Result<double> read = read_quantity(text, Dimension::pressure);
        ASSERT_TRUE(read) << text << ": " << read.error().message;
        EXPECT_NEAR(*read, pascals, 1e-9 * pascals) << text;
    }
}

TEST(Quantity, what_is_not_understood_is_refused_with_its_reason) {
    EXPECT_THAT(refusal("2 storeys"), HasSubstr("after its number comes \"storeys\"; units are m, cm"));
    for (const char* text : {"~8", "yes", "", " ", "m", "<5", "nan", "inf", "-", "e5", "ca. 8"}) {
        EXPECT_EQ(refusal(text), "it does not begin with a number") << text;
    }
    for (const char* text : {"8-10", "8;9", "12 kPa", "12 M", "5 6", "1.234,5", "5'13\"", "5'-6\"", "1'234", "0x10"}) {
        EXPECT_THAT(refusal(text), HasSubstr("after its number comes")) << text;
    }
    for (const char* text : {"1,234", "123,456 m", "1,234.5"}) EXPECT_THAT(refusal(text), HasSubstr("thousands"));
    EXPECT_EQ(refusal("1e400"), "its number is out of range");
    EXPECT_THAT(refusal("5 m", Dimension::pressure), HasSubstr("units are Pa, kPa, MPa and kN/m2"));
    EXPECT_EQ(refusal("5 m", Dimension::none), "after its number comes \"m\"");
}

TEST(Quantity, a_comma_is_decimal_where_something_else_separates_the_columns) {
    const Result<double> read = read_quantity("1,234", Dimension::none, Comma::decimal);
    ASSERT_TRUE(read);
    EXPECT_EQ(*read, 1.234);
}

}  // namespace
}  // namespace talus
