#include "observe/number_names.hpp"

#include <algorithm>
#include <fstream>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "report/results.hpp"
#include "report_fixture.hpp"
#include "run/comparison.hpp"
#include "run/words.hpp"

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

TEST(NumberNames, a_number_is_given_in_the_unit_that_its_key_ends_with) {
    Observation seen;
    seen.run_out = {.front_chainage = 1, .along_flow = 2, .straight = 3, .drop = 4};
    seen.run_out.runout_angle = 30 / degrees_per_radian;
    seen.run_out.travel_angle = 20 / degrees_per_radian;
    seen.deposit = {.area = 5, .depth = 6};
    seen.volume_released = 7;
    seen.erosion.volume = 8;
    seen.timeseries.resize(2);
    TimeSample& end = seen.timeseries.back();
    end.volume_held = 9;
    end.volume_moving = 10;
    end.volume_deposited = 11;
    end.volume_left = 12;
    const std::vector<double> expected = {2, 3, 4, 30, 20, 1, 5, 6, 7, 8, 9, 10, 11, 12};
    ASSERT_EQ(named_numbers.size(), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k) {
        const NamedNumber& number = named_numbers[k];
        EXPECT_DOUBLE_EQ(number.value(seen), expected[k]) << number.key;
        EXPECT_TRUE(number.key.ends_with(fmt::format("_{}", number.unit))) << number.key;
        EXPECT_EQ(find_number(number.key), &number);
    }
    EXPECT_EQ(find_number("none"), nullptr);
    const Peaks peaks{{2, {}}, {10, {}}, {4e5, {}}};
    EXPECT_EQ(peak_numbers[0].value(peaks), 2);
    EXPECT_EQ(peak_numbers[1].value(peaks), 10);
    EXPECT_DOUBLE_EQ(peak_numbers[2].value(peaks), 400) << "kPa";
}

TEST(NumberNames, parts_of_the_table_are_what_they_say) {
    EXPECT_EQ(run_out_number.key, "run_out_along_flow_m");
    EXPECT_EQ(front_number.key, "front_chainage_m");
    EXPECT_EQ(run_out_numbers.back().key, "travel_angle_deg");
    for (const NamedNumber& number : deposit_numbers) EXPECT_TRUE(number.key.starts_with("deposit_")) << number.key;
    TimeSample now;
    for (const NamedNumber& number : volume_numbers) {
        EXPECT_TRUE(number.key.starts_with("volume_")) << number.key;
        ASSERT_NE(number.sample, nullptr) << number.key;
    }
    now.volume_released = 1;
    now.volume_entrained = 2;
    now.volume_held = 3;
    now.volume_moving = 4;
    now.volume_deposited = 5;
    now.volume_left = 6;
    for (std::size_t k = 0; k < volume_numbers.size(); ++k) {
        EXPECT_EQ(now.*volume_numbers[k].sample, static_cast<double>(k + 1)) << volume_numbers[k].key;
    }
}

/// The entry of a list whose `key` is this; null: none.
report::Json entry(const report::Json& list, std::string_view key) {
    for (const report::Json& each : list) {
        if (each["key"] == key) return each;
    }
    return {};
}

TEST(NumberNames, the_report_calls_them_by_their_titles) {
    const scene::Scene scene = test::sample_scene();
    const report::Json figures = report::key_figures(scene, test::sample_result(scene));
    for (const char* key : {"run_out_along_flow_m", "runout_angle_deg"}) {
        EXPECT_EQ(entry(figures, key)["name"], find_number(key)->title);
    }
    EXPECT_EQ(entry(figures, "released_volume_m3")["name"], find_number("volume_released_m3")->title);
    for (const NamedPeak& peak : peak_numbers) {
        EXPECT_EQ(entry(figures, peak.key)["name"], peak.map.title);
        EXPECT_EQ(entry(figures, peak.key)["unit"], peak.map.unit);
    }
}

TEST(NumberNames, variants_are_compared_by_numbers_of_the_table) {
    const scene::Scene scene = test::sample_scene();
    const run::RunResult base = test::sample_result(scene);
    const run::Comparison compared = compare(run::ComparisonKind::sensitivity, scene, base, {});
    const auto expect = [&](std::string_view key, const char* title, const char* unit) {
        const auto same = [&](const run::Quantity& q) { return q.key + "_" + q.suffix == key; };
        const auto found = std::find_if(compared.quantities.begin(), compared.quantities.end(), same);
        ASSERT_NE(found, compared.quantities.end()) << key;
        EXPECT_EQ(found->name, run::uncapitalised(title));
        EXPECT_EQ(found->unit, printed_unit(unit));
    };
    for (const NamedNumber& number : deposit_numbers) expect(number.key, number.title, number.unit);
    for (const NamedPeak& peak : peak_numbers) expect(peak.key, peak.map.title, peak.map.unit);
}

TEST(NumberNames, other_languages_call_them_by_their_keys) {
    const std::string header = file_text("apps/embed/talus.h"), module = file_text("python/talus/measures.py");
    for (const NamedNumber& number : std::span(named_numbers).first<6>()) {
        EXPECT_THAT(header, HasSubstr(fmt::format("\"{}\"", number.key)));
        EXPECT_THAT(module, HasSubstr(fmt::format("_or_nan(row[\"{}\"])", number.key)));
    }
}

TEST(NumberNames, the_description_of_the_server_and_the_page_have_those_of_a_live_run) {
    const std::string protocol = file_text("src/messages/protocol.json"),
                      page = file_text("web/src/protocol/messages.ts");
    for (const NamedNumber& number : {front_number, run_out_number}) {
        EXPECT_THAT(protocol, HasSubstr(fmt::format("'{}'", number.key)));
        EXPECT_THAT(page, HasSubstr(fmt::format("\"{}\"", number.key)));
    }
    for (const NamedNumber& volume : volume_numbers) {
        EXPECT_THAT(protocol, HasSubstr(fmt::format("\"{}\": \"number", volume.key)));
        EXPECT_THAT(page, HasSubstr(fmt::format("  {}: number;", volume.key)));
    }
}

}  // namespace
}  // namespace talus::observe
