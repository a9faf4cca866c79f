#include "core/byte_planes.hpp"

#include <bit>
#include <cassert>

namespace talus {
namespace {

/// From the values before `i`; beyond the edge the nearest row or column stands alone.
template <class BitsAt>
std::uint32_t predicted(std::size_t i, std::size_t columns, const BitsAt& bits_at) {
    if (i == 0) return 0;
    if (i < columns) return bits_at(i - 1);
    if (i % columns == 0) return bits_at(i - columns);
    return bits_at(i - 1) + bits_at(i - columns) - bits_at(i - columns - 1);
}

std::uint32_t fold(std::uint32_t difference) {
    return (difference << 1U) ^ (0U - (difference >> 31U));
}

std::uint32_t unfold(std::uint32_t folded) {
    return (folded >> 1U) ^ (0U - (folded & 1U));
}

}  // namespace

std::string to_byte_planes(std::span<const std::uint32_t> numbers) {
    std::string bytes(4 * numbers.size(), '\0');
    for (std::size_t plane = 0; plane < 4; ++plane) {
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            bytes[plane * numbers.size() + i] = static_cast<char>(numbers[i] >> 8U * plane & 0xffU);
        }
    }
    return bytes;
}

std::string to_difference_planes(const Grid<float>& grid) {
    const auto columns = static_cast<std::size_t>(grid.geometry.columns);
    const auto bits_at = [&](std::size_t i) { return std::bit_cast<std::uint32_t>(grid.values[i]); };
    std::vector<std::uint32_t> folded(grid.values.size());
    for (std::size_t i = 0; i < folded.size(); ++i) folded[i] = fold(bits_at(i) - predicted(i, columns, bits_at));
    return to_byte_planes(folded);
}

std::vector<float> from_difference_planes(std::string_view bytes, int columns) {
    assert(bytes.size() % 4 == 0 && columns > 0);
    const std::size_t count = bytes.size() / 4;
    std::vector<float> values(count);
    const auto bits_at = [&](std::size_t i) { return std::bit_cast<std::uint32_t>(values[i]); };
    for (std::size_t i = 0; i < count; ++i) {
        std::uint32_t folded = 0;
        for (std::size_t plane = 0; plane < 4; ++plane) {
            folded |= std::uint32_t{static_cast<unsigned char>(bytes[plane * count + i])} << 8U * plane;
        }
        values[i] = std::bit_cast<float>(unfold(folded) + predicted(i, static_cast<std::size_t>(columns), bits_at));
    }
    return values;
}

}  // namespace talus
