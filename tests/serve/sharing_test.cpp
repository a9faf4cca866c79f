#include "serve/sharing.hpp"

#include <netdb.h>
#include <netinet/in.h>
#include <openssl/err.h>
#include <openssl/ssl.h>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "serve/certificate.hpp"
#include "serve/serve_fixture.hpp"

namespace talus::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

/// What a server answers to a request over TLS; empty: no connection.
std::string over_tls(const std::string& host, const std::string& request) {
    SSL_CTX* context = SSL_CTX_new(TLS_client_method());
    BIO* connection = BIO_new_ssl_connect(context);
    BIO_set_conn_hostname(connection, host.c_str());
    std::string answer;
    if (BIO_do_connect(connection) == 1 &&
        BIO_write(connection, request.data(), static_cast<int>(request.size())) > 0) {
        char block[4096];
        for (int count; (count = BIO_read(connection, block, sizeof block)) > 0;)
            answer.append(block, static_cast<std::size_t>(count));
    }
    BIO_free_all(connection);
    SSL_CTX_free(context);
    return answer;
}

/// The same without TLS.
std::string over_tcp(const std::string& host, const std::string& request) {
    BIO* connection = BIO_new_connect(host.c_str());
    std::string answer;
    if (BIO_do_connect(connection) == 1 &&
        BIO_write(connection, request.data(), static_cast<int>(request.size())) > 0) {
        char block[4096];
        for (int count; (count = BIO_read(connection, block, sizeof block)) > 0;)
            answer.append(block, static_cast<std::size_t>(count));
    }
    BIO_free_all(connection);
    return answer;
}

class SharingTest : public Serve {
  protected:
    void SetUp() override {
        Serve::SetUp();
        const json now = as_controller().get("/api/share").json();
        EXPECT_TRUE(now["shared"].is_null()) << "off unless asked for";
        if (now["addresses"].empty()) GTEST_SKIP() << "this machine has no address that others could reach";
        address = now["addresses"][0];
    }
    Answer share(json wanted) {
        wanted["address"] = address;
        return as_controller().post("/api/share", wanted);
    }
    [[nodiscard]] static std::string request(const std::string& host, const std::string& token) {
        return fmt::format(
            "GET /api/scene HTTP/1.1\r\nHost: {}\r\nAuthorization: Bearer {}\r\nConnection: close\r\n\r\n", host,
            token);
    }
    std::string address;
};

TEST_F(SharingTest, others_reach_the_session_by_the_address_until_it_is_stopped) {
    const Answer shared = share(json::object());
    ASSERT_EQ(shared.status, 200) << shared.body;
    const std::string host = shared.json()["shared"]["host"];
    EXPECT_EQ(host.find(address), address.find(':') == std::string::npos ? 0U : 1U);
    EXPECT_EQ(shared.json()["shared"]["viewer_url"], fmt::format("http://{}/#token={}", host, viewer));
    EXPECT_EQ(shared.json()["shared"]["encrypted"], false);
    EXPECT_THAT(over_tcp(host, request(host, viewer)), HasSubstr("Plane"));
    EXPECT_THAT(over_tcp(host, request(host, "")), HasSubstr("401"));
    EXPECT_THAT(over_tcp(host, request("evil.example.org", viewer)), HasSubstr("403"));
    EXPECT_EQ(share(json::object()).status, 409) << "it is open already";
    EXPECT_TRUE(as_controller().ask("DELETE", "/api/share").json()["shared"].is_null());
    EXPECT_EQ(over_tcp(host, request(host, viewer)), "");
    const std::string inner = fmt::format("127.0.0.1:{}", port());
    EXPECT_THAT(over_tcp(inner, request(host, viewer)), HasSubstr("403")) << "its name is forgotten";
}

TEST_F(SharingTest, with_a_certificate_it_is_encrypted) {
    const Pair pair = self_signed();
    const Answer shared = share({{"certificate", pair.certificate}, {"key", pair.key}});
    ASSERT_EQ(shared.status, 200) << shared.body;
    EXPECT_EQ(shared.body.find("PRIVATE"), std::string::npos);
    const std::string host = shared.json()["shared"]["host"];
    EXPECT_EQ(shared.json()["shared"]["viewer_url"], fmt::format("https://{}/#token={}", host, viewer));
    EXPECT_THAT(over_tls(host, request(host, viewer)), HasSubstr("Plane"));
    EXPECT_EQ(over_tcp(host, request(host, viewer)).find("Plane"), std::string::npos);
    // The terrain is longer than a block, and a second connection goes on beside the first.
    std::string terrain = request(host, viewer);
    terrain.replace(terrain.find("/api/scene"), 10, "/api/openapi.json");
    EXPECT_GT(over_tls(host, terrain).size(), 50000U);
    as_controller().ask("DELETE", "/api/share");
    EXPECT_EQ(over_tls(host, request(host, viewer)), "");
}

TEST_F(SharingTest, what_makes_no_sense_is_refused_and_viewers_may_not) {
    const Pair pair = self_signed(), other = self_signed();
    EXPECT_EQ(as_controller().post("/api/share", {{"address", "127.0.0.1"}}).status, 409);
    EXPECT_EQ(as_controller().post("/api/share", {{"address", "0.0.0.0"}}).status, 409);
    EXPECT_THAT(share({{"certificate", "no"}, {"key", "no"}}).body, HasSubstr("certificate: is not a certificate"));
    EXPECT_THAT(share({{"certificate", pair.certificate}, {"key", other.key}}).body, HasSubstr("key: "));
    EXPECT_EQ(share({{"certificate", pair.certificate}}).status, 400);
    EXPECT_EQ(share({{"port", 70000}}).status, 400);
    EXPECT_THAT(share({{"port", 1.5}}).body, ::testing::HasSubstr("port = 1.5: must be a whole number"));
    EXPECT_THAT(share({{"name", "a b"}}).body, HasSubstr("name: "));
    EXPECT_EQ(as_viewer().get("/api/share").status, 403);
    EXPECT_EQ(as_viewer().post("/api/share", {{"address", address}}).status, 403);
    EXPECT_TRUE(as_controller().get("/api/share").json()["shared"].is_null());
}

}  // namespace
}  // namespace talus::test
