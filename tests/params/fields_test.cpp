#include "params/fields.hpp"

#include <cmath>
#include <limits>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace talus::params {
namespace {

const Parameter& parameter(const std::string& section, const std::string& key) {
    const Section* found = find_section(section);
    EXPECT_NE(found, nullptr) << section;
    const Parameter* p = found->find(key);
    EXPECT_NE(p, nullptr) << key;
    return *p;
}

TEST(FieldTable, every_key_has_help_and_a_unique_name) {
    for (const Section& section : scene_sections()) {
        EXPECT_FALSE(section.help.empty()) << section.name;
        std::set<std::string> keys;
        for (const Parameter& p : section.parameters) {
            EXPECT_TRUE(keys.insert(p.key).second) << section.name << "." << p.key;
            EXPECT_TRUE(!p.help.empty() && p.help.back() == '.') << section.name << "." << p.key;
        }
    }
}

/// Converts to any member.
struct Anything {
    template <class T>
    operator T() const;
};

/// How many members an aggregate has.
template <class T, class... Members>
constexpr std::size_t members() {
    if constexpr (requires { T{Members{}..., Anything{}}; }) {
        return members<T, Members..., Anything>();
    } else {
        return sizeof...(Members);
    }
}

TEST(FieldTable, every_member_is_declared) {
    const auto declared = [](const char* section) { return find_section(section)->parameters.size(); };
    EXPECT_EQ(declared("scene"), members<SceneInfo>());
    EXPECT_EQ(declared("report"), members<ReportSpec>());
    EXPECT_EQ(declared("terrain"), members<TerrainSpec>());
    EXPECT_EQ(declared("release"), members<ReleaseSpec>());
    EXPECT_EQ(declared("bed"), members<BedSpec>());
    EXPECT_EQ(declared("inflow"), members<InflowSpec>());
    EXPECT_EQ(declared("buildings"), members<BuildingsSpec>() - 1 + members<BuildingSpec>());
    EXPECT_EQ(declared("barrier"), members<BarrierSpec>() - 1) << "openings are a section of their own";
    EXPECT_EQ(declared("barrier_opening"), members<BarrierOpeningSpec>());
    EXPECT_EQ(declared("flow_path"), members<FlowPathSpec>());
    EXPECT_EQ(declared("material"), members<MaterialSpec>());
    EXPECT_EQ(declared("zone"), members<ZoneSpec>());
    EXPECT_EQ(declared("solver"), members<SolverSpec>());
    EXPECT_EQ(declared("outputs"), members<OutputSpec>());
    EXPECT_EQ(declared("gauge"), members<GaugeSpec>());
    EXPECT_EQ(declared("cross_section"), members<CrossSectionSpec>());
    EXPECT_EQ(declared("observation"), members<ObservationSpec>());
    EXPECT_EQ(declared("superelevation"), members<SuperelevationSpec>());
    EXPECT_EQ(declared("arrival"), members<ArrivalSpec>());
    EXPECT_EQ(declared("run_up"), members<RunUpSpec>());
    EXPECT_EQ(declared("deposit_depth"), members<DepositDepthSpec>());
    EXPECT_EQ(declared("damage"), members<DamageSpec>());
    EXPECT_EQ(declared("observed_run_out"), members<ObservedRunOutSpec>());
    EXPECT_EQ(declared("deposit_outline"), members<OutlineSpec>());
    EXPECT_EQ(declared("affected_area"), members<OutlineSpec>());
    EXPECT_EQ(declared("elevation_change"), members<ElevationChangeSpec>());
}

TEST(FieldTable, the_day_of_a_report_is_an_iso_date) {
    const Section& section = *find_section("report");
    SceneSpec spec;
    for (const char* day : {"", "2026-11-23", "2024-02-29"}) {
        spec.report.date = day;
        EXPECT_FALSE(broken_rule(section, spec, 0, 0)) << day;
    }
    for (const char* day : {"23.11.2026", "2026-13-01", "2026-02-29", "2026-11-00", "2026-1-01", " 2026-1-1 ",
                            "2026-11-23T", "2026/11/23", "-026-11-23", "today"}) {
        spec.report.date = day;
        const auto broken = broken_rule(section, spec, 0, 0);
        ASSERT_TRUE(broken) << day;
        EXPECT_EQ(broken->key, "date");
        EXPECT_THAT(broken->text, testing::HasSubstr("must be a day as YYYY-MM-DD"));
    }
}

TEST(FieldTable, pore_pressure_that_evolves_needs_the_soil_and_contradicts_a_time_of_decay) {
    const Section& section = *find_section("material");
    SceneSpec spec;
    MaterialSpec& material = spec.material;
    const auto expect_broken = [&](const char* key, const char* says) {
        const auto broken = broken_rule(section, spec, 0, 0);
        ASSERT_TRUE(broken) << key;
        EXPECT_EQ(broken->key, key);
        EXPECT_THAT(broken->text, testing::HasSubstr(says));
    };
    material.permeability = 1e-10;
    expect_broken("permeability_m2", "has no effect while pore_pressure = \"prescribed\"");
    material = {};
    material.pore_pressure = PorePressure::dilatancy;
    expect_broken("permeability_m2", "missing");
    material.permeability = 1e-10;
    expect_broken("solid_fraction", "0.4 to 0.75");
    material.solid_fraction = 0.6;
    expect_broken("critical_solid_fraction", "missing");
    material.critical_solid_fraction = 0.62;
    EXPECT_FALSE(broken_rule(section, spec, 0, 0)) << "2650 x 0.6 + 1100 x 0.4 = 2030";
    material.pore_pressure_decay_time = 10;
    expect_broken("pore_pressure_decay_time_s", "leave one of them out");
    material.pore_pressure_decay_time.reset();
    material.rest_density = 1600;
    expect_broken("rest_density_kgpm3", "must be within 5 % of 2030");

    spec = {};
    spec.releases.emplace_back().solid_fraction = 0.5;
    const auto broken = broken_rule(*find_section("release"), spec, 0, 0);
    ASSERT_TRUE(broken);
    EXPECT_EQ(broken->key, "solid_fraction");
}

TEST(FieldTable, keys_of_measures_end_in_their_unit) {
    const std::vector<std::pair<std::string, std::string>> suffixes = {
        {"m", "_m"},   {"s", "_s"},   {"m/s", "_mps"},  {"kg/m3", "_kgpm3"},
        {"m3", "_m3"}, {"Pa", "_Pa"}, {"m/s2", "_mps2"}};
    for (const Section& section : scene_sections()) {
        for (const Parameter& p : section.parameters) {
            for (const auto& [unit, suffix] : suffixes) {
                if (p.unit == unit) {
                    EXPECT_THAT(p.key, testing::EndsWith(suffix));
                }
            }
        }
    }
}

TEST(FieldTable, every_default_is_allowed) {
    for (const Section& section : scene_sections()) {
        for (const Parameter& p : section.parameters) {
            const ParameterValue value = default_value(section, p);
            if (std::holds_alternative<std::monostate>(value)) {
                EXPECT_TRUE(p.required || !p.absent.empty())
                    << section.name << "." << p.key << " says not what happens";
            } else {
                EXPECT_EQ(problem_with(p, value), "") << section.name << "." << p.key;
            }
        }
    }
}

/// A value of the parameter's kind that is allowed and is not its default.
ParameterValue other_value(const Section& section, const Parameter& p) {
    const ParameterValue usual = default_value(section, p);
    switch (p.kind) {
        case ParameterKind::boolean:
            return !std::get<bool>(usual);
        case ParameterKind::integer:
            return std::holds_alternative<std::monostate>(usual) ? std::int64_t{7} : std::get<std::int64_t>(usual) + 1;
        case ParameterKind::number:
            for (const double candidate : {0.75, 1.75, 0.25, 0.55, 0.05, 1e-9, 1250.0}) {
                if (p.range.contains(candidate) && toml_text(candidate) != toml_text(usual)) return candidate;
            }
            break;
        case ParameterKind::choice:
            return p.choices.back();
        case ParameterKind::text:
        case ParameterKind::path:
            return std::string("other");
        case ParameterKind::text_list:
            return std::vector<std::string>{"one", "two"};
        case ParameterKind::extent:
            return Extent{1, 2, 3, 4};
        case ParameterKind::points:
            return std::vector<PlanPoint>{{1, 2}, {3, 4}};
    }
    ADD_FAILURE() << p.key;
    return {};
}

bool same(const ParameterValue& a, const ParameterValue& b) {
    return a.index() == b.index() && toml_text(a) == toml_text(b);
}

TEST(FieldTable, every_key_sets_its_own_member_and_no_other) {
    for (const Section& section : scene_sections()) {
        for (const Parameter& p : section.parameters) {
            SceneSpec spec;
            for (const Section& repeated : scene_sections()) {
                if (!repeated.repeats) continue;
                repeated.append(spec);
                repeated.append(spec);
            }
            const SceneSpec before = spec;
            const std::size_t index = section.repeats ? 1 : 0;
            const ParameterValue value = other_value(section, p);
            p.set(spec, index, value);
            int changed = 0;
            for_each_value(spec, [&](const Section& s, std::size_t i, const Parameter& q, const ParameterValue& now) {
                if (!same(now, q.get(before, i))) {
                    ++changed;
                    EXPECT_EQ(key_path(s, i, q), key_path(section, index, p));
                    EXPECT_TRUE(same(now, value));
                }
            });
            EXPECT_EQ(changed, 1) << key_path(section, index, p);
        }
    }
}

TEST(FieldTable, ties_of_a_key_are_rules) {
    SceneSpec spec;
    spec.barriers.emplace_back().height = 2;
    spec.zones.emplace_back().friction_coefficient = 0.3;
    const auto broken = [&](const char* section, double spacing) {
        const auto rule = broken_rule(*find_section(section), spec, 0, spacing);
        return rule ? rule->key + rule->text : "";
    };
    BarrierSpec& barrier = spec.barriers.front();
    barrier.thickness = 0.6;
    EXPECT_EQ(broken("barrier", 1.2), "");
    EXPECT_EQ(broken("barrier", 1.3),
              "thickness_m = 0.6 is refused; with particles of 1.3 m it must be at least 0.65 m: thinner walls let "
              "debris interact across them");
    barrier.clearance = 2;
    EXPECT_EQ(broken("barrier", 0), "clearance_m = 2 is refused; it must be below height_m = 2");
    barrier.height.reset();
    EXPECT_EQ(broken("barrier", 0), "") << "the crest is level";
    spec.zones.front().cohesion = 0;
    spec.material.cohesion = 0;
    EXPECT_EQ(broken("zone", 0), "");
    spec.solver.internal_friction = InternalFriction::pair;
    EXPECT_EQ(broken("material", 0), "") << "0 asks for nothing";
    EXPECT_EQ(broken("zone", 0),
              "cohesion_Pa: needs solver.internal_friction = \"stress\"; friction by pairs has no such law");
}

TEST(FieldTable, an_absent_value_can_be_taken_back) {
    SceneSpec spec;
    const Parameter& p = parameter("solver", "time_step_s");
    p.set(spec, 0, 0.01);
    ASSERT_TRUE(spec.solver.time_step.has_value());
    p.set(spec, 0, {});
    EXPECT_FALSE(spec.solver.time_step.has_value());
}

TEST(FieldTable, values_out_of_range_name_the_range) {
    const Parameter& spacing = parameter("solver", "particle_spacing_m");
    EXPECT_EQ(problem_with(spacing, 0.5), "");
    EXPECT_EQ(problem_with(spacing, 0.0), "a number from 0.0001 to 100 (m)");
    const Parameter& viscosity = parameter("material", "viscosity");
    EXPECT_EQ(problem_with(viscosity, 0.0), "");
    EXPECT_EQ(problem_with(viscosity, 1.0), "a number from 0 to below 1");
    EXPECT_EQ(problem_with(parameter("outputs", "geoid_height_m"), 300.0), "a number from -200 to 200 (m)");
    const Parameter& band = parameter("terrain", "band");
    EXPECT_EQ(problem_with(band, std::int64_t{0}), "a whole number from 1 to 65535");
    EXPECT_EQ(problem_with(parameter("solver", "kernel"), std::string("gauss")),
              R"(one of "wendland_c2", "cubic_spline", "spiky", "poly6_spiky")");
}

TEST(FieldTable, numbers_that_are_not_finite_are_refused) {
    const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
    EXPECT_NE(problem_with(parameter("release", "start_time_s"), infinity), "");
    EXPECT_NE(problem_with(parameter("release", "start_time_s"), nan), "");
    EXPECT_NE(problem_with(parameter("terrain", "extent_m"), Extent{0, 0, infinity, 1}), "");
}

TEST(FieldTable, an_extent_must_have_an_area) {
    const Parameter& extent = parameter("terrain", "extent_m");
    EXPECT_EQ(problem_with(extent, Extent{0, 0, 1, 1}), "");
    EXPECT_NE(problem_with(extent, Extent{1, 0, 0, 1}), "");
    EXPECT_NE(problem_with(extent, Extent{0, 1, 1, 1}), "");
}

TEST(FieldTable, choices_follow_the_enumeration) {
    SceneSpec spec;
    const Parameter& kernel = parameter("solver", "kernel");
    EXPECT_EQ(kernel.choices.size(), 4U);
    kernel.set(spec, 0, std::string("cubic_spline"));
    EXPECT_EQ(spec.solver.kernel, KernelChoice::cubic_spline);
    kernel.set(spec, 0, std::string("poly6_spiky"));
    EXPECT_EQ(spec.solver.kernel, KernelChoice::poly6_spiky);
    EXPECT_EQ(plain_text(kernel.get(spec, 0)), "poly6_spiky");
}

TEST(NearestWord, takes_the_smallest_edit_distance) {
    EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
    EXPECT_EQ(edit_distance("", "abc"), 3U);
    EXPECT_EQ(nearest_word("viscocity", {"friction_coefficient", "viscosity"}), "viscosity");
    EXPECT_EQ(nearest_word("friction", {"viscosity", "friction_coefficient"}), "friction_coefficient")
        << "as it begins";
    EXPECT_EQ(nearest_word("frictoin", {"viscosity", "friction_coefficient"}), "friction_coefficient");
}

TEST(KeysCalled, are_found_by_what_others_call_them_whatever_the_spelling) {
    const Section& material = *find_section("material");
    EXPECT_THAT(keys_called(material, "mu"), ::testing::ElementsAre("friction_coefficient", "viscosity"));
    EXPECT_THAT(keys_called(material, "xsiVoellmy"), ::testing::ElementsAre("turbulent_friction_mps2"));
    EXPECT_THAT(keys_called(material, "yield-stress"), ::testing::ElementsAre("cohesion_Pa"));
    EXPECT_TRUE(keys_called(material, "friction_coefficient").empty()) << "its own name is no synonym";
    EXPECT_TRUE(keys_called(material, "").empty());
}

TEST(KeysCalled, are_keys_of_no_section_under_that_name) {
    for (const Section& section : scene_sections()) {
        for (const Parameter& parameter : section.parameters) {
            for (const std::string& synonym : parameter.synonyms) {
                EXPECT_EQ(section.find(synonym), nullptr) << section.name << "." << synonym;
            }
        }
    }
}

}  // namespace
}  // namespace talus::params
