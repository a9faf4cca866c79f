#include "core/byte_planes.hpp"

#include <cassert>
#include <cstring>

namespace talus {
namespace {

/// From the values before `i`; beyond the edge the nearest row or column stands alone.
std::uint32_t predicted(const std::vector<std::uint32_t>& bits, std::size_t i, std::size_t columns) {
    if (i == 0) return 0;
    if (i < columns) return bits[i - 1];
    if (i % columns == 0) return bits[i - columns];
    return bits[i - 1] + bits[i - columns] - bits[i - columns - 1];
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
    std::vector<std::uint32_t> bits(grid.values.size()), folded(bits.size());
    if (!bits.empty()) std::memcpy(bits.data(), grid.values.data(), bits.size() * sizeof(float));
    for (std::size_t i = 0; i < bits.size(); ++i) folded[i] = fold(bits[i] - predicted(bits, i, columns));
    return to_byte_planes(folded);
}

std::vector<float> from_difference_planes(std::string_view bytes, int columns) {
    assert(bytes.size() % 4 == 0 && columns > 0);
    std::vector<std::uint32_t> bits(bytes.size() / 4);
    for (std::size_t i = 0; i < bits.size(); ++i) {
        std::uint32_t folded = 0;
        for (std::size_t plane = 0; plane < 4; ++plane) {
            folded |= std::uint32_t{static_cast<unsigned char>(bytes[plane * bits.size() + i])} << 8U * plane;
        }
        bits[i] = unfold(folded) + predicted(bits, i, static_cast<std::size_t>(columns));
    }
    std::vector<float> values(bits.size());
    if (!bits.empty()) std::memcpy(values.data(), bits.data(), bits.size() * sizeof(float));
    return values;
}

}  // namespace talus
