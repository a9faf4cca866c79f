#include <gtest/gtest.h>

#include "serve/router.hpp"
#include "serve/url.hpp"

namespace talus::serve {
namespace {

TEST(Target, is_taken_apart_and_decoded) {
    const auto target = parse_target("/api/a%20b?x_m=1.5&name=A+d%C3%A4&flag&=no");
    ASSERT_TRUE(target);
    EXPECT_EQ(target->path, "/api/a b");
    EXPECT_EQ(target->query, (Arguments{{"x_m", "1.5"}, {"name", "A d\xc3\xa4"}, {"flag", ""}}));
    for (const char* bad :
         {"", "api", "*", "http://x/", "/%", "/%4", "/%zz", "/%00", "/a%0d%0ab", "/?a=%1", "/?x_m=1&x_m=2"}) {
        EXPECT_FALSE(parse_target(bad)) << bad;
    }
}

TEST(Router, finds_routes_by_method_and_pattern) {
    Router router;
    router.add({"GET", "/api/scenarios/{s}/layers/{name}", Role::viewer, {}});
    router.add({"POST", "/api/scenarios", Role::controller, {}});
    router.add({"DELETE", "/api/scenarios/{s}", Role::controller, {}});
    const auto layer = router.find("GET", "/api/scenarios/A/layers/depth");
    ASSERT_NE(layer.route, nullptr);
    EXPECT_EQ(layer.parameters, (Arguments{{"s", "A"}, {"name", "depth"}}));
    EXPECT_NE(router.find("HEAD", "/api/scenarios/A/layers/depth").route, nullptr);
    EXPECT_EQ(router.find("PUT", "/api/scenarios").allow, "POST");
    for (const char* path : {"/api", "/api/", "/api/scenarios/", "/api/scenarios/A/layers", "/api/scenarios/A/layers/",
                             "/api/scenarios/A/layers/depth/x", "/", ""}) {
        const auto match = router.find("GET", path);
        EXPECT_TRUE(match.route == nullptr && match.allow.empty()) << path;
    }
}

}  // namespace
}  // namespace talus::serve
