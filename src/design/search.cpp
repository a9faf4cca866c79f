#include "design/search.hpp"

#include <cmath>

#include <fmt/format.h>

#include "core/try.hpp"

namespace talus::design {

Result<std::vector<double>> height_grid(double low, double high, double step) {
    constexpr double most = 1000;
    if (!std::isfinite(low) || !(low > 0)) {
        return Error{fmt::format("--min-height {:g} is refused; it must be above 0", low)};
    }
    if (!std::isfinite(high) || high < low) {
        return Error{fmt::format("--max-height {:g} is refused; it must be at least --min-height {:g}", high, low)};
    }
    if (!std::isfinite(step) || !(step > 0) || (high - low) / step > most) {
        return Error{
            fmt::format("--height-step {:g} is refused; it must be above 0 and give at most {:g} heights", step, most)};
    }
    std::vector<double> heights;
    for (std::size_t k = 0; low + static_cast<double>(k) * step <= high + 1e-6 * step; ++k) {
        heights.push_back(std::round((low + static_cast<double>(k) * step) * 1e6) / 1e6);
    }
    return heights;
}

Result<std::optional<std::size_t>> least_index(std::size_t count,
                                               const std::function<Result<bool>(std::size_t)>& good) {
    TALUS_ASSIGN(const bool last, good(count - 1));
    if (!last) return std::optional<std::size_t>();
    std::size_t above = count - 1;  // good
    if (count > 1) {
        TALUS_ASSIGN(const bool first, good(0));
        if (first) return std::optional<std::size_t>(0);
        std::size_t below = 0;  // bad
        while (above - below > 1) {
            const std::size_t middle = below + (above - below) / 2;
            TALUS_ASSIGN(const bool enough, good(middle));
            (enough ? above : below) = middle;
        }
    }
    return std::optional(above);
}

std::size_t most_trials(std::size_t count) {
    if (count < 3) return count;
    return 2 + static_cast<std::size_t>(std::ceil(std::log2(static_cast<double>(count - 1))));
}

}  // namespace talus::design
