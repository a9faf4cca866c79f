#include "publish/page.hpp"

#include <algorithm>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace talus::test {
namespace {

using publish::Content;
using publish::PageFiles;
using testing::HasSubstr;
using testing::Not;

constexpr PageFiles page{.script = "const a = \"</script>\";",
                         .style = "p { color: red }",
                         .worker = "onmessage = 1;",
                         .loader = "const b = \"</script>\";"};

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
    return found;
}

TEST(PublishedPage, holds_all_and_allows_no_network) {
    const std::string html = publish::one_file(page, {.title = "Slope", .about = R"({"version": 1})", .tape = "TLST"});
    EXPECT_THAT(html, HasSubstr("default-src 'none'"));
    EXPECT_THAT(html, HasSubstr("connect-src 'none'"));
    EXPECT_THAT(html,
                HasSubstr("<script type=\"text/plain\" id=\"tape\">" + publish::text_of_bytes("TLST") + "</script>"));
    EXPECT_THAT(html, HasSubstr("id=\"style\">"));
    // printf '%s' 'p { color: red }' | openssl dgst -sha256 -binary | base64
    EXPECT_THAT(html, HasSubstr("style-src 'sha256-ngewhhP73WDIbgwseeu52VAAJgKdGUsu1IUQQsAm8m4=';"));
    for (const char* loads : {" src=", "href=", "wasm-unsafe-eval", "unsafe-inline"})
        EXPECT_THAT(html, Not(HasSubstr(loads)));
}

TEST(PublishedPage, the_policy_names_the_loader_as_it_stands_in_the_file_and_the_script_as_it_is_inflated) {
    const std::string html = publish::one_file(page, {.title = "Slope", .about = "{}", .tape = ""});
    // printf '%s' 'const b = "<\/script>";' | openssl dgst -sha256 -binary | base64, and 'const a = "</script>";'
    EXPECT_THAT(html, HasSubstr("script-src 'sha256-JKuJBB5vBGeFVpd3H+K45/vZ9AC6tLMq3w2G105d7UI=' "
                                "'sha256-v9vThVENngLNExw5xkAo7yx747wZ5DcOliPYH1DwAH8=';"));
    EXPECT_THAT(html, HasSubstr("<script type=\"module\">const b = \"<\\/script>\";</script>"));
    EXPECT_THAT(html, HasSubstr("id=\"script\">"));
}

/// As web/src/protocol/block.ts reads it.
std::string bytes_of_text(const std::string& text) {
    std::string bytes;
    unsigned held = 0;
    int count = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '\xc2') continue;  // begins one of two bytes, the second of which is 128 higher
        held |= (static_cast<unsigned char>(text[i]) & 127U) << count;
        count += 7;
        if (count < 8) continue;
        bytes += static_cast<char>(held & 255U);
        held >>= 8U;
        count -= 8;
    }
    return bytes;
}

TEST(PublishedPage, bytes_become_characters_that_html_keeps) {
    std::string bytes;
    for (int k = 0; k < 70'000; ++k) bytes += static_cast<char>(k * 2654435761U >> 11U);
    for (const std::size_t size : {0, 1, 6, 7, 8, 255, 70'000}) {
        const std::string text = publish::text_of_bytes(bytes.substr(0, size));
        EXPECT_EQ(bytes_of_text(text), bytes.substr(0, size)) << size;
        EXPECT_EQ(text.find_first_of(std::string("\0\r<", 3)), std::string::npos);
    }
    const std::string zeros(7'000, '\0'), text = publish::text_of_bytes(zeros);
    EXPECT_EQ(text.size(), 16'000U);
    EXPECT_EQ(text.substr(0, 2), "\xc2\x80");
    EXPECT_LT(publish::text_of_bytes(bytes).size(), 1.18 * 70'000);
}

TEST(PublishedPage, a_title_is_text) {
    const std::string title = "</title></script><img src=x onerror=alert(1)> & \"Co\"";
    const std::string html =
        publish::one_file(page, {.title = title, .about = nlohmann::json({{"title", title}}).dump(), .tape = ""});
    EXPECT_THAT(html, HasSubstr("<title>&lt;/title&gt;&lt;/script&gt;&lt;img src=x onerror=alert(1)&gt; &amp; "
                                "&quot;Co&quot; · talus</title>"));
    EXPECT_THAT(html, Not(HasSubstr("<img")));
    EXPECT_EQ(count(html, "</script>"), 5U);  // of about, style, script, tape and the loader
}

TEST(PublishedPage, an_engine_comes_with_its_scene_and_may_be_compiled) {
    const Content content{
        .title = "Slope", .about = "{}", .tape = "", .engine = publish::Engine{"js", "wasm"}, .scene = "packed"};
    const std::string html = publish::one_file(page, content);
    EXPECT_THAT(html, HasSubstr("'wasm-unsafe-eval'"));
    for (const char* id : {"scene", "worker", "engine"}) {
        EXPECT_THAT(html, HasSubstr("<script type=\"text/plain\" id=\"" + std::string(id) + "\">"));
    }
}

TEST(PublishedPage, the_engines_script_stands_before_the_worker_and_exports_nothing) {
    const Content content{.title = "Slope",
                          .about = {},
                          .tape = "",
                          .engine = publish::Engine{"var Module = 1;\nexport default Module;\n", "wasm"}};
    const auto files = publish::folder(page, content);
    const auto worker =
        std::find_if(files.begin(), files.end(), [](const publish::File& f) { return f.name == "worker.js"; });
    ASSERT_NE(worker, files.end());
    EXPECT_EQ(worker->bytes, "var Module = 1;\nglobalThis.talusEngine = Module;\n\n{\nonmessage = 1;\n}\n");
}

TEST(PublishedPage, a_folder_has_what_its_page_loads) {
    const auto files = publish::folder(page, {.title = "Slope", .about = R"({"version": 1})", .tape = "TLST"});
    const auto content = [&](const std::string& name) {
        const auto found =
            std::find_if(files.begin(), files.end(), [&](const publish::File& f) { return f.name == name; });
        return found == files.end() ? std::string("none") : found->bytes;
    };
    EXPECT_EQ(content("tape.bin"), "TLST");
    EXPECT_EQ(content("page.js"), page.script);
    EXPECT_EQ(content("page.css"), page.style);
    EXPECT_THAT(content("index.html"), HasSubstr("connect-src 'self'"));
    EXPECT_THAT(content("index.html"), HasSubstr("<script type=\"module\" src=\"page.js\">"));
    EXPECT_EQ(content("talus_engine.wasm"), "none");
}

}  // namespace
}  // namespace talus::test
