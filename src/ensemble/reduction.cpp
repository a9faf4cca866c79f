#include "ensemble/reduction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <system_error>

#include <fmt/format.h>

#include "core/try.hpp"

namespace talus::ensemble {

namespace fs = std::filesystem;

namespace {

constexpr float not_there = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t depth_map = 0, speed_map = 1, pressure_map = 2, arrival_map = 3;

std::size_t rank_of(std::size_t count, double percent) {
    const auto n = static_cast<double>(count);
    return static_cast<std::size_t>(std::clamp(std::ceil(percent / 100 * n - 1e-9), 1.0, n)) - 1;
}

/// The common grid of the maps of all runs, and their files.
struct Stack {
    GridGeometry geometry;
    std::vector<std::pair<fs::path, const RunRecord*>> layers;
};

/// Offset of a run's map from that of the stack, in cells.
int offset_of(double edge, double stack_edge, double cell) {
    return static_cast<int>(std::lround((edge - stack_edge) / cell));
}

Status check_grid(const GridGeometry& a, const GridGeometry& b, std::size_t run) {
    const double dx = (b.x_min - a.x_min) / a.cell, dy = (b.y_min - a.y_min) / a.cell;
    const bool aligned = std::abs(dx - std::round(dx)) < 1e-3 && std::abs(dy - std::round(dy)) < 1e-3;
    if (std::abs(a.cell - b.cell) < 1e-9 * a.cell && aligned) return {};
    return Error{fmt::format("run {}: its maps have other cells than those of the runs before", run)};
}

Result<Stack> stack_of(const std::vector<RunRecord>& runs, const std::vector<fs::path>& files) {
    Stack stack;
    double x_max = 0, y_max = 0;
    for (std::size_t i = 0; i < runs.size(); ++i) {
        const GridGeometry& g = runs[i].geometry;
        if (!runs[i].complete() || g.size() == 0) continue;
        const Extent e = g.extent();
        if (stack.layers.empty()) {
            stack.geometry = g;
            x_max = e.x_max;
            y_max = e.y_max;
        }
        TALUS_TRY(check_grid(stack.geometry, g, runs[i].run));
        stack.geometry.x_min = std::min(stack.geometry.x_min, g.x_min);
        stack.geometry.y_min = std::min(stack.geometry.y_min, g.y_min);
        x_max = std::max(x_max, e.x_max);
        y_max = std::max(y_max, e.y_max);
        stack.layers.emplace_back(files[i], &runs[i]);
    }
    if (stack.layers.empty()) return stack;
    stack.geometry.columns = offset_of(x_max, stack.geometry.x_min, stack.geometry.cell);
    stack.geometry.rows = offset_of(y_max, stack.geometry.y_min, stack.geometry.cell);
    return stack;
}

/// Fills the maps that are made from one recorded map.
class MapReducer {
  public:
    MapReducer(const Stack& stack, std::size_t map, std::size_t runs, std::vector<EnsembleMap*> made)
        : stack_(stack), map_(map), runs_(runs), made_(std::move(made)) {}

    Status reduce(std::size_t memory) {
        const auto columns = static_cast<std::size_t>(stack_.geometry.columns);
        const std::size_t row_bytes = columns * stack_.layers.size() * sizeof(float);
        const int band = static_cast<int>(std::clamp<std::size_t>(memory / std::max<std::size_t>(1, row_bytes), 1,
                                                                  static_cast<std::size_t>(stack_.geometry.rows)));
        for (int first = 0; first < stack_.geometry.rows; first += band) {
            TALUS_TRY(reduce_rows(first, std::min(stack_.geometry.rows, first + band)));
        }
        return {};
    }

  private:
    /// The values of every run, cell by cell; a run that did not reach the cell has none.
    Status reduce_rows(int first, int last) {
        const auto columns = static_cast<std::size_t>(stack_.geometry.columns);
        const std::size_t cells = columns * static_cast<std::size_t>(last - first);
        values_.assign(cells * stack_.layers.size(), not_there);
        counts_.assign(cells, 0);
        for (const auto& [file, record] : stack_.layers) {
            const GridGeometry& g = record->geometry;
            const int right = offset_of(g.x_min, stack_.geometry.x_min, g.cell);
            const int up = offset_of(g.y_min, stack_.geometry.y_min, g.cell);
            const int from = std::max(0, first - up), to = std::min(g.rows, last - up);
            if (from >= to) continue;
            TALUS_ASSIGN(const auto rows, read_map_rows(file, *record, map_, from, to));
            for (int r = from; r < to; ++r) {
                const std::size_t source = static_cast<std::size_t>(r - from) * static_cast<std::size_t>(g.columns);
                const std::size_t target =
                    static_cast<std::size_t>(r + up - first) * columns + static_cast<std::size_t>(right);
                for (std::size_t c = 0; c < static_cast<std::size_t>(g.columns); ++c) {
                    const float v = rows[source + c];
                    if (std::isnan(v)) continue;
                    values_[(target + c) * stack_.layers.size() + counts_[target + c]++] = v;
                }
            }
        }
        for (std::size_t cell = 0; cell < cells; ++cell)
            reduce_cell(cell, static_cast<std::size_t>(first) * columns + cell);
        return {};
    }

    void reduce_cell(std::size_t cell, std::size_t target) {
        const std::size_t reached = counts_[cell];
        if (reached == 0) return;
        const auto begin = values_.begin() + static_cast<std::ptrdiff_t>(cell * stack_.layers.size());
        const auto end = begin + static_cast<std::ptrdiff_t>(reached);
        std::sort(begin, end);
        const std::size_t absent = runs_ - reached;
        for (EnsembleMap* made : made_) {
            float& out = made->grid.values[target];
            if (made->kind == EnsembleMap::Kind::probability) {
                // Thresholds of pressure are in kPa, those of the other maps in SI.
                const auto limit = static_cast<float>(made->level * (map_ == pressure_map ? 1e3 : 1));
                out = static_cast<float>(static_cast<double>(end - std::upper_bound(begin, end, limit)) /
                                         static_cast<double>(runs_));
                continue;
            }
            // Runs that did not reach the cell rank before all others, for arrival times after them.
            const std::size_t rank = rank_of(runs_, made->level);
            const std::size_t skipped = map_ == arrival_map ? 0 : absent;
            if (rank >= skipped && rank - skipped < reached)
                out = *(begin + static_cast<std::ptrdiff_t>(rank - skipped));
        }
    }

    const Stack& stack_;
    std::size_t map_, runs_;
    std::vector<EnsembleMap*> made_;
    std::vector<float> values_;
    std::vector<std::size_t> counts_;
};

std::vector<EnsembleMap> wanted_maps(const Thresholds& thresholds) {
    std::vector<EnsembleMap> maps;
    const std::vector<double>* lists[] = {&thresholds.depth, &thresholds.speed, &thresholds.pressure};
    for (std::size_t map = 0; map < 3; ++map) {
        for (const double level : *lists[map]) maps.push_back({EnsembleMap::Kind::probability, map, level, {}});
    }
    for (std::size_t map = 0; map < recorded_maps.size(); ++map) {
        for (const double level : mapped_percentiles) maps.push_back({EnsembleMap::Kind::percentile, map, level, {}});
    }
    return maps;
}

/// Per class the share of runs in which a place has that intensity or a higher one.
Result<std::vector<Grid<float>>> intensity_shares(const Stack& stack, const report::IntensityGuideline& guideline,
                                                  std::size_t runs) {
    std::vector<Grid<float>> shares(guideline.classes.size(), Grid<float>(stack.geometry, 0));
    for (const auto& [file, record] : stack.layers) {
        const GridGeometry& g = record->geometry;
        HazardMaps maps;
        for (const std::size_t map : {depth_map, speed_map, arrival_map}) {
            Grid<float>& grid = maps.*recorded_maps[map].grid;
            grid.geometry = g;
            TALUS_ASSIGN(grid.values, read_map_rows(file, *record, map, 0, g.rows));
        }
        const Grid<float> classes = intensity_map(guideline, maps);
        const int right = offset_of(g.x_min, stack.geometry.x_min, g.cell);
        const int up = offset_of(g.y_min, stack.geometry.y_min, g.cell);
        for (int r = 0; r < g.rows; ++r) {
            for (int c = 0; c < g.columns; ++c) {
                for (std::size_t k = 0; static_cast<float>(k + 1) <= classes.at(c, r); ++k) {
                    shares[k].at(c + right, r + up) += 1;
                }
            }
        }
    }
    for (std::size_t k = shares.size(); k-- > 0;) {  // the first class is of all, so it comes last
        for (std::size_t i = 0; i < shares[k].values.size(); ++i) {
            float& share = shares[k].values[i];
            share = shares[0].values[i] > 0 ? share / static_cast<float>(runs) : not_there;
        }
    }
    return shares;
}

/// One number of every complete run's building, `absent` where it was not hit.
std::vector<double> values_of(const std::vector<RunRecord>& runs, std::size_t building,
                              double observe::BuildingImpact::*member, double absent) {
    std::vector<double> values;
    for (const RunRecord& run : runs) {
        if (!run.complete() || building >= run.buildings.size()) continue;
        const observe::BuildingImpact& b = run.buildings[building];
        values.push_back(b.hit ? b.*member : absent);
    }
    return values;
}

BuildingOdds odds_of(const std::vector<RunRecord>& runs, std::size_t building, const Thresholds& thresholds) {
    BuildingOdds odds;
    std::size_t count = 0, hits = 0;
    for (const RunRecord& run : runs) {
        if (!run.complete() || building >= run.buildings.size()) continue;
        odds.name = run.buildings[building].name;
        ++count;
        hits += run.buildings[building].hit ? 1 : 0;
    }
    if (count == 0) return odds;
    const auto n = static_cast<double>(count);
    odds.hit = static_cast<double>(hits) / n;
    std::vector<double> pressures = values_of(runs, building, &observe::BuildingImpact::peak_impact_pressure, 0);
    for (const double limit : thresholds.pressure) {
        const auto over = std::count_if(pressures.begin(), pressures.end(), [&](double p) { return p > 1e3 * limit; });
        odds.over_pressure.push_back(static_cast<double>(over) / n);
    }
    odds.median_pressure = percentile(pressures, 50);
    odds.high_pressure = percentile(pressures, 95);
    std::vector<double> depths = values_of(runs, building, &observe::BuildingImpact::peak_depth, 0);
    odds.median_depth = percentile(depths, 50);
    odds.high_depth = percentile(depths, 95);
    const double late = std::numeric_limits<double>::infinity();
    std::vector<double> times = values_of(runs, building, &observe::BuildingImpact::first_hit_time, late);
    const auto known = [](double t) { return std::isfinite(t) ? t : observe::never; };
    odds.early_hit = known(percentile(times, 5));
    odds.median_hit = known(percentile(times, 50));
    return odds;
}

}  // namespace

double percentile(std::vector<double>& values, double percent) {
    if (values.empty()) return observe::never;
    std::sort(values.begin(), values.end());
    return values[rank_of(values.size(), percent)];
}

Result<Reduction> reduce(const std::vector<fs::path>& folders, std::size_t count, const std::string& plan,
                         const Thresholds& thresholds, const report::IntensityGuideline& guideline,
                         std::size_t memory) {
    Reduction out;
    std::vector<fs::path> files;
    for (std::size_t run = 0; run < count; ++run) {
        std::error_code error;
        const fs::path name = fs::path("runs") / fmt::format("{:06}.run", run);
        const auto there = std::find_if(folders.begin(), folders.end(),
                                        [&](const fs::path& f) { return fs::exists(f / name, error); });
        if (there == folders.end()) {
            out.missing.push_back(run);
            continue;
        }
        Result<RunRecord> record = read_run_record(*there / name, plan, run);
        if (!record) return Error{record.error().message + "; the command that made it makes the run again"};
        record->complete() ? ++out.complete : ++out.failed;
        out.runs.push_back(*std::move(record));
        files.push_back(*there / name);
    }
    TALUS_ASSIGN(const Stack stack, stack_of(out.runs, files));
    out.maps = wanted_maps(thresholds);
    for (EnsembleMap& map : out.maps) map.grid = Grid<float>(stack.geometry, not_there);
    for (std::size_t map = 0; map < recorded_maps.size() && !stack.layers.empty(); ++map) {
        std::vector<EnsembleMap*> made;
        for (EnsembleMap& m : out.maps) {
            if (m.map == map) made.push_back(&m);
        }
        TALUS_TRY(MapReducer(stack, map, out.complete, made).reduce(memory));
    }
    TALUS_ASSIGN(out.intensity, intensity_shares(stack, guideline, out.complete));
    std::size_t buildings = 0;
    for (const RunRecord& run : out.runs) buildings = std::max(buildings, run.buildings.size());
    for (std::size_t b = 0; b < buildings; ++b) out.buildings.push_back(odds_of(out.runs, b, thresholds));
    return out;
}

}  // namespace talus::ensemble
