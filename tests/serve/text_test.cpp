#include <gtest/gtest.h>

#include "serve/router.hpp"

namespace talus::serve {
namespace {

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
