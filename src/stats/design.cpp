#include "stats/design.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace talus {
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

/// A dimension of Joe & Kuo's (2008) table new-joe-kuo-6: degree and inner coefficients of the primitive polynomial and
/// the first direction numbers. The first dimension, van der Corput's sequence, has none.
struct SobolDimension {
    unsigned degree, coefficients;
    std::array<std::uint32_t, 7> first;
};
constexpr std::array<SobolDimension, sobol_dimensions - 1> sobol_table = {{
    {1, 0, {1}},
    {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},
    {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}},
    {4, 4, {1, 3, 5, 13}},
    {5, 2, {1, 1, 5, 5, 17}},
    {5, 4, {1, 1, 5, 5, 5}},
    {5, 7, {1, 1, 7, 11, 19}},
    {5, 11, {1, 1, 5, 1, 1}},
    {5, 13, {1, 1, 1, 3, 11}},
    {5, 14, {1, 3, 5, 5, 31}},
    {6, 1, {1, 3, 3, 9, 7, 49}},
    {6, 13, {1, 1, 1, 15, 21, 21}},
    {6, 16, {1, 3, 1, 13, 27, 49}},
    {6, 19, {1, 1, 1, 15, 7, 5}},
    {6, 22, {1, 3, 1, 15, 13, 25}},
    {6, 25, {1, 1, 5, 5, 19, 61}},
    {7, 1, {1, 3, 7, 11, 23, 15, 103}},
    {7, 4, {1, 3, 7, 13, 13, 15, 69}},
}};

using Directions = std::array<std::uint32_t, 32>;

Directions directions_of(std::size_t dimension) {
    Directions v{};
    if (dimension == 0) {
        for (unsigned i = 0; i < 32; ++i) v.at(i) = 1U << (31 - i);
        return v;
    }
    const SobolDimension& d = sobol_table.at(dimension - 1);
    for (unsigned i = 0; i < d.degree; ++i) v.at(i) = d.first.at(i) << (31 - i);
    for (unsigned i = d.degree; i < 32; ++i) {
        v.at(i) = v.at(i - d.degree) ^ (v.at(i - d.degree) >> d.degree);
        for (unsigned k = 1; k < d.degree; ++k) {
            if ((d.coefficients >> (d.degree - 1 - k) & 1U) != 0) v.at(i) ^= v.at(i - k);
        }
    }
    return v;
}

/// In Gray code order (Antonov & Saleev 1979). The seed's digital shift keeps the even spread and moves the first point
/// off the corner.
Points sobol_sequence(std::size_t count, std::size_t factors, std::uint64_t seed) {
    Points points(count, std::vector<double>(factors));
    for (std::size_t k = 0; k < factors; ++k) {
        const Directions v = directions_of(k);
        const auto shift = static_cast<std::uint32_t>(draw_bits(seed, 0, k) >> 32);
        std::uint32_t x = 0;
        for (std::size_t i = 0; i < count; ++i) {
            points[i][k] = (static_cast<double>(x ^ shift) + 0.5) / 4294967296.0;
            std::size_t bit = 0;
            while ((i >> bit & 1U) != 0) ++bit;
            x ^= v.at(bit);
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

}  // namespace talus
