#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "case_folder.hpp"
#include "validate/kind.hpp"
#include "validate/suite.hpp"

namespace talus::validate {
namespace {

using testing::HasSubstr;

TEST(CaseFile, is_read_with_all_it_says) {
    const CaseFolder folder(small_case);
    const Result<Case> loaded = folder.load();
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_EQ(loaded->name, folder.path().filename().string());
    EXPECT_EQ(loaded->kind, "sliding_slab");
    EXPECT_FALSE(loaded->quick);
    ASSERT_EQ(loaded->expectations.size(), 1U);
    EXPECT_EQ(loaded->expectations[0].quantity, "clearance");
    EXPECT_EQ(loaded->expectations[0].expected, 0);
    EXPECT_EQ(loaded->expectations[0].tolerance, 0.5);
    EXPECT_TRUE(loaded->expectations[0].gate);
}

/// What is wrong, and what the message must say.
struct Refused {
    std::string from, to;
    std::vector<std::string> says;
};

class RefusedCase : public testing::TestWithParam<Refused> {};

TEST_P(RefusedCase, says_where_what_and_what_is_allowed) {
    const std::string text = changed_case(GetParam().from, GetParam().to);
    ASSERT_FALSE(text.empty()) << "the test replaces nothing";
    const CaseFolder folder(text);
    const Result<Case> loaded = folder.load();
    ASSERT_FALSE(loaded);
    EXPECT_THAT(loaded.error().message, HasSubstr("case.toml"));
    EXPECT_EQ(loaded.error().message.find('\n'), std::string::npos) << loaded.error().message;
    for (const std::string& part : GetParam().says) EXPECT_THAT(loaded.error().message, HasSubstr(part));
}

INSTANTIATE_TEST_SUITE_P(
    Of, RefusedCase,
    testing::Values(
        Refused{"kind = \"sliding_slab\"", "kind = \"sliding_slap\"", {":3:", "sliding_slap", "\"sliding_slab\""}},
        Refused{"kind = \"sliding_slab\"", "kind = 5", {":3:", "kind = 5", "one of"}},
        Refused{"title = \"A small slab\"", "", {"title is missing"}},
        Refused{"title = \"A small slab\"", "title = \"\"", {"title", "not empty"}},
        Refused{"description", "quick = \"yes\"\ndescription", {"quick = 'yes'", "true or false"}},
        Refused{"description", "colour = 1\ndescription", {"unknown key \"colour\" in [case]"}},
        Refused{"[material]", "[materials]", {"unknown section \"materials\"", "material"}},
        Refused{"[parameters]", "[[parameters]]", {"parameters must be one section"}},
        Refused{"viscosity = 0", "viscosity = 1.5", {"material.viscosity = 1.5", "0 to below 1"}},
        Refused{"viscosity = 0", "viscocity = 0", {"viscocity", "viscosity"}},
        Refused{"slopes_deg = [30]", "slopes_deg = [95]", {":7:", "parameters.slopes_deg", "from 0 to 89"}},
        Refused{"slopes_deg = [30]", "slopes_deg = []", {"slopes_deg = []", "a list, each"}},
        Refused{"slopes_deg = [30]", "slopes_deg = [30, \"steep\"]", {"slopes_deg", "a list, each"}},
        Refused{"slopes_deg = [30]", "slopes_deg = [nan]", {"slopes_deg = [ nan ]", "a list, each"}},
        Refused{"slopes_deg = [30]", "slopes_deg = 30", {"slopes_deg = 30", "a list, each"}},
        Refused{"slopes_deg", "slope_deg", {"unknown key \"slope_deg\" in [parameters]", "slopes_deg"}},
        Refused{"layers = 2", "layers = 2.5", {"layers = 2.5", "whole number"}},
        Refused{"layers = 2", "layers = 1e300", {"layers", "whole number"}},
        Refused{"length_m = 6", "length_m = 0", {"length_m = 0", "above 0"}},
        Refused{"length_m = 6", "length_m = inf", {"length_m = inf", "above 0"}},
        Refused{"quantity = \"clearance\"", "quantity = \"clearence\"", {"clearence", "\"clearance\""}},
        Refused{"tolerance = 0.5", "", {"tolerance is missing", "gate = false"}},
        Refused{"tolerance = 0.5", "tolerance = -1", {"tolerance = -1", "at least 0"}},
        Refused{"tolerance = 0.5", "tolerance = 0.5\ncomparison = \"about\"", {"about", "at_most"}},
        Refused{"expected = 0\n", "", {"expected is missing", "no law"}},
        Refused{"source = \"by construction\"", "", {"source is missing"}},
        Refused{"source = \"by", "gate = false\nknown_failure = \"so\"\nsource = \"by", {"known_failure"}},
        Refused{"source = \"by", "where = [1]\nsource = \"by", {"where", "list of texts"}},
        Refused{"[[expect]]", "[expect]", {"expect must be sections", "[[expect]]"}},
        Refused{"layers = 2", "layers = ", {":11:", "not valid TOML"}}));

TEST(CaseFile, that_is_not_there_is_named) {
    const Result<Case> loaded = load_case("/no/such/folder");
    ASSERT_FALSE(loaded);
    EXPECT_THAT(loaded.error().message, HasSubstr("/no/such/folder/case.toml: no such case file"));
}

TEST(CaseFile, without_expectations_is_refused) {
    const std::string text = small_case.substr(0, small_case.find("[[expect]]"));
    const Result<Case> loaded = CaseFolder(text).load();
    ASSERT_FALSE(loaded);
    EXPECT_THAT(loaded.error().message, HasSubstr("\"expect\" is missing"));
}

TEST(CaseFile, may_speak_of_several_variants_at_once) {
    const Result<Case> loaded =
        CaseFolder(changed_case("source = \"by", "where = [\"a\", \"b\"]\nsource = \"by")).load();
    ASSERT_TRUE(loaded) << loaded.error().message;
    ASSERT_EQ(loaded->expectations.size(), 2U);
    EXPECT_EQ(loaded->expectations[1].where, "b");
}

TEST(CaseFile, every_kind_explains_itself_and_its_quantities) {
    for (const Kind& kind : kinds()) {
        EXPECT_FALSE(kind.summary.empty()) << kind.name;
        for (const Quantity& quantity : kind.quantities) {
            EXPECT_FALSE(quantity.help.empty()) << kind.name << " " << quantity.name;
            EXPECT_FALSE(quantity.unit.empty()) << kind.name << " " << quantity.name;
        }
    }
}

TEST(CaseFile, every_kind_and_quantity_is_documented) {
    const std::string text = test::read_text(std::filesystem::path(TALUS_SOURCE_DIR) / "docs/validation-cases.md");
    for (const Kind& kind : kinds()) {
        EXPECT_THAT(text, HasSubstr("| `" + std::string(kind.name) + "` | " + std::string(kind.summary) + " |"));
        for (const Quantity& quantity : kind.quantities) {
            EXPECT_THAT(text, HasSubstr("`" + std::string(quantity.name) + "`")) << kind.name;
        }
    }
}

TEST(CaseFile, all_cases_of_the_repository_are_good_and_travel_inside_the_program) {
    std::vector<std::string> names;
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::path(TALUS_SOURCE_DIR) / "validation")) {
        const Result<Case> loaded = load_case(entry.path());
        ASSERT_TRUE(loaded) << loaded.error().message;
        names.push_back(loaded->name);
    }
    EXPECT_THAT(builtin_case_names(), testing::UnorderedElementsAreArray(names));

    const test::TemporaryFolder folder;
    const auto unpacked = unpack_builtin_cases(folder.path());
    ASSERT_TRUE(unpacked) << unpacked.error().message;
    for (const std::string& name : names) {
        const Result<Case> loaded = load_case(*unpacked / name);
        EXPECT_TRUE(loaded) << loaded.error().message;
    }
    for (const char* scene : {"sham_tseng", "sham_tseng_real"}) {
        EXPECT_TRUE(std::filesystem::exists(*unpacked / "../scenes" / scene / "scene.toml"));
    }
}

}  // namespace
}  // namespace talus::validate
