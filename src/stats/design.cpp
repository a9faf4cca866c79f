#include "stats/design.hpp"

#include <algorithm>
#include <array>
#include <boost/random/sobol.hpp>
#include <cmath>
#include <numeric>
#include <utility>

namespace talus::stats {
namespace {

constexpr std::array<std::pair<DesignKind, std::string_view>, 6> names = {{
    {DesignKind::monte_carlo, "monte_carlo"},
    {DesignKind::latin_hypercube, "latin_hypercube"},
    {DesignKind::sobol, "sobol"},
    {DesignKind::grid, "grid"},
    {DesignKind::saltelli, "saltelli"},
    {DesignKind::morris, "morris"},
}};

std::uint64_t mix(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15ULL;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
}

std::uint64_t draw_bits(std::uint64_t seed, std::uint64_t row, std::uint64_t column) {
    return mix(mix(mix(seed) ^ row) ^ (column + 0x51ed270b27d4eb4fULL));
}

/// 0 to n - 1 in an order drawn with `seed` and `column` (Fisher & Yates, Durstenfeld 1964).
std::vector<std::size_t> shuffled(std::size_t n, std::uint64_t seed, std::uint64_t column) {
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t i = n; i > 1; --i) {
        const auto k = static_cast<std::size_t>(draw(seed, i, column) * static_cast<double>(i));
        std::swap(order[i - 1], order[std::min(k, i - 1)]);
    }
    return order;
}

Points latin_hypercube(std::size_t count, std::size_t factors, std::uint64_t seed) {
    Points points(count, std::vector<double>(factors));
    for (std::size_t k = 0; k < factors; ++k) {
        const std::vector<std::size_t> order = shuffled(count, seed, (1ULL << 32) + k);
        for (std::size_t i = 0; i < count; ++i) {
            points[i][k] = (static_cast<double>(order[i]) + draw(seed, i, k)) / static_cast<double>(count);
        }
    }
    return points;
}

/// Sobol's sequence with the direction numbers of Joe & Kuo (2008). The seed's digital shift keeps the even spread and
/// moves the first point off the corner.
Points sobol_sequence(std::size_t count, std::size_t factors, std::uint64_t seed) {
    Points points(count, std::vector<double>(factors));
    boost::random::sobol_engine<std::uint32_t, 32> sequence(factors);
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t k = 0; k < factors; ++k) {
            const auto shift = static_cast<std::uint32_t>(draw_bits(seed, 0, k) >> 32);
            const std::uint32_t x = i == 0 ? 0 : sequence();  // the library omits the corner
            points[i][k] = (static_cast<double>(x ^ shift) + 0.5) / 4294967296.0;
        }
    }
    return points;
}

}  // namespace

const char* design_name(DesignKind kind) {
    return names.at(static_cast<std::size_t>(kind)).second.data();
}

std::optional<DesignKind> design_of(std::string_view name) {
    for (const auto& [kind, known] : names) {
        if (known == name) return kind;
    }
    return std::nullopt;
}

const std::vector<std::string_view>& design_names() {
    static const std::vector<std::string_view> list = [] {
        std::vector<std::string_view> all;
        all.reserve(names.size());
        for (const auto& entry : names) all.push_back(entry.second);
        return all;
    }();
    return list;
}

double draw(std::uint64_t seed, std::uint64_t row, std::uint64_t column) {
    return (static_cast<double>(draw_bits(seed, row, column) >> 12) + 0.5) / 4503599627370496.0;
}

Points sample_points(DesignKind kind, std::size_t count, std::size_t factors, std::uint64_t seed) {
    if (kind == DesignKind::latin_hypercube) return latin_hypercube(count, factors, seed);
    if (kind == DesignKind::sobol) return sobol_sequence(count, factors, seed);
    Points points(count, std::vector<double>(factors));
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t k = 0; k < factors; ++k) points[i][k] = draw(seed, i, k);
    }
    return points;
}

Points grid_points(const std::vector<std::size_t>& levels) {
    std::size_t count = 1;
    for (const std::size_t n : levels) count *= n;
    Points points(count, std::vector<double>(levels.size()));
    for (std::size_t i = 0; i < count; ++i) {
        std::size_t rest = i;
        for (std::size_t k = levels.size(); k-- > 0;) {
            points[i][k] = (static_cast<double>(rest % levels[k]) + 0.5) / static_cast<double>(levels[k]);
            rest /= levels[k];
        }
    }
    return points;
}

Points saltelli_points(std::size_t rows, std::size_t factors, std::uint64_t seed) {
    const Points both = sobol_sequence(rows, 2 * factors, seed);
    Points points;
    points.reserve(rows * (factors + 2));
    for (const std::vector<double>& row : both) {
        const auto half = row.begin() + static_cast<std::ptrdiff_t>(factors);
        const std::vector<double> a(row.begin(), half), b(half, row.end());
        points.push_back(a);
        points.push_back(b);
        for (std::size_t k = 0; k < factors; ++k) {
            points.push_back(a);
            points.back()[k] = b[k];
        }
    }
    return points;
}

Points morris_points(std::size_t trajectories, std::size_t factors, std::uint64_t seed) {
    constexpr std::size_t step = morris_levels / 2;
    const auto share = [](std::size_t level) { return (static_cast<double>(level) + 0.5) / morris_levels; };
    Points points;
    points.reserve(trajectories * (factors + 1));
    for (std::size_t t = 0; t < trajectories; ++t) {
        std::vector<std::size_t> level(factors);
        for (std::size_t k = 0; k < factors; ++k) {
            level[k] = std::min(morris_levels - 1, static_cast<std::size_t>(draw(seed, t, k) * morris_levels));
        }
        const auto add = [&] {
            points.emplace_back();
            for (const std::size_t l : level) points.back().push_back(share(l));
        };
        add();
        for (const std::size_t k : shuffled(factors, seed, (2ULL << 32) + t)) {
            level[k] =
                level[k] < step ? level[k] + step : level[k] - step;  // the only step that stays among the levels
            add();
        }
    }
    return points;
}

}  // namespace talus::stats
