// Which cells of a segment a stage of the depth-averaged step computes. Included once per instruction set.
#if defined(TALUS_DEPTH_LIVE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TALUS_DEPTH_LIVE_INL
#undef TALUS_DEPTH_LIVE_INL
#else
#define TALUS_DEPTH_LIVE_INL
#endif

#include <array>
#include <cstddef>
#include <cstdint>
#include <hwy/highway.h>

#include "depth/rows-inl.hpp"
#include "depth/stages.hpp"

HWY_BEFORE_NAMESPACE();
namespace talus::depth::HWY_NAMESPACE {

/// The strips of a segment, a tile's width of a row each, that a stage computes: those with debris, or with what comes
/// in, within two cells, which is as far as a stage looks. All others are empty and stay so. By strips and not by
/// vectors, so that every instruction set computes the same cells.
class Live {
  public:
    HWY_INLINE Live(const StageData& data, std::ptrdiff_t first, int tiles) : tiles_(tiles) {
        // Cells without debris keep their pore pressure and their state of flight, so all are computed.
        if (data.from.pore_pressure != nullptr || data.from.height != nullptr) {
            for (int row = 0; row < tile_edge; ++row) {
                for (int tile = 0; tile < tiles; ++tile) of(row, tile) = true;
            }
            return;
        }
        std::array<std::array<std::uint8_t, largest_segment + 2>, tile_edge + 2 * reach> wet{};
        for (int row = 0; row < tile_edge + 2 * reach; ++row) {
            const std::ptrdiff_t i = first + (row - reach) * static_cast<std::ptrdiff_t>(data.stride);
            auto& strips = wet[static_cast<std::size_t>(row)];
            strips[0] = holds(data, i - reach, reach) ? end_east : 0;
            for (int tile = 0; tile < tiles; ++tile) {
                const std::ptrdiff_t west = i + tile * tile_edge;
                if (!holds(data, west, tile_edge)) continue;
                strips[static_cast<std::size_t>(tile) + 1] =
                    static_cast<std::uint8_t>(anywhere | (holds(data, west, reach) ? end_west : 0) |
                                              (holds(data, west + tile_edge - reach, reach) ? end_east : 0));
            }
            strips[static_cast<std::size_t>(tiles) + 1] = holds(data, i + tiles * tile_edge, reach) ? end_west : 0;
        }
        for (int row = 0; row < tile_edge; ++row) {
            for (int tile = 0; tile < tiles; ++tile) {
                const auto t = static_cast<std::size_t>(tile);
                unsigned near = 0;
                for (int r = row; r <= row + 2 * reach; ++r) {
                    const auto& strips = wet[static_cast<std::size_t>(r)];
                    near |= (strips[t] & end_east) | (strips[t + 1] & anywhere) | (strips[t + 2] & end_west);
                }
                // Of `to` the strip's own cells alone: those around are being written by others.
                const std::ptrdiff_t own = first + row * static_cast<std::ptrdiff_t>(data.stride) + tile * tile_edge;
                of(row, tile) = near != 0 || (data.second && any_of(data.to.depth + own, tile_edge));
            }
        }
    }
    /// Whether the cells of a strip are computed.
    [[nodiscard]] HWY_INLINE bool cells(int row, int tile) const {
        return row >= 0 && row < tile_edge && tile >= 0 && tile < tiles_ && of(row, tile);
    }
    /// Whether the faces between the strips of two rows are needed.
    [[nodiscard]] HWY_INLINE bool faces_between(int row, int tile) const {
        return cells(row - 1, tile) || cells(row, tile);
    }
    /// Whether cells of a strip, or those of the next row on either side, are computed.
    [[nodiscard]] HWY_INLINE bool beside(int row, int tile) const {
        return cells(row - 1, tile) || cells(row, tile) || cells(row + 1, tile);
    }
    [[nodiscard]] int count() const {
        int count = 0;
        for (int row = 0; row < tile_edge; ++row) {
            for (int tile = 0; tile < tiles_; ++tile) count += of(row, tile) ? 1 : 0;
        }
        return count;
    }

  private:
    static constexpr int reach = 2;
    /// Where a strip has debris. Its two cells at either end are within reach of the next strip.
    static constexpr std::uint8_t anywhere = 1, end_west = 2, end_east = 4;

    /// Not a number counts as debris: it must be found.
    static HWY_INLINE bool any_of(const float* depth, int cells) {
        bool found = false;
        if (cells % register_lanes == 0) {
            const Register zero(0);
            for (int k = 0; k < cells; k += register_lanes) found |= any(!(Register::load(depth + k) <= zero));
        } else {
            for (int k = 0; k < cells; ++k) found |= !(depth[k] <= 0);
        }
        return found;
    }
    static HWY_INLINE bool holds(const StageData& data, std::ptrdiff_t i, int cells) {
        return any_of(data.from.depth + i, cells) ||
               (data.inflow.depth != nullptr && any_of(data.inflow.depth + i, cells));
    }
    [[nodiscard]] HWY_INLINE bool& of(int row, int tile) {
        return live_[static_cast<std::size_t>(row)][static_cast<std::size_t>(tile)];
    }
    [[nodiscard]] HWY_INLINE bool of(int row, int tile) const {
        return live_[static_cast<std::size_t>(row)][static_cast<std::size_t>(tile)];
    }

    int tiles_;
    std::array<std::array<bool, largest_segment>, tile_edge> live_{};
};

}  // namespace talus::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
