#include "depth/solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "core/hash.hpp"
#include "core/max_or_nan.hpp"
#include "depth/formulas.hpp"

namespace talus::depth {
namespace {

/// Share of the stable time step of a scheme whose waves may cross a cell in it. Mass leaves no cell in more than one.
constexpr double courant_number = 0.6;

}  // namespace

Solver::Solver(const Grid<double>& bed, const Material& material, const GroundValues& ground, Edges edges)
    : geometry_(bed.geometry), material_(material), edges_(edges), stages_(stages_for_processor()) {
    const auto tiles = [](int cells) { return (cells + 2 * margin + tile_edge - 1) / tile_edge; };
    tile_columns_ = tiles(geometry_.columns);
    tile_rows_ = tiles(geometry_.rows);
    stride_ = static_cast<std::size_t>(tile_columns_) * tile_edge;
    // Stages read two cells around a tile, and up to a vector beyond its row.
    constexpr std::size_t guard = 2 * tile_edge;
    origin_ = 2 * stride_ + guard;
    const std::size_t size = (static_cast<std::size_t>(tile_rows_) * tile_edge + 4) * stride_ + 2 * guard;
    for (std::vector<float>* array :
         {&bed_, &slope_x_, &slope_y_, &depth_, &u_, &v_, &next_depth_, &next_u_, &next_v_, &spare_, &next_spare_}) {
        array->assign(size, 0.0F);
    }
    unknown_.assign(size, 1);
    const auto tile_count = static_cast<std::size_t>(tile_columns_) * static_cast<std::size_t>(tile_rows_);
    has_unknown_.assign(tile_count, 0);
    changed_.assign(tile_count, 0);
    segments_.reserve(tile_count);
    fastest_.assign(tile_count, 0);
    lost_.assign(tile_count, 0);
    computed_.assign(tile_count, 0);
    if (material_.soil.on) {
        material_.pore_pressure_decay_time = 0;
        solid_fraction_.assign(size, static_cast<float>(material_.soil.solid_fraction));
        next_solid_fraction_ = solid_fraction_;
    }
    if (material_.soil.on || (material_.pore_pressure_ratio > 0 && material_.pore_pressure_decay_time > 0)) {
        carry_pore_pressure();
    }
    set_cover(ground);
    set_bed(bed);
}

void Solver::add(const Grid<float>& depth, std::optional<double> pore_pressure_ratio,
                 std::optional<double> solid_fraction) {
    const Start start = start_of(pore_pressure_ratio, solid_fraction);
    if (!carries_pore_pressure() && start.pore_pressure_ratio != material_.pore_pressure_ratio) carry_pore_pressure();
    for (int row = 0; row < geometry_.rows; ++row) {
        for (int column = 0; column < geometry_.columns; ++column) {
            if (const float more = depth.at(column, row); more > 0) mix_in(column, row, more, 0, 0, start);
        }
    }
}

void Solver::let_fly() {
    for (std::vector<float>* array : {&height_, &climb_, &next_height_, &next_climb_}) array->assign(depth_.size(), 0);
}

void Solver::inject(int column, int row, double depth, double u, double v, std::optional<double> solid_fraction,
                    std::optional<double> pore_pressure_ratio) {
    mix_in(column, row, depth, u, v, start_of(pore_pressure_ratio, solid_fraction));
}

void Solver::mix_in(int column, int row, double depth, double u, double v, const Start& start) {
    const std::size_t i = index(column, row);
    if (unknown_[i] || !(depth > 0)) return;
    const double all = depth_[i] + depth;
    const auto mixed = [&](float before, double added) {
        return static_cast<float>((static_cast<double>(depth_[i]) * before + depth * added) / all);
    };
    u_[i] = next_u_[i] = mixed(u_[i], u);
    v_[i] = next_v_[i] = mixed(v_[i], v);
    spare_[i] = next_spare_[i] = mixed(spare_[i], 0);
    if (flies()) {
        height_[i] = next_height_[i] = mixed(height_[i], 0);
        climb_[i] = next_climb_[i] = mixed(climb_[i], 0);
    }
    if (carries_pore_pressure()) {
        pore_pressure_[i] = next_pore_pressure_[i] =
            mixed(pore_pressure_[i], start.pore_pressure_ratio / pore_pressure_left_);
    }
    if (pore_pressure_evolves()) {
        solid_fraction_[i] = next_solid_fraction_[i] = mixed(solid_fraction_[i], start.solid_fraction);
    }
    depth_[i] = next_depth_[i] = static_cast<float>(all);
    raise_line(i, all, u, v);
    expect_waves_of(i, tile_of(column, row));
}

void Solver::add_inflow(int column, int row, const CellInflow& comes) {
    if (inflow_.depth.empty()) {
        for (std::vector<float>* array : inflow_.all()) array->assign(depth_.size(), 0);
        if (pore_pressure_evolves()) inflow_.grains.assign(depth_.size(), 0);
    }
    const std::size_t i = index(column, row);
    inflow_.depth[i] += static_cast<float>(comes.rate);
    // It enters at the upper edge of the cell.
    const double edge = (std::abs(slope_x_[i]) + std::abs(slope_y_[i])) * geometry_.cell / 2;
    raise_line(i, edge + depth_[i] + comes.rate * time_step_, comes.u, comes.v);
    inflow_.momentum_x[i] += static_cast<float>(comes.rate * comes.u);
    inflow_.momentum_y[i] += static_cast<float>(comes.rate * comes.v);
    if (pore_pressure_evolves()) {
        inflow_.grains[i] += static_cast<float>(comes.rate * start_of({}, comes.solid_fraction).solid_fraction);
    }
    inflow_.from_x[i] = static_cast<float>(comes.from_x);
    inflow_.from_y[i] = static_cast<float>(comes.from_y);
    changed_[tile_of(column, row)] = 1;
}

void Solver::end_inflow(int column, int row) {
    if (inflow_.depth.empty()) return;
    for (std::vector<float>* array : inflow_.all()) (*array)[index(column, row)] = 0;
    if (!inflow_.grains.empty()) inflow_.grains[index(column, row)] = 0;
    changed_[tile_of(column, row)] = 1;
}

void Solver::set_velocity(int column, int row, double u, double v) {
    const std::size_t i = index(column, row);
    if (!(depth_[i] > dry_depth)) return;
    u_[i] = next_u_[i] = static_cast<float>(u);
    v_[i] = next_v_[i] = static_cast<float>(v);
    raise_line(i, depth_[i], u, v);
    expect_waves_of(i, tile_of(column, row));
}

void Solver::expect_waves_of(std::size_t cell, std::size_t tile) {
    changed_[tile] = 1;
    const double wave = 2 * std::sqrt(material_.gravity * static_cast<double>(depth_[cell]));
    signal_ = std::max(signal_, static_cast<double>(std::abs(u_[cell]) + std::abs(v_[cell])) + wave);
}

/// Pressure gives the front of a dam break twice the head of its depth (Ritter 1892).
void Solver::raise_line(std::size_t cell, double depth, double u, double v) {
    const double w = u * slope_x_[cell] + v * slope_y_[cell];
    const double head = (u * u + v * v + w * w) / (2 * material_.gravity);
    highest_line_ = std::max(highest_line_, bed_[cell] + 2 * depth + head);
}

void Solver::find_active_tiles() {
    // What changes in a step reaches at most four cells further in the next.
    const auto active = [&](int column, int row) {
        for (int r = std::max(0, row - 1); r <= std::min(tile_rows_ - 1, row + 1); ++r) {
            for (int c = std::max(0, column - 1); c <= std::min(tile_columns_ - 1, column + 1); ++c) {
                if (changed_[static_cast<std::size_t>(r) * tile_columns_ + c]) return true;
            }
        }
        return false;
    };
    segments_.clear();
    for (int row = 0; row < tile_rows_; ++row) {
        bool open = false;
        for (int column = 0; column < tile_columns_; ++column) {
            const bool on = active(column, row);
            if (on && open && segments_.back().tiles < largest_segment) {
                ++segments_.back().tiles;
            } else if (on) {
                segments_.push_back({row, column, 1});
            }
            open = on;
        }
    }
    std::fill(changed_.begin(), changed_.end(), std::uint8_t{0});
}

double Solver::take_outflow(const Segment& segment, const Motion& motion) {
    double sum = 0;
    for (int tile = segment.first_tile; tile < segment.first_tile + segment.tiles; ++tile) {
        if (!has_unknown_[static_cast<std::size_t>(segment.tile_row) * tile_columns_ + tile]) continue;
        for (int row = 0; row < tile_edge; ++row) {
            const int of_grid = segment.tile_row * tile_edge + row - margin;
            const bool counts = edges_ == Edges::open || (of_grid >= 0 && of_grid < geometry_.rows);
            for (int column = 0; column < tile_edge; ++column) {
                const std::size_t i = static_cast<std::size_t>(segment.tile_row * tile_edge + row) * stride_ +
                                      static_cast<std::size_t>(tile * tile_edge + column);
                if (!unknown_[origin_ + i]) continue;
                if (counts) sum += motion.depth[i];
                motion.depth[i] = motion.u[i] = motion.v[i] = motion.spare[i] = 0;
                if (flies()) motion.height[i] = motion.climb[i] = 0;
            }
        }
    }
    return sum;
}

Motion Solver::motion() {
    return {&depth_[origin_],
            &u_[origin_],
            &v_[origin_],
            &spare_[origin_],
            carries_pore_pressure() ? &pore_pressure_[origin_] : nullptr,
            pore_pressure_evolves() ? &solid_fraction_[origin_] : nullptr,
            flies() ? &height_[origin_] : nullptr,
            flies() ? &climb_[origin_] : nullptr};
}

Motion Solver::next_motion() {
    return {&next_depth_[origin_],
            &next_u_[origin_],
            &next_v_[origin_],
            &next_spare_[origin_],
            carries_pore_pressure() ? &next_pore_pressure_[origin_] : nullptr,
            pore_pressure_evolves() ? &next_solid_fraction_[origin_] : nullptr,
            flies() ? &next_height_[origin_] : nullptr,
            flies() ? &next_climb_[origin_] : nullptr};
}

double Solver::advance_stage(bool second) {
    const auto pointer = [&](std::vector<float>& array) { return array.empty() ? nullptr : array.data() + origin_; };
    StageData data;
    data.stride = static_cast<int>(stride_);
    data.bed = pointer(bed_);
    data.from = motion();
    data.to = next_motion();
    if (second) std::swap(data.from, data.to);
    data.second = second;
    data.time_step = static_cast<float>(time_step_);
    data.inverse_cell = static_cast<float>(1 / geometry_.cell);
    data.gravity = static_cast<float>(material_.gravity);
    data.friction = static_cast<float>(material_.friction_coefficient);
    data.strength = static_cast<float>(material_.cohesion / material_.rest_density);
    const double xi = material_.laws.turbulent_friction;
    data.inverse_turbulence = xi > 0 ? static_cast<float>(1 / xi) : 0;
    data.viscosity = static_cast<float>(material_.laws.laminar_viscosity);
    data.laws = material_.laws;
    data.effective_share = static_cast<float>(1 - material_.pore_pressure_ratio);
    const double decay = material_.pore_pressure_decay_time;
    const double halfway = pore_pressure_left_ * (decay > 0 ? std::exp(-time_step_ / (2 * decay)) : 1);
    data.pore_pressure_left = static_cast<float>(halfway);
    data.fresh_pore_pressure = static_cast<float>(material_.pore_pressure_ratio / std::max(halfway, 1e-30));
    data.soil = material_.soil;
    data.cover = {pointer(friction_), pointer(inverse_turbulence_), pointer(strength_), pointer(stem_drag_),
                  pointer(viscosity_)};
    data.highest_line = static_cast<float>(highest_line_);
    data.structure = pointer(structure_);
    data.near_structure = near_structure_.data();
    data.tile_columns = tile_columns_;
    data.inflow = {pointer(inflow_.depth),  pointer(inflow_.momentum_x), pointer(inflow_.momentum_y),
                   pointer(inflow_.from_x), pointer(inflow_.from_y),     pointer(inflow_.grains)};
    data.passes_east = pointer(passes_east_);
    data.passes_north = pointer(passes_north_);

    simd::parallel_ranges(segments_.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t s = first; s < last; ++s) {
            const Segment& segment = segments_[s];
            std::uint8_t* changed =
                &changed_[static_cast<std::size_t>(segment.tile_row) * tile_columns_ + segment.first_tile];
            fastest_[s] = stages_.advance(data, segment, changed, &computed_[s]);
            lost_[s] = take_outflow(segment, data.to);
        }
    });
    if (edges_ == Edges::continued) continue_rows(data.to);
    count_passing(second);
    double lost = 0;
    for (std::size_t s = 0; s < segments_.size(); ++s) lost += lost_[s];
    return lost * geometry_.cell * geometry_.cell;
}

double Solver::stable_step(double wave) const {
    return courant_number * geometry_.cell / wave;
}

double Solver::next_step(double longest) const {
    return signal_ > 0 ? std::min(longest, stable_step(signal_)) : longest;
}

Status Solver::advance(double longest) {
    find_active_tiles();
    if (edges_ == Edges::continued) {  // what was added since, too
        continue_rows(motion());
        continue_rows(next_motion());
    }
    time_step_ = next_step(longest);
    std::fill(passed_.begin(), passed_.end(), 0);
    if (!segments_.empty()) {
        // Heun's method takes the mean of what leaves in either stage.
        left_ += advance_stage(false) / 2;
        left_ += advance_stage(true);
    }
    float fastest = 0;
    for (std::size_t s = 0; s < segments_.size(); ++s) fastest = max_or_nan(fastest, fastest_[s]);
    signal_ = fastest;
    time_ += time_step_;
    drain();
    ++steps_;
    for (std::size_t s = 0; s < segments_.size(); ++s) cell_updates_ += static_cast<std::uint64_t>(computed_[s]);
    if (!std::isfinite(fastest)) {
        return Error{
            fmt::format("a speed of the depth-averaged model is not a number at t = {:.4g} s; check the "
                        "terrain for single cells that stand out, or choose another solver.grid_cell_m",
                        time_)};
    }
    return {};
}

double Solver::volume() const {
    double sum = 0;
    for (int row = 0; row < geometry_.rows; ++row) {
        for (int column = 0; column < geometry_.columns; ++column) sum += depth_at(column, row);
    }
    return sum * geometry_.cell * geometry_.cell;
}

double Solver::bytes_per_cell() const {
    std::size_t bytes = unknown_.size() + (passes_east_.size() + passes_north_.size()) * sizeof(float);
    for (const std::vector<float>* array : {&bed_,
                                            &slope_x_,
                                            &slope_y_,
                                            &depth_,
                                            &u_,
                                            &v_,
                                            &next_depth_,
                                            &next_u_,
                                            &next_v_,
                                            &spare_,
                                            &next_spare_,
                                            &friction_,
                                            &inverse_turbulence_,
                                            &strength_,
                                            &stem_drag_,
                                            &viscosity_,
                                            &structure_,
                                            &pore_pressure_,
                                            &next_pore_pressure_,
                                            &solid_fraction_,
                                            &next_solid_fraction_,
                                            &height_,
                                            &climb_,
                                            &next_height_,
                                            &next_climb_,
                                            &inflow_.depth,
                                            &inflow_.momentum_x,
                                            &inflow_.momentum_y,
                                            &inflow_.from_x,
                                            &inflow_.from_y,
                                            &inflow_.grains}) {
        bytes += array->size() * sizeof(float);
    }
    return static_cast<double>(bytes) / static_cast<double>(geometry_.size());
}

CellRow Solver::active_row(const Segment& segment, int row_of_tile) const {
    const int row = segment.tile_row * tile_edge + row_of_tile - margin;
    const int west = segment.first_tile * tile_edge - margin;
    const int first = std::max(0, west), last = std::min(geometry_.columns, west + segment.tiles * tile_edge);
    if (row < 0 || row >= geometry_.rows || first >= last) return {};
    return cell_row(row, first, last);
}

CellRow Solver::cell_row(int row, int first, int last) const {
    CellRow result{row, first, last};
    const std::size_t i = index(first, row);
    result.depth = &depth_[i];
    result.u = &u_[i];
    result.v = &v_[i];
    result.slope_x = &slope_x_[i];
    result.slope_y = &slope_y_[i];
    if (flies()) result.climb = &climb_[i];
    return result;
}

std::uint64_t Solver::hash() const {
    StateHash hash;
    hash.add(&time_, sizeof time_);
    hash.add(std::span<const float>(depth_));
    hash.add(std::span<const float>(u_));
    hash.add(std::span<const float>(v_));
    hash.add(std::span<const float>(spare_));
    hash.add(std::span<const float>(pore_pressure_));
    hash.add(std::span<const float>(solid_fraction_));
    hash.add(std::span<const float>(height_));
    hash.add(std::span<const float>(climb_));
    return hash.value();
}

}  // namespace talus::depth
