#include "params/contours.hpp"

#include <gmock/gmock.h>

namespace talus::params {
namespace {

using testing::HasSubstr;

TEST(ContoursOf, a_map_have_its_values_in_order_and_once) {
    const auto all = contours_of({"peak_depth=2,0.5,1", "arrival_time=10", "peak_depth=1,3"});
    ASSERT_TRUE(all) << all.error().message;
    ASSERT_EQ(all->size(), 2U);
    EXPECT_EQ((*all)[0].map, "peak_depth");
    EXPECT_EQ((*all)[0].values, (std::vector<double>{0.5, 1, 2, 3}));
    EXPECT_EQ((*all)[1].values, (std::vector<double>{10}));
}

TEST(ContoursOf, what_is_no_map_are_refused_with_the_maps) {
    const auto refused = contours_of(std::string_view("depth=1"));
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("\"depth\" is no map with contours; the maps are peak_depth, "));
    for (const std::string_view map : contour_maps) EXPECT_THAT(refused.error().message, HasSubstr(std::string(map)));
}

TEST(ContoursOf, what_is_no_number_above_zero_are_refused) {
    for (const char* text : {"peak_depth", "peak_depth=", "peak_depth=1,", "peak_depth=1,x", "peak_depth=0",
                             "peak_depth=-1", "peak_depth=inf", "peak_depth=nan", "peak_depth=1 m"}) {
        const auto refused = contours_of(std::string_view(text));
        ASSERT_FALSE(refused) << text;
        EXPECT_THAT(refused.error().message, HasSubstr("is no value of a contour; give peak_depth=VALUE")) << text;
    }
}

}  // namespace
}  // namespace talus::params
