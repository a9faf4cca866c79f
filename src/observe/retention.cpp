#include "observe/retention.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

namespace talus::observe {
namespace {

constexpr std::size_t none = static_cast<std::size_t>(-1);

std::size_t find(const std::vector<DebrisColumn>& columns, std::int32_t column, std::int32_t row) {
    const std::pair key(row, column);
    const auto place = [](const DebrisColumn& c) { return std::pair(c.row, c.column); };
    const auto at = std::lower_bound(columns.begin(), columns.end(), key,
                                     [&](const DebrisColumn& c, const auto& k) { return place(c) < k; });
    return at != columns.end() && place(*at) == key ? static_cast<std::size_t>(at - columns.begin()) : none;
}

}  // namespace

double retained_volume(const std::vector<DebrisColumn>& columns) {
    std::vector<std::size_t> open;
    std::vector<bool> taken(columns.size(), false);
    double level = -std::numeric_limits<double>::infinity(), volume = 0;
    const auto take = [&](std::size_t k) {
        taken[k] = true;
        volume += columns[k].volume;
        open.push_back(k);
    };
    for (std::size_t k = 0; k < columns.size(); ++k) {
        if (!columns[k].at_face) continue;
        level = std::max(level, columns[k].top);
        take(k);
    }
    while (!open.empty()) {
        const auto [column, row] = std::pair(columns[open.back()].column, columns[open.back()].row);
        open.pop_back();
        for (std::int32_t r = row - 1; r <= row + 1; ++r) {
            for (std::int32_t c = column - 1; c <= column + 1; ++c) {
                const std::size_t k = find(columns, c, r);
                if (k != none && !taken[k] && (columns[k].at_rest || columns[k].bottom < level)) take(k);
            }
        }
    }
    return volume;
}

}  // namespace talus::observe
