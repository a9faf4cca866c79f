#include "publish/tape.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <zlib.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace talus::test {
namespace {

using nlohmann::json;
using publish::Tape;

std::string inflated(std::string_view bytes, std::size_t whole) {
    std::string text(whole, '\0');
    uLongf size = whole;
    const int code = uncompress(reinterpret_cast<Bytef*>(text.data()), &size,
                                reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    EXPECT_EQ(code, Z_OK);
    EXPECT_EQ(size, whole);
    return text;
}

std::size_t number_at(std::string_view bytes, std::size_t at) {
    std::size_t value = 0;
    for (std::size_t k = 4; k-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
    return value;
}

/// A tape as its reader has it.
struct Read {
    json head;
    std::string bodies;
    explicit Read(const std::string& bytes) {
        EXPECT_EQ(bytes.substr(0, 4), "TLST");
        EXPECT_EQ(number_at(bytes, 4), 1U);
        const std::size_t packed = number_at(bytes, 8);
        head = json::parse(inflated(std::string_view(bytes).substr(16, packed), number_at(bytes, 12)));
        bodies = bytes.substr(16 + packed);
    }
    [[nodiscard]] std::string body(const json& kept) const {
        const std::string part = bodies.substr(kept.at("at"), kept.at("size"));
        return kept.contains("whole") ? inflated(part, kept.at("whole")) : part;
    }
};

TEST(Tape, gives_back_messages_and_answers) {
    Tape tape;
    tape.say({{"type", "hello"}});
    tape.say({{"type", "state"}, {"scenario", "A"}});
    const std::string series(1000, 'x');
    tape.add("scenarios/A/series", "application/json", series);
    tape.add("terrain", "application/octet-stream", "TLSG as it is");
    const Read read(tape.pack());
    EXPECT_EQ(read.head["messages"], json::parse(R"([{"type": "hello"}, {"type": "state", "scenario": "A"}])"));
    const json& kept = read.head["answers"]["scenarios/A/series"];
    EXPECT_EQ(read.body(kept), series);
    EXPECT_EQ(kept["type"], "application/json");
    EXPECT_LT(kept["size"], 100);
    const json& grid = read.head["answers"]["terrain"];
    EXPECT_FALSE(grid.contains("whole"));  // deflated already
    EXPECT_EQ(read.body(grid), "TLSG as it is");
}

TEST(Tape, keeps_what_did_not_change_once) {
    Tape tape;
    tape.add_at("scenarios/A/impacts", 0, "application/json", "none");
    tape.add_at("scenarios/A/impacts", 1, "application/json", "none");
    tape.add_at("scenarios/B/impacts", 1, "application/json", "none");
    tape.add_at("scenarios/A/impacts", 2, "application/json", "House 38");
    tape.add_at("scenarios/A/impacts", 3, "application/json", "none");
    const Read read(tape.pack());
    const json& times = read.head["times"]["scenarios/A/impacts"];
    ASSERT_EQ(times.size(), 3U);
    EXPECT_EQ(times[0]["time_s"], 0);
    EXPECT_EQ(times[1]["time_s"], 2);
    EXPECT_EQ(read.body(times[1]), "House 38");
    EXPECT_EQ(times[2]["time_s"], 3);
    EXPECT_EQ(read.head["times"]["scenarios/B/impacts"].size(), 1U);
}

TEST(Tape, keeps_bodies_that_are_the_same_once) {
    Tape tape;
    tape.add("scenarios/A/layers/depth", "application/octet-stream", "TLSG of the end");
    const std::size_t once = tape.size();
    tape.add_at("scenarios/A/layers/depth", 9, "application/octet-stream", "TLSG of the end");
    EXPECT_EQ(tape.size(), once);
    const Read read(tape.pack());
    EXPECT_EQ(read.body(read.head["times"]["scenarios/A/layers/depth"][0]), "TLSG of the end");
}

TEST(Tape, a_name_that_is_no_UTF_8_does_not_break_it) {
    Tape tape;
    tape.say({{"type", "setup"},
              {"name",
               "Stra\xdf"
               "e"}});
    EXPECT_EQ(Read(tape.pack()).head["messages"][0]["name"],
              "Stra\xef\xbf\xbd"
              "e");
}

}  // namespace
}  // namespace talus::test
