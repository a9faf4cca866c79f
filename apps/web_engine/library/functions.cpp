#include <algorithm>
#include <cmath>
#include <limits>

/// Functions of the C library that emscripten's rounds otherwise than the one of the program: with these a result has
/// the same bits in a page.

/// Borges (2019), "An improved algorithm for hypot(a,b)", without fused operations: the square root's rounding error is
/// found and taken out. Sizes near the ends of the range, which no length in metres has, take the plain root.
extern "C" double hypot(double a, double b) {
    if (std::isinf(a) || std::isinf(b)) return std::numeric_limits<double>::infinity();
    a = std::abs(a);
    b = std::abs(b);
    const double x = std::max(a, b), y = std::min(a, b);
    if (!(a <= b || b <= a)) return a + b;  // NaN
    if (y <= x * std::numeric_limits<double>::epsilon()) return x + y;
    double h = std::sqrt(x * x + y * y);
    double first = 0, second = 0;
    if (h <= 2 * y) {
        const double delta = h - y;
        first = x * (2 * delta - x);
        second = (delta - 2 * (x - y)) * delta;
    } else {
        const double delta = h - x;
        first = 2 * delta * (x - 2 * y);
        second = (4 * delta - y) * y + delta * delta;
    }
    h -= (first + second) / (2 * h);
    return h;
}
