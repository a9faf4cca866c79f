#include "publish/compact_grid.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>
#include <zlib.h>

#include <gtest/gtest.h>

#include "publish/tape.hpp"

namespace talus::test {
namespace {

/// As docs/protocol.md has it, of one row.
std::string message_of(const std::vector<float>& values, char coding) {
    std::string body(values.size() * sizeof(float), '\0');
    std::memcpy(body.data(), values.data(), body.size());
    std::string head("TLSG\x02\0\0\0", 8);
    head[5] = coding;
    head.resize(44, '\0');
    const auto columns = static_cast<std::uint32_t>(values.size()), rows = 1U;
    const auto size = static_cast<std::uint32_t>(body.size());
    std::memcpy(head.data() + 32, &columns, 4);
    std::memcpy(head.data() + 36, &rows, 4);
    std::memcpy(head.data() + 40, &size, 4);
    return head + publish::deflated(body);
}

std::string body_of(const std::string& message) {
    std::uint32_t size = 0;
    std::memcpy(&size, message.data() + 40, 4);
    std::string body(size, '\0');
    uLongf filled = size;
    EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(body.data()), &filled,
                         reinterpret_cast<const Bytef*>(message.data() + 44), message.size() - 44),
              Z_OK);
    EXPECT_EQ(filled, size);
    return body;
}

TEST(CompactGrid, rounds_values_of_a_map_and_lays_their_bytes_in_planes) {
    constexpr float infinity = std::numeric_limits<float>::infinity(), largest = std::numeric_limits<float>::max();
    const std::vector<float> values = {0.0F, 1.2345678F, -3.3333333F, 12345.678F, 1e-7F, infinity, NAN, largest};
    const std::string kept = publish::compact_grid(message_of(values, 0));
    EXPECT_EQ(kept[5], 2);
    const std::string planes = body_of(kept);
    for (std::size_t i = 0; i < values.size(); ++i) {
        std::uint32_t bits = 0;
        for (std::size_t plane = 0; plane < 4; ++plane) {
            bits |= std::uint32_t{static_cast<unsigned char>(planes[plane * values.size() + i])} << 8 * plane;
        }
        EXPECT_EQ(bits & 0xffU, 0U) << i;
        float value = 0;
        std::memcpy(&value, &bits, 4);
        if (std::isnan(values[i])) {
            EXPECT_TRUE(std::isnan(value));
        } else if (std::isinf(values[i]) || values[i] == largest) {
            EXPECT_EQ(value, infinity) << "the largest number rounds up";
        } else {
            EXPECT_NEAR(value, values[i], std::abs(values[i]) / 65'536);
        }
    }
}

TEST(CompactGrid, keeps_terrain_and_what_is_no_grid_to_the_bit) {
    const std::vector<float> terrain(500, 7.1234567F);
    const std::string kept = publish::compact_grid(message_of(terrain, 1));
    EXPECT_EQ(kept[5], 1);
    EXPECT_EQ(body_of(kept), body_of(message_of(terrain, 1)));
    std::string longer = message_of(terrain, 1);
    longer[33] = 100;  // more columns than there are bytes for
    EXPECT_EQ(publish::compact_grid(longer), longer);
    for (const char* other :
         {"", "TLSG", "TLSF and more", "TLSG\x02 of a length that is not that of its bytes, and so on"})
        EXPECT_EQ(publish::compact_grid(other), other);
}

}  // namespace
}  // namespace talus::test
