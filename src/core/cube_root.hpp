#pragma once

#include <cstdint>
#include <cstring>

namespace talus {

/// Of a finite number above 0, with the same bits wherever IEEE 754 holds: those of a C library's cbrt depend on the
/// library.
[[nodiscard]] inline double cube_root(double number) {
    // A third of the exponent is within 6 %; each of Newton's steps squares that.
    std::uint64_t bits = 0;
    std::memcpy(&bits, &number, sizeof bits);
    bits = bits / 3 + 0x2a9f'7893'782d'a1ceULL;
    double root = 0;
    std::memcpy(&root, &bits, sizeof root);
    for (int k = 0; k < 4; ++k) root -= (root * root * root - number) / (3 * root * root);
    return root;
}

[[nodiscard]] inline float cube_root(float number) {
    return static_cast<float>(cube_root(static_cast<double>(number)));
}

}  // namespace talus
