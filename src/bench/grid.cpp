#include "bench/grid.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/measure.hpp"
#include "core/hash.hpp"
#include "core/try.hpp"
#include "depth/solver.hpp"
#include "run/threads.hpp"

namespace talus::bench {
namespace {

constexpr int grid_edge = 512, step_count = 50, warm_up_steps = 20;

depth::Solver make_valley() {
    Grid<double> bed({0, 0, 1, grid_edge, grid_edge});
    Grid<float> debris(bed.geometry);
    for (int row = 0; row < grid_edge; ++row) {
        for (int column = 0; column < grid_edge; ++column) {
            const PlanPoint p = bed.geometry.centre(column, row);
            bed.at(column, row) = 0.02 * std::pow(std::hypot(p.x - grid_edge / 2.0, p.y - grid_edge / 2.0), 1.5) +
                                  0.5 * std::sin(p.x / 9) * std::cos(p.y / 7);
            debris.at(column, row) = std::hypot(p.x - 160, p.y - 190) < 90 ? 5 : 0;
        }
    }
    depth::Material material;
    material.friction_coefficient = 0.1;
    material.laws.turbulent_friction = 500;
    depth::Solver solver(bed, material);
    solver.add(debris);
    return solver;
}

}  // namespace

Result<GridRow> measure_grid(int threads, int repeats, Calibration& calibration) {
    return run::Threads(threads).execute([&]() -> Result<GridRow> {
        depth::Solver solver = make_valley();
        for (int k = 0; k < warm_up_steps; ++k) TALUS_TRY(solver.advance(1));
        std::vector<double> rates, calibration_rates, relative_rates;
        (void)calibration.measure();  // wakes the threads
        double rate_before = calibration.measure();
        const std::uint64_t first = solver.cell_updates();
        for (int repeat = 0; repeat < repeats; ++repeat) {
            const std::uint64_t before = solver.cell_updates();
            const auto start = std::chrono::steady_clock::now();
            for (int k = 0; k < step_count; ++k) TALUS_TRY(solver.advance(1));
            const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            const double rate_after = calibration.measure();
            rates.push_back(static_cast<double>(solver.cell_updates() - before) / seconds);
            calibration_rates.push_back((rate_before + rate_after) / 2);
            relative_rates.push_back(rates.back() / calibration_rates.back());
            rate_before = rate_after;
        }
        GridRow row;
        row.threads = threads;
        row.cells = solver.geometry().size();
        row.cells_per_step = static_cast<double>(solver.cell_updates() - first) / (step_count * repeats);
        row.updates_per_second = median(rates);
        row.calibration_rate = median(calibration_rates);
        row.relative_rate = median(relative_rates);
        row.bytes_per_cell = solver.bytes_per_cell();
        row.hash = solver.hash();
        row.instruction_set = solver.instruction_set();
        return row;
    });
}

std::string grid_table_text(const std::vector<GridRow>& rows) {
    std::string text =
        "depth-averaged model, 512 x 512 cells\nthreads  set    cells/step  Mcells/s  relative  bytes/cell  hash\n";
    for (const GridRow& row : rows) {
        text += fmt::format("{:>7}  {:<5}  {:>10.0f}  {:>8.1f}  {:>8.4f}  {:>10.0f}  {}\n", row.threads,
                            row.instruction_set, row.cells_per_step, row.updates_per_second / 1e6, row.relative_rate,
                            row.bytes_per_cell, to_hex(row.hash));
    }
    return text;
}

std::string grid_rows_json(const std::vector<GridRow>& rows) {
    std::string lines;
    for (const GridRow& row : rows) {
        const nlohmann::ordered_json line = {{"event", "row"},
                                             {"model", "depth_averaged"},
                                             {"threads", row.threads},
                                             {"instruction_set", row.instruction_set},
                                             {"cells", row.cells},
                                             {"cells_per_step", row.cells_per_step},
                                             {"cell_updates_per_second", row.updates_per_second},
                                             {"calibration_units_per_second", row.calibration_rate},
                                             {"relative_rate", row.relative_rate},
                                             {"bytes_per_cell", row.bytes_per_cell},
                                             {"hash", to_hex(row.hash)}};
        lines += line.dump() + "\n";
    }
    return lines;
}

}  // namespace talus::bench
