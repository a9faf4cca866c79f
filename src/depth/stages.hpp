#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "sim/physics/ground_laws.hpp"
#include "sim/physics/pore_pressure.hpp"

namespace talus::depth {

/// What is switched on and off together: tiles of 16 x 16 cells. Neighbouring ones of a row make a segment, which is
/// what a task works on.
inline constexpr int tile_edge = 16, largest_segment = 8;

struct Segment {
    int tile_row = 0, first_tile = 0, tiles = 0;
};

/// Pointers to the south-western cell of padded rasters, row by row.
struct Motion {
    float *depth, *u, *v;
    /// Energy over mass, m2/s2, that debris has been given by its fall and by pressure and does not move with: what the
    /// scheme has taken, or below zero, has added. It goes with the mass.
    float* spare;
    float* pore_pressure = nullptr;  ///< see Solver; null: it is the same everywhere
    /// Where pore pressure evolves, with which it is carried; else null.
    float* solid_fraction = nullptr;
    /// Of flight: vertical height above the ground, m, and vertical velocity less that of the ground below, m/s. Null:
    /// debris does not fly.
    float *height = nullptr, *climb = nullptr;
};
/// Per cell; null: everywhere the same.
struct Cover {
    const float *friction, *inverse_turbulence, *strength, *stem_drag, *viscosity;
};

/// What comes in, per cell; null: nothing anywhere.
struct Inflow {
    const float* depth;                    ///< m/s
    const float *momentum_x, *momentum_y;  ///< m2/s2
    const float *from_x, *from_y;          ///< where its stream stands: -1 west or south, 1 east or north, 0 neither
    const float* grains;                   ///< m/s, solid fraction times depth; null: pore pressure does not evolve
};

/// One stage of Heun's method: `to` = `from` + dt F(`from`); in the second stage `to` is its mean with what it holds.
struct StageData {
    int stride = 0;
    const float* bed = nullptr;
    Motion from{}, to{};
    bool second = false;
    float time_step = 0, inverse_cell = 0, gravity = 0;
    float friction = 0, strength = 0, inverse_turbulence = 0, viscosity = 0;
    sim::GroundLaws laws{};
    float effective_share = 1;      ///< of the normal stress, borne by the grains, where pore pressure is not carried
    float pore_pressure_left = 1;   ///< r_u over what Motion has, in the middle of the step
    float fresh_pore_pressure = 0;  ///< of what comes in
    sim::EvolvingPressure soil{};   ///< a fresh pore pressure of 0 is hydrostatic then
    Cover cover{};
    float highest_line = 0;            ///< m: no debris is faster than by a fall from there
    const float* structure = nullptr;  ///< by cell, 1: a structure stands there; null: none anywhere
    /// By tile, `tile_columns` in a row: whether there is one in the tile or in one beside it. With `structure` only.
    const std::uint8_t* near_structure = nullptr;
    int tile_columns = 0;
    Inflow inflow{};
    float *passes_east = nullptr, *passes_north = nullptr;  ///< m2/s through those faces of a cell; null: not wanted
};

struct Stages {
    /// Writes whether a cell changed to `changed`, one entry per tile of the segment, and the number of cells with
    /// debris near them, which alone are computed. Returns the largest |u| + |v| + 2 sqrt(g h) of `to`, m/s; NaN where
    /// any is.
    float (*advance)(const StageData& data, const Segment& segment, std::uint8_t* changed, int* computed);
    std::string_view instruction_set;
};

/// For the chosen instruction set (simd/dispatch.hpp).
[[nodiscard]] Stages stages_for_processor();

}  // namespace talus::depth
