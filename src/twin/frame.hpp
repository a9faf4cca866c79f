#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/grid.hpp"
#include "observe/map_accumulator.hpp"
#include "sim/state.hpp"

namespace talus::twin {

/// Bits of a frame's `flags`.
inline constexpr unsigned frame_running = 1, frame_too_compressed = 2, frame_recorded = 4;

/// The debris at one moment, in whole numbers: a frame of docs/protocol.md, before compression.
struct Frame {
    double time = 0;  ///< s
    std::uint64_t step = 0;
    unsigned flags = 0;
    std::uint32_t slots = 0, stride = 1;
    std::array<float, 3> zero{}, unit{};      ///< local m
    float speed_unit = 0;                     ///< m/s
    std::array<std::uint32_t, 4> window{};    ///< first column, first row, columns, rows
    float depth_unit = 0;                     ///< m
    float depth_speed_unit = 0;               ///< m/s
    double rest_density = 0;                  ///< kg/m3, at that time; not sent
    std::vector<float> densities;             ///< kg/m3, by cell of the window; empty: rest_density. Not sent
    std::vector<std::uint8_t> body;           ///< byte planes
    std::vector<std::uint8_t> pore_pressure;  ///< pore_pressure_map() of the window; empty: there is none. Not sent

    [[nodiscard]] std::size_t bytes() const {
        return sizeof(Frame) + body.size() + pore_pressure.size() + densities.size() * sizeof(float);
    }
    [[nodiscard]] double pore_pressure_ratio_in(std::size_t cell) const;
    [[nodiscard]] double density_in(std::size_t cell) const {
        return cell < densities.size() ? static_cast<double>(densities[cell]) : rest_density;
    }
};

/// Frames do not change once created: other threads may read them during the run.
using FramePtr = std::shared_ptr<const Frame>;

/// `slots`: more than any id. Every `stride`-th id is in the frame.
[[nodiscard]] Frame make_frame(const sim::State& state, const observe::MapAccumulator::Present& debris,
                               std::uint32_t slots, unsigned stride, unsigned flags);

/// The frame as sent to clients.
[[nodiscard]] std::string encode(const Frame& frame, int scenario_index, unsigned further_flags = 0);

/// Depth, m, depth-averaged speed, m/s, density, kg/m3, and ratio of pore pressure in a cell of the map grid; 0 outside
/// the window. NaN: no pore pressure is known there.
struct DebrisAt {
    double depth = 0, speed = 0, density = 0;
    double pore_pressure_ratio = std::numeric_limits<double>::quiet_NaN();
};
[[nodiscard]] DebrisAt debris_at(const Frame& frame, std::uint32_t column, std::uint32_t row);

/// The same for all cells of the window, by rows.
[[nodiscard]] std::vector<DebrisAt> debris_in_window(const Frame& frame);

/// How a grid message holds its values: as they are, or as differences (core/byte_planes.hpp), which takes half the
/// bytes where a raster is smooth as terrain is.
enum class GridCoding : std::uint8_t { values, differences };

/// Encodes a grid message.
[[nodiscard]] std::string encode_grid(const Grid<float>& grid, GridCoding coding = GridCoding::values);

}  // namespace talus::twin
