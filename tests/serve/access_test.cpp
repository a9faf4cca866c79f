#include "serve/access.hpp"

#include <gtest/gtest.h>

namespace talus::serve {
namespace {

const Tokens tokens{"0123456789abcdef-controller", "0123456789abcdef-viewer"};

TEST(Access, knows_its_hosts_with_their_port_alone) {
    const Access access(tokens, "127.0.0.1", 8123, {"twin.example.org", "10.0.0.5:9000", "fe80::1"});
    for (const char* host : {"127.0.0.1:8123", "localhost:8123", "LOCALHOST:8123", "[::1]:8123",
                             "twin.example.org:8123", "Twin.Example.org", "10.0.0.5:9000", "[fe80::1]:8123"}) {
        EXPECT_TRUE(access.host_allowed(host)) << host;
    }
    for (const char* host : {"", "127.0.0.1", "127.0.0.1:80", "localhost:81230", "evil.example.org:8123", "::1:8123",
                             "10.0.0.5:8123", "10.0.0.5", "localhost:8123.evil.org", "127.0.0.1:8123 "}) {
        EXPECT_FALSE(access.host_allowed(host)) << host;
    }
}

TEST(Access, origin_is_that_of_the_host) {
    const Access access(tokens, "127.0.0.1", 8123, {"twin.example.org"});
    EXPECT_TRUE(access.origin_allowed("http://localhost:8123", "localhost:8123"));
    EXPECT_TRUE(access.origin_allowed("https://twin.example.org", "twin.example.org"));
    EXPECT_FALSE(access.origin_allowed("http://127.0.0.1:8123", "localhost:8123"));
    EXPECT_FALSE(access.origin_allowed("http://localhost:8124", "localhost:8123"));
    EXPECT_FALSE(access.origin_allowed("null", "localhost:8123"));
    EXPECT_FALSE(access.origin_allowed("http://localhost:8123.evil.org", "localhost:8123"));
}

TEST(Access, tells_roles_by_token) {
    const Access access(tokens, "", 8123, {});
    EXPECT_EQ(access.role_of(tokens.controller), Role::controller);
    EXPECT_EQ(access.role_of(tokens.viewer), Role::viewer);
    EXPECT_EQ(access.role_of(""), Role::nobody);
    EXPECT_EQ(access.role_of(tokens.viewer + "x"), Role::nobody);
    EXPECT_EQ(access.role_of(tokens.viewer.substr(1)), Role::nobody);
    EXPECT_EQ(access.role_of(std::string(tokens.viewer.size(), '\0')), Role::nobody);
    const Access without(Tokens{}, "", 8123, {});
    EXPECT_EQ(without.role_of(""), Role::nobody);
}

TEST(Tokens, are_random_and_long) {
    const auto one = random_token(), other = random_token();
    ASSERT_TRUE(one && other);
    EXPECT_EQ(one->size(), 32U);
    EXPECT_NE(*one, *other);
    EXPECT_TRUE(check_tokens({*one, *other}));
}

TEST(Tokens, that_somebody_chose_are_checked) {
    EXPECT_TRUE(check_tokens(tokens));
    EXPECT_FALSE(check_tokens({"short", tokens.viewer}));
    EXPECT_FALSE(check_tokens({"0123456789abcdef&x=1", tokens.viewer}));
    EXPECT_FALSE(check_tokens({tokens.viewer, tokens.viewer}));
    EXPECT_FALSE(check_tokens({std::string(200, 'a'), tokens.viewer}));
}

}  // namespace
}  // namespace talus::serve
