#include "core/utf8.hpp"

#include <gtest/gtest.h>

namespace talus {
namespace {

TEST(Utf8, valid_text_stays_as_it_is) {
    for (const char* text : {"", "plain", "Müllerhütte", "泥石流", "\xF0\x9F\x8F\x94", "\xEF\xBB\xBFmark"}) {
        EXPECT_EQ(invalid_utf8(text), std::string::npos) << text;
        EXPECT_EQ(to_utf8(text), text);
    }
}

TEST(Utf8, first_invalid_byte_is_found) {
    EXPECT_EQ(invalid_utf8("ab\xFC"), 2U);
    EXPECT_EQ(invalid_utf8("\xC3\xBC\x80"), 2U) << "a byte that continues nothing";
    EXPECT_EQ(invalid_utf8("\xC0\xAF"), 0U) << "a longer form of '/'";
    EXPECT_EQ(invalid_utf8("\xE0\x80\xAF"), 0U) << "the same of three bytes";
    EXPECT_EQ(invalid_utf8("\xED\xA0\x80"), 0U) << "half a surrogate pair";
    EXPECT_EQ(invalid_utf8("\xF4\x90\x80\x80"), 0U) << "above U+10FFFF";
    EXPECT_EQ(invalid_utf8("a\xE2\x82"), 1U) << "cut short";
}

TEST(Utf8, other_text_is_read_as_windows1252) {
    EXPECT_EQ(to_utf8("M\xFCllerh\xFCtte"), "Müllerhütte");
    EXPECT_EQ(to_utf8("Caf\xE9"), "Café") << "the last byte also begins a character of three bytes";
    EXPECT_EQ(to_utf8("\x80 \x93x\x94"), "€ “x”");
    EXPECT_EQ(to_utf8("a\x81z"), "a\xEF\xBF\xBDz") << "a byte that has no meaning there";
}

TEST(Utf8, a_character_cut_by_the_end_of_its_field_is_left_out) {
    EXPECT_EQ(to_utf8("Müllerh\xC3"), "Müllerh");
}

TEST(Utf8, files_in_utf16) {
    const std::string little(
        "\xFF\xFE"
        "a\0\xFC\0\n\0\x3C\xD8\xD4\xDF",
        12),
        big("\xFE\xFF\0a\0\xFC", 6);
    EXPECT_EQ(file_to_utf8(little), "aü\n\xF0\x9F\x8F\x94");
    EXPECT_EQ(file_to_utf8(big), "aü");
    EXPECT_EQ(file_to_utf8(std::string("\xFF\xFE\x3C\xD8z\0", 6)), "\xEF\xBF\xBDz") << "half a surrogate pair";
    EXPECT_EQ(file_to_utf8(std::string("\xFF\xFE\x61", 3)), "\xEF\xBF\xBD") << "half a unit";
    EXPECT_EQ(file_to_utf8("\xEF\xBB\xBF"
                           "a"),
              "a");
    EXPECT_EQ(file_to_utf8("a\xFC"), "aü");
}

}  // namespace
}  // namespace talus
