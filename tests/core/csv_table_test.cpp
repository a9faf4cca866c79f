#include "core/csv_table.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/temporary_folder.hpp"
#include "support/value_of.hpp"

namespace talus {
namespace {

using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;

class CsvTables : public testing::Test {
  protected:
    CsvTable read(const std::string& text) { return test::value_of(read_csv_table(write(text), 100)); }
    std::string refusal(const std::string& text) {
        const auto table = read_csv_table(write(text), 3);
        return table ? "accepted" : table.error().message;
    }

  private:
    std::string write(const std::string& text) {
        const std::string file = (folder_.path() / "a.csv").string();
        std::ofstream(file, std::ios::binary) << text;
        return file;
    }
    TemporaryFolder folder_;
};

TEST_F(CsvTables, quoted_fields_keep_their_separators_quotes_and_lines) {
    const CsvTable table = read("t,\"q, wet\",note\r\n1,\"10,5\",\"a \"\"b\"\"\nc\"\r\n\r\n2,,x\r\n");
    EXPECT_THAT(table.columns, ElementsAre("t", "q, wet", "note"));
    ASSERT_EQ(table.rows.size(), 2U);
    EXPECT_THAT(table.rows[0].fields, ElementsAre("1", "10,5", "a \"b\"\nc"));
    EXPECT_THAT(table.rows[1].fields, ElementsAre("2", "", "x"));
    EXPECT_EQ(table.rows[0].line, 2U);
    EXPECT_EQ(table.rows[1].line, 5U) << "a field of two lines and an empty line come before";
    EXPECT_EQ(table.comma, Comma::either);
}

TEST_F(CsvTables, semicolons_and_tabs_separate_too) {
    for (const std::string s : {";", "\t"}) {
        const CsvTable table = read("t" + s + "q\n1" + s + "10,5\n");
        EXPECT_THAT(table.columns, ElementsAre("t", "q"));
        ASSERT_EQ(table.rows.size(), 1U);
        EXPECT_THAT(table.rows[0].fields, ElementsAre("1", "10,5"));
        EXPECT_EQ(table.comma, Comma::decimal);
    }
}

TEST_F(CsvTables, utf16_and_latin1_are_read) {
    std::string utf16 = "\xFF\xFE";
    for (const char c : std::string("t,q\n1,2\n")) utf16 += {c, '\0'};
    EXPECT_THAT(read(utf16).rows.at(0).fields, ElementsAre("1", "2"));
    EXPECT_THAT(read("t,n\n1,M\xFCller\n").rows.at(0).fields, ElementsAre("1", "Müller"));
}

TEST_F(CsvTables, missing_fields_are_empty_and_padding_is_not) {
    const CsvTable table = read("a,b,c\n1\n1,2,3,,\n");
    ASSERT_EQ(table.rows.size(), 2U);
    EXPECT_THAT(table.rows[0].fields, ElementsAre("1", "", ""));
    EXPECT_THAT(table.rows[1].fields, ElementsAre("1", "2", "3"));
    EXPECT_TRUE(read("").columns.empty());
}

TEST_F(CsvTables, what_is_no_table_is_refused_by_line) {
    EXPECT_THAT(refusal("a,b\n1,2\n3,10,5\n"),
                HasSubstr("a.csv:3: has 3 fields, and the first line names 2 columns; a decimal comma needs quotes"));
    EXPECT_THAT(refusal("a,b\n1,\"2\n3,4\n"), EndsWith("a.csv:2: a quote is not closed"));
    EXPECT_THAT(refusal("a,b\n1,\"2\"3\n"), HasSubstr("a.csv:2: behind the closing quote"));
    EXPECT_THAT(refusal("a\n1\n2\n3\n4\n"), EndsWith("a.csv: has more than 3 rows"));
    EXPECT_THAT(read_csv_table("/nowhere/a.csv", 1).error().message, HasSubstr("no such file"));
    EXPECT_THAT(read_csv_table("/tmp", 1).error().message, HasSubstr("no such file, or it cannot be opened"));
}

}  // namespace
}  // namespace talus
