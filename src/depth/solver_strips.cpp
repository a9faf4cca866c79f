// Strips of cells with debris, for what changes their velocities between steps.
#include <algorithm>

#include "depth/formulas.hpp"
#include "depth/solver.hpp"

namespace talus::depth {

void Solver::find_strips(std::vector<std::uint8_t>& near, std::vector<Strip>& strips) const {
    constexpr std::uint8_t beside = 1, active = 2;
    near.assign(changed_.size(), 0);
    const auto tiles = static_cast<std::size_t>(tile_columns_);
    for (const Segment& segment : segments_) {
        const int east = std::min(tile_columns_, segment.first_tile + segment.tiles + 1);
        for (int row = std::max(0, segment.tile_row - 1); row < std::min(tile_rows_, segment.tile_row + 2); ++row) {
            for (int tile = std::max(0, segment.first_tile - 1); tile < east; ++tile) {
                std::uint8_t& mark = near[static_cast<std::size_t>(row) * tiles + static_cast<std::size_t>(tile)];
                mark = std::max(mark, beside);
            }
        }
    }
    for (const Segment& segment : segments_) {
        std::fill_n(near.begin() + segment.tile_row * tile_columns_ + segment.first_tile, segment.tiles, active);
    }
    strips.clear();
    for (int row = 0; row < tile_rows_ * tile_edge; ++row) {
        const std::uint8_t* const marks = &near[static_cast<std::size_t>(row / tile_edge) * tiles];
        for (int tile = 0; tile < tile_columns_; ++tile) {
            if (marks[tile] == 0) continue;
            const std::size_t at = static_cast<std::size_t>(row) * stride_ + static_cast<std::size_t>(tile) * tile_edge;
            const float* const depth = &depth_[origin_ + at];
            int wet = 0;
            for (int k = 0; k < tile_edge; ++k) wet += depth[k] > dry_depth ? 1 : 0;
            if (wet > 0) strips.push_back({static_cast<std::ptrdiff_t>(at), marks[tile] == active});
        }
    }
}

Solver::Cells Solver::cells() {
    return {static_cast<std::ptrdiff_t>(stride_),
            origin_,
            depth_.size(),
            &depth_[origin_],
            &bed_[origin_],
            &slope_x_[origin_],
            &slope_y_[origin_],
            &u_[origin_],
            &v_[origin_],
            &next_u_[origin_],
            &next_v_[origin_],
            carries_pore_pressure() ? &pore_pressure_[origin_] : nullptr,
            static_cast<float>(pore_pressure_left_)};
}

void Solver::expect_waves(const Strip& strip, const float* faster) {
    const auto at = static_cast<std::size_t>(strip.at);
    const std::size_t tile =
        at / stride_ / tile_edge * static_cast<std::size_t>(tile_columns_) + at % stride_ / tile_edge;
    changed_[tile] = 1;
    for (std::size_t i = origin_ + at; faster != nullptr && i < origin_ + at + tile_edge; ++i) {
        if (faster[i - origin_ - at] == 0) continue;
        raise_line(i, depth_[i], u_[i], v_[i]);
        expect_waves_of(i, tile);
    }
}

}  // namespace talus::depth
