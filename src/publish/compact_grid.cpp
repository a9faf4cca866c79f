#include "publish/compact_grid.hpp"

#include <array>
#include <cstdint>
#include <cstring>
#include <vector>
#include <zlib.h>

#include "core/byte_planes.hpp"
#include "publish/tape.hpp"

namespace talus::publish {
namespace {

constexpr std::size_t head_size = 44, coding_at = 5;
constexpr char as_values = 0, as_planes = 2;

/// The bits of a float, 15 of its 23 fraction bits left. Infinities and NaN stay what they are.
std::uint32_t rounded(std::uint32_t bits) {
    constexpr std::uint32_t dropped = 8, half = 1U << (dropped - 1), exponent = 0x7f800000U;
    if ((bits & exponent) == exponent) return bits;
    return (bits + half) >> dropped << dropped;
}

}  // namespace

std::string compact_grid(std::string_view message) {
    if (!message.starts_with("TLSG\x02") || message.size() < head_size) return std::string(message);
    std::array<std::uint32_t, 3> counts{};  // columns, rows, bytes
    std::memcpy(counts.data(), message.data() + head_size - sizeof counts, sizeof counts);
    const std::uint32_t size = counts[2];
    std::string head(message.substr(0, head_size));
    const std::string_view packed = message.substr(head_size);
    constexpr std::uint64_t most_inflated = 1032;  // what a byte of deflate can become
    const bool fits = size == sizeof(float) * std::uint64_t{counts[0]} * counts[1];
    if (!fits || size > most_inflated * packed.size()) return std::string(message);
    std::string body(size, '\0');
    uLongf filled = size;
    const int code = uncompress(reinterpret_cast<Bytef*>(body.data()), &filled,
                                reinterpret_cast<const Bytef*>(packed.data()), static_cast<uLong>(packed.size()));
    if (code != Z_OK || filled != size) return std::string(message);
    if (head[coding_at] == as_values) {
        std::vector<std::uint32_t> numbers(size / sizeof(std::uint32_t));
        if (size > 0) std::memcpy(numbers.data(), body.data(), size);
        for (std::uint32_t& bits : numbers) bits = rounded(bits);
        body = to_byte_planes(numbers);
        head[coding_at] = as_planes;
    }
    return head + deflated(body);
}

}  // namespace talus::publish
