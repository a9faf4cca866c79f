#include "observe/number_names.hpp"

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>

/// The table of scalar results, and the lists of other languages and files that cannot read it.
namespace talus::observe {
namespace {

using ::testing::HasSubstr;

std::string file_text(const char* path) {
    std::ifstream file(std::string(TALUS_SOURCE_DIR) + "/" + path);
    std::stringstream text;
    text << file.rdbuf();
    EXPECT_FALSE(text.str().empty()) << path;
    return text.str();
}

std::vector<NamedNumber> all_numbers() {
    std::vector<NamedNumber> all(run_out_numbers.begin(), run_out_numbers.end());
    all.push_back(front_number);
    return all;
}

TEST(NumberNames, a_number_is_given_in_the_unit_that_its_key_ends_with) {
    Observation seen;
    seen.run_out = {.front_chainage = 1, .along_flow = 2, .straight = 3, .drop = 4};
    seen.run_out.runout_angle = 30 / degrees_per_radian;
    seen.run_out.travel_angle = 20 / degrees_per_radian;
    const std::vector<double> expected = {2, 3, 4, 30, 20, 1};
    const std::vector<NamedNumber> all = all_numbers();
    ASSERT_EQ(all.size(), expected.size());
    for (std::size_t k = 0; k < all.size(); ++k) {
        EXPECT_DOUBLE_EQ(all[k].value(seen), expected[k]) << all[k].key;
        EXPECT_TRUE(all[k].key.ends_with(fmt::format("_{}", all[k].unit))) << all[k].key;
    }
}

TEST(NumberNames, files_and_other_languages_call_them_by_their_keys) {
    const std::string table = file_text("src/products/tables.cpp"), header = file_text("apps/embed/talus.h");
    const std::string module = file_text("python/talus/measures.py");
    for (const NamedNumber& number : all_numbers()) {
        EXPECT_THAT(table, HasSubstr(std::string(number.key))) << "run_out.csv";
        EXPECT_THAT(header, HasSubstr(fmt::format("\"{}\"", number.key)));
        EXPECT_THAT(module, HasSubstr(fmt::format("_or_nan(row[\"{}\"])", number.key)));
    }
}

TEST(NumberNames, the_description_of_the_server_and_the_page_have_those_that_models_are_compared_by) {
    const std::string protocol = file_text("src/serve/protocol.json"), page = file_text("web/src/protocol/messages.ts");
    for (const NamedNumber& number : {front_number, run_out_number}) {
        EXPECT_THAT(protocol, HasSubstr(fmt::format("'{}'", number.key)));
        EXPECT_THAT(page, HasSubstr(fmt::format("\"{}\"", number.key)));
    }
}

}  // namespace
}  // namespace talus::observe
