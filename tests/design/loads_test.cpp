#include "design/loads.hpp"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace talus::design {
namespace {

Load by(const std::string& name, const Approach& approach) {
    for (const LoadMethod& method : load_methods()) {
        if (method.name == name) return load_of(method, approach);
    }
    ADD_FAILURE() << "no method " << name;
    return {};
}

TEST(LoadsTest, a_stream_of_known_momentum_loads_as_by_hand) {
    const Approach stream{2000, 8, 1.5, 1.0};
    EXPECT_NEAR(by("kwan_2012_rigid", stream).pressure, 2.5 * 2000 * 64, 1e-6);  // 320 kPa
    EXPECT_NEAR(by("kwan_2012_rigid", stream).force_per_metre, 2.5 * 2000 * 64 * 1.5, 1e-6);
    EXPECT_NEAR(by("hydrostatic", stream).force_per_metre, 2000 * 9.81 * 1.5 * 1.5 / 2, 1e-6);
    EXPECT_NEAR(by("energy_run_up", stream).height, 64 / 19.62, 1e-9);
    EXPECT_NEAR(by("kwan_2012_boulder", stream).force, 0.1 * 4000e3 * std::pow(8, 1.2) * 0.25, 1e-6);
    EXPECT_NEAR(by("huebl_holzinger_2003", stream).pressure, 5 * 2000 * std::pow(8, 0.8) * std::pow(9.81 * 1.5, 0.6),
                1e-6);
}

TEST(LoadsTest, a_boulder_that_nobody_stated_has_no_load) {
    EXPECT_TRUE(std::isnan(by("kwan_2012_boulder", {2000, 8, 1.5, {}}).force));
}

TEST(LoadsTest, every_method_says_where_it_is_from_and_what_was_checked) {
    std::set<std::string> names;
    ASSERT_GE(load_methods().size(), 6U);
    for (const LoadMethod& method : load_methods()) {
        EXPECT_TRUE(names.insert(method.name).second) << method.name;
        EXPECT_FALSE(method.title.empty()) << method.name;
        EXPECT_FALSE(method.source.empty()) << method.name;
        EXPECT_FALSE(method.formula().empty()) << method.name;
        EXPECT_GT(method.coefficient, 0) << method.name;
        // Of a publication, nothing has been compared with its text; a definition needs no comparison.
        EXPECT_EQ(method.checked, !method.note.empty()) << method.name;
    }
}

}  // namespace
}  // namespace talus::design
