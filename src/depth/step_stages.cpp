// A stage of the depth-averaged step. Compiled once per instruction set by Highway's foreach_target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "depth/step_stages.cpp"
#include <hwy/foreach_target.h>
// (must come after foreach_target)
#include <algorithm>
#include <cmath>
#include <hwy/highway.h>

#include "depth/faces-inl.hpp"
#include "depth/live-inl.hpp"
#include "depth/rows-inl.hpp"
#include "depth/stages.hpp"
#include "depth/update-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace talus::depth::HWY_NAMESPACE {
namespace {

/// Compiled apart: with `structures` near or inflows anywhere, and with `more`: flight, what debris carries, viscosity,
/// laws besides Voellmy's, watched faces. A step without them does not pay for them.
template <bool structures, bool more>
[[gnu::flatten]] float advance_as(const StageData& given, const Segment& segment, std::uint8_t* changed,
                                  int* computed) {
    StageData data = given;
    if (!structures) {
        data.structure = nullptr;
        data.inflow = {};
    }
    if (!more) {
        data.from.pore_pressure = data.from.solid_fraction = data.from.height = data.from.climb = nullptr;
        data.cover.viscosity = nullptr;
        data.viscosity = 0;
        data.laws = {};
        data.passes_east = data.passes_north = nullptr;
    }
    Scratch scratch{};
    const int width = segment.tiles * tile_edge;
    const std::ptrdiff_t first =
        static_cast<std::ptrdiff_t>(segment.tile_row) * tile_edge * data.stride + segment.first_tile * tile_edge;
    const auto row_of = [&](int r) HWY_ATTR -> Row& { return scratch.rows[static_cast<std::size_t>(r & 1)]; };
    const bool carries = data.from.pore_pressure != nullptr, flies = data.from.height != nullptr;
    const bool evolves = data.from.solid_fraction != nullptr;
    const bool built = data.structure != nullptr || data.inflow.depth != nullptr;
    const Live live(data, first, segment.tiles);
    *computed = live.count() * tile_edge;
    Fastest fastest;
    // Row r of the segment is r + 1 here, so that the row before it is 0.
    for (int r = 0; r < tile_edge + 2; ++r) {
        const auto faces_east_of = [&]<class L>(int j, int end) HWY_ATTR {
            const Row& row = row_of(r - 1);
            for (; j < end; j += L::size) {
                cross_faces<L>(data.gravity, built, row, j, row, j + 1, true, scratch.x, j);
                if (carries) cross_faces_with_pore_pressure<L>(row, j, row, j + 1, evolves, scratch.x, j);
                if (flies) cross_faces_in_flight<L>(row, j, row, j + 1, scratch.x, j);
            }
        };
        for (int tile = 0; r >= 2 && tile < segment.tiles; ++tile) {
            if (!live.cells(r - 2, tile)) continue;
            const int before = tile * tile_edge;
            if (!live.cells(r - 2, tile - 1)) faces_east_of.template operator()<Edge>(before, before + 1);
            faces_east_of.template operator()<Register>(before + 1, before + tile_edge + 1);
        }
        const auto reconstruct_cells = [&]<class L>(int j, int end) HWY_ATTR {
            reconstruct<L>(data, first + (r - 1) * static_cast<std::ptrdiff_t>(data.stride) - 1, j, end, row_of(r),
                           scratch.speed[static_cast<std::size_t>(r % 3)]);
        };
        for (int tile = 0; tile < segment.tiles; ++tile) {
            if (!live.beside(r - 1, tile)) continue;
            reconstruct_cells.template operator()<Register>(tile * tile_edge + 1, (tile + 1) * tile_edge + 1);
        }
        for (int tile = -1; tile < segment.tiles; ++tile) {  // across the border east of the tile
            const bool west = live.cells(r - 1, tile), east = live.cells(r - 1, tile + 1);
            if (west == east || live.beside(r - 1, west ? tile + 1 : tile)) continue;
            const int j = (tile + 1) * tile_edge + (west ? 1 : 0);
            reconstruct_cells.template operator()<Edge>(j, j + 1);
        }
        if (r == 0) continue;
        Faces& faces = scratch.y[static_cast<std::size_t>(r & 1)];
        for (int tile = 0; tile < segment.tiles; ++tile) {
            if (!live.faces_between(r - 1, tile)) continue;
            using L = Register;
            for (int j = tile * tile_edge + 1; j <= (tile + 1) * tile_edge; j += L::size) {
                cross_faces<L>(data.gravity, built, row_of(r - 1), j, row_of(r), j, false, faces, j);
                if (carries) cross_faces_with_pore_pressure<L>(row_of(r - 1), j, row_of(r), j, evolves, faces, j);
                if (flies) cross_faces_in_flight<L>(row_of(r - 1), j, row_of(r), j, faces, j);
            }
        }
        const std::ptrdiff_t west = first + (r - 2) * static_cast<std::ptrdiff_t>(data.stride) - 1;
        for (int tile = 0; r >= 2 && tile < segment.tiles; ++tile) {
            using L = ForUpdates;
            for (int j = tile * tile_edge + 1; j <= (tile + 1) * tile_edge; j += L::size) {
                live.cells(r - 2, tile) ? update<L>(data, scratch, r - 1, west + j, j, fastest)
                                        : leave_empty<L>(data, west + j);
            }
        }
    }
    for (int j = 1; j <= width; ++j) {
        if (*scratch.change.at(j) > 0) changed[(j - 1) / tile_edge] = 1;
    }
    float result = 0;
    for (int lane = 0; lane < register_lanes; ++lane) {
        const float one = fastest.largest.at(lane) + fastest.unknown.at(lane);
        if (!(one <= result)) result = one;
        if (std::isnan(one)) break;
    }
    return result;
}

bool stands_near(const StageData& data, const Segment& segment) {
    const std::uint8_t* const tiles =
        data.near_structure + static_cast<std::ptrdiff_t>(segment.tile_row) * data.tile_columns + segment.first_tile;
    return std::any_of(tiles, tiles + segment.tiles, [](std::uint8_t near) { return near != 0; });
}

float advance(const StageData& data, const Segment& segment, std::uint8_t* changed, int* computed) {
    const bool structures = data.inflow.depth != nullptr || (data.structure != nullptr && stands_near(data, segment));
    const bool more = data.from.pore_pressure != nullptr || data.from.height != nullptr ||
                      data.cover.viscosity != nullptr || data.viscosity > 0 || data.laws.turbulent_thickness > 0 ||
                      data.laws.samosat.on || data.passes_east != nullptr;
    if (more) return advance_as<true, true>(data, segment, changed, computed);
    return structures ? advance_as<true, false>(data, segment, changed, computed)
                      : advance_as<false, false>(data, segment, changed, computed);
}

Stages make_stages() {
    return {advance, hwy::TargetName(HWY_TARGET)};
}

}  // namespace
}  // namespace talus::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace talus::depth {

HWY_EXPORT(make_stages);

Stages stages_for_processor() {
    return HWY_DYNAMIC_DISPATCH(make_stages)();
}

}  // namespace talus::depth
#endif
