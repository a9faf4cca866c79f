#include "params/scene_text.hpp"

#include <fstream>
#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace talus::params {
namespace {

using testing::HasSubstr;

void expect_committed(const std::string& path, const std::string& option, const std::string& text) {
    const std::string file = std::string(TALUS_SOURCE_DIR) + "/" + path;
    std::ifstream committed(file);
    ASSERT_TRUE(committed) << file;
    std::istringstream generated(text);
    std::string expected, line;
    for (int number = 1; std::getline(generated, expected); ++number) {
        std::getline(committed, line);
        ASSERT_EQ(line, expected) << file << ":" << number << ": run talus scene reference " << option << " > " << path;
    }
    EXPECT_FALSE(std::getline(committed, line)) << "the file goes on after the generated text";
}

TEST(SceneReference, the_committed_page_is_the_generated_one) {
    expect_committed("docs/scene-reference.md", "--markdown", scene_reference_markdown());
}

TEST(SceneReference, the_committed_typescript_is_the_generated_one) {
    expect_committed("web/src/protocol/schema.ts", "--typescript", scene_typescript());
}

TEST(SceneReference, names_every_key_with_unit_default_and_range) {
    const std::string page = scene_reference_markdown(), text = scene_reference_text();
    for (const Section& section : scene_sections()) {
        for (const Parameter& p : section.parameters) {
            EXPECT_THAT(page, HasSubstr("| `" + p.key + "` | " + p.unit + " |"));
            EXPECT_THAT(text, HasSubstr("  " + p.key + "\n"));
        }
    }
    EXPECT_THAT(page, HasSubstr("| `viscosity` |  | `0.1` | a number from 0 to below 1 |"));
    EXPECT_THAT(page, HasSubstr("| from target_layers or target_particle_count |"));
}

TEST(WriteScene, sets_what_differs_and_comments_the_rest) {
    SceneSpec spec;
    spec.terrain.file = "dem.tif";
    spec.releases.resize(1);
    spec.releases[0].file = "release.geojson";
    spec.releases[0].volume = 600;
    spec.material.viscosity = 0.05;
    spec.scene.assumptions = {"One \"quoted\" sentence.", "Another."};
    const std::string text = write_scene(spec, "A header.");
    EXPECT_THAT(text, testing::StartsWith("# A header.\n"));
    EXPECT_THAT(text, HasSubstr("\n[terrain]\n"));
    EXPECT_THAT(text, HasSubstr("\nfile = \"dem.tif\"\n"));
    EXPECT_THAT(text, HasSubstr("\n[[release]]\n"));
    EXPECT_THAT(text, HasSubstr("\nvolume_m3 = 600\n"));
    EXPECT_THAT(text, HasSubstr("\nviscosity = 0.05\n"));
    EXPECT_THAT(text, HasSubstr("\n# friction_coefficient = 0.4\n"));
    EXPECT_THAT(text, HasSubstr("\n# [[observation]]\n"));
    EXPECT_THAT(text, HasSubstr("    \"One \\\"quoted\\\" sentence.\",\n"));
}

TEST(WriteShortScene, has_twenty_keys_and_what_differs) {
    SceneSpec spec;
    spec.terrain.file = "dem.tif";
    spec.releases.resize(1);
    spec.releases[0].file = "release.geojson";
    spec.releases[0].volume = 600;
    EXPECT_EQ(first_keys().size(), 20U);
    const auto keys_in = [](const std::string& text) {
        std::set<std::string> keys;
        std::string section;
        std::istringstream lines(text);
        for (std::string line; std::getline(lines, line);) {
            if (line.rfind("# ", 0) == 0) line.erase(0, 2);
            if (line.rfind('[', 0) == 0)
                section = line.substr(line.find_first_not_of('['), line.find(']') - line.find_first_not_of('['));
            const std::size_t is = line.find(" = ");
            if (is != std::string::npos && line.find(' ') == is) keys.insert(section + "." + line.substr(0, is));
        }
        return keys;
    };
    const std::set<std::string> first(first_keys().begin(), first_keys().end());
    EXPECT_EQ(keys_in(write_short_scene(spec, "A header.")), first);
    spec.solver.support_ratio = 2.5;
    std::set<std::string> more = first;
    more.insert("solver.support_ratio");
    const std::string text = write_short_scene(spec);
    EXPECT_EQ(keys_in(text), more);
    EXPECT_THAT(text, HasSubstr("\nsupport_ratio = 2.5\n"));
    EXPECT_THAT(text, HasSubstr("\nvolume_m3 = 600\n"));
    EXPECT_THAT(text, HasSubstr("\n# friction_coefficient = 0.4\n"));
}

TEST(WriteScene, every_commented_line_is_the_default) {
    SceneSpec spec;
    spec.releases.resize(1);
    std::size_t checked = 0;
    for (const std::string& text : {write_scene(spec), write_short_scene(spec)}) {
        const Section* section = nullptr;
        std::istringstream lines(text);
        for (std::string line; std::getline(lines, line);) {
            const std::string bare = line.starts_with("# ") ? line.substr(2) : line;
            if (bare.starts_with('[') && bare.ends_with(']')) {
                const std::size_t first = bare.find_first_not_of('[');
                section = find_section(bare.substr(first, bare.find(']') - first));
                continue;
            }
            const std::size_t is = line.find(" = ");
            if (!line.starts_with("# ") || is == std::string::npos || line.find(' ', 2) != is) continue;
            const Parameter* parameter = section != nullptr ? section->find(line.substr(2, is - 2)) : nullptr;
            if (parameter == nullptr) continue;  // a sentence
            const ParameterValue value = default_value(*section, *parameter);
            const bool none = std::holds_alternative<std::monostate>(value);
            EXPECT_EQ(line.substr(is + 3), none ? "none" : toml_text(value)) << section->name;
            ++checked;
        }
    }
    EXPECT_GT(checked, 150U);
    EXPECT_THAT(write_short_scene(spec), HasSubstr("\n# turbulent_friction_mps2 = none\n"));
}

TEST(WriteScene, lines_stay_within_a_page) {
    const std::string text = write_scene(SceneSpec{});
    std::size_t begin = 0;
    while (begin < text.size()) {
        const std::size_t end = text.find('\n', begin);
        EXPECT_LE(end - begin, 110U) << text.substr(begin, end - begin);
        begin = end + 1;
    }
}

TEST(TomlText, writes_numbers_exactly_and_escapes_text) {
    EXPECT_EQ(toml_text(1.0 / 60), "0.016666666666666666");
    EXPECT_EQ(plain_text(1.0 / 60), "0.0166667");
    EXPECT_EQ(toml_text(std::string("a\"b\\c\nd\x01")), "\"a\\\"b\\\\c\\nd\\u0001\"");
    EXPECT_EQ(toml_text(Extent{1, 2, 3.5, 4}), "[1, 2, 3.5, 4]");
}

}  // namespace
}  // namespace talus::params
