#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/try.hpp"
#include "design/design.hpp"
#include "design/parts.hpp"
#include "design/search.hpp"
#include "ensemble/reduction.hpp"
#include "terrain/barrier.hpp"

namespace talus::design {
namespace {

constexpr std::size_t most_confirmed = 5;  ///< runs that are repeated with particles

/// Searches one line.
class LineSearch {
  public:
    LineSearch(const Design& design, std::size_t line, const PartRunner& run)
        : design_(design), line_(line), run_(run) {
        made_.line = design.lines[line];
        made_.length = terrain::length_of(made_.line.points);
    }

    /// Nothing: interrupted.
    Result<std::optional<LineResult>> search() {
        TALUS_ASSIGN(const bool there, run_undisturbed());
        if (!there) return std::optional<LineResult>();
        const auto found = least_index(design_.heights.size(), [&](std::size_t k) { return try_height(k); });
        if (!found)
            return interrupted_ ? Result<std::optional<LineResult>>(std::optional<LineResult>()) : found.error();
        std::sort(made_.trials.begin(), made_.trials.end(),
                  [](const Trial& a, const Trial& b) { return a.height < b.height; });
        for (std::size_t k = 0; k < made_.trials.size() && *found; ++k) {
            if (made_.trials[k].height == design_.heights[**found]) made_.found = k;
        }
        find_not_monotone();
        find_capacity();
        if (design_.request.confirm && made_.found) {
            TALUS_ASSIGN(const bool done, confirm());
            if (!done) return std::optional<LineResult>();
        }
        made_.verdict = judge_together(records_);
        return std::optional(std::move(made_));
    }

  private:
    Result<std::optional<PartRuns>> run_part(const Part& part) {
        TALUS_ASSIGN(const bool done, run_(part));
        if (!done) {
            interrupted_ = true;
            return std::optional<PartRuns>();
        }
        TALUS_ASSIGN(PartRuns read, read_part(part));
        const auto complete =
            std::count_if(read.runs.begin(), read.runs.end(), [](const auto& r) { return r.has_value(); });
        if (complete < 2 && !part.particles) {
            return Error{fmt::format("{}: {} of {} runs are complete; a design needs at least two{}",
                                     part.folder.string(), complete, read.runs.size(),
                                     read.records.front().complete() ? "" : ": " + read.records.front().fault)};
        }
        made_.failed += read.runs.size() - static_cast<std::size_t>(complete);
        for (ensemble::RunRecord& record : read.records) records_.push_back(std::move(record));
        read.records.clear();
        return std::optional(std::move(read));
    }

    Result<bool> run_undisturbed() {
        TALUS_ASSIGN(auto read, run_part(make_part(design_, line_, 0)));
        if (!read) return false;
        made_.undisturbed = std::move(read->runs);
        std::vector<double> speed, depth, discharge, volume;
        for (const auto& run : made_.undisturbed) {
            if (!run) continue;
            speed.push_back(run->speed);
            depth.push_back(run->depth);
            discharge.push_back(run->peak_discharge);
            volume.push_back(run->crossed);
        }
        made_.speed = spread_of(std::move(speed));
        made_.depth = spread_of(std::move(depth));
        made_.discharge = spread_of(std::move(discharge));
        made_.volume = spread_of(std::move(volume));
        if (made_.volume.greatest > 0) return true;
        return Error{fmt::format("line \"{}\": no run reaches it; there is nothing to design", made_.line.name)};
    }

    /// Whether no more passes than is allowed.
    Result<bool> try_height(std::size_t index) {
        TALUS_ASSIGN(auto read, run_part(make_part(design_, line_, design_.heights[index])));
        if (!read) return Error{"interrupted"};
        Trial trial;
        trial.height = design_.heights[index];
        trial.runs = std::move(read->runs);
        double count = 0, passed = 0, volume = 0, crossed = 0;
        for (std::size_t k = 0; k < trial.runs.size(); ++k) {
            if (!trial.runs[k] || !made_.undisturbed[k]) continue;
            ++count;
            passed += trial.runs[k]->passes() ? 1 : 0;
            volume += trial.runs[k]->passing();
            crossed += made_.undisturbed[k]->crossed;
        }
        if (!(count > 0) || !(crossed > 0)) {
            return Error{
                fmt::format("line \"{}\": no run that reaches it is complete both without the barrier and at {:g} m",
                            made_.line.name, trial.height)};
        }
        trial.passing_runs = passed / count;
        trial.passing_volume = volume / crossed;
        trial.enough = (design_.request.of_volume ? trial.passing_volume : trial.passing_runs) <= design_.request.share;
        made_.trials.push_back(std::move(trial));
        return made_.trials.back().enough;
    }

    void find_not_monotone() {
        for (std::size_t k = 1; k < made_.trials.size(); ++k) {
            const Trial &low = made_.trials[k - 1], &high = made_.trials[k];
            std::vector<std::size_t> runs;
            for (std::size_t r = 0; r < low.runs.size(); ++r) {
                if (low.runs[r] && high.runs[r] && !low.runs[r]->passes() && high.runs[r]->passes()) runs.push_back(r);
            }
            if (!runs.empty()) {
                made_.not_monotone.push_back(fmt::format("Run {} passes at {:g} m, but not at {:g} m.",
                                                         fmt::join(runs, ", "), high.height, low.height));
            }
            if (low.enough && !high.enough) {
                made_.not_monotone.push_back(
                    fmt::format("{:g} m is enough, {:g} m is not: the least height depends on where the search began.",
                                low.height, high.height));
            }
        }
    }

    void find_capacity() {
        const terrain::Terrain& ground = design_.scene->terrain;
        const std::vector<PlanPoint>& points = made_.line.points;
        const double height = made_.shown().height;
        double thickness = 1;
        for (const terrain::Building& b : design_.scene->buildings) {
            if (b.barrier && b.name == design_.request.barrier) thickness = b.barrier->thickness;
        }
        made_.side = upstream_side(ground, points);
        made_.slope = std::max(0.0, ground_slope(ground, points, made_.side, std::max(10 * height, 4 * ground.cell())));
        const auto& wanted = design_.request.deposition_slope;
        made_.deposition_slope = wanted ? std::tan(*wanted * std::numbers::pi / 180) : made_.slope / 2;
        const auto behind = [&](double h, double slope) {
            return storage_behind(ground, points, made_.side, h, thickness, slope);
        };
        made_.level = behind(height, 0);
        made_.sloped = behind(height, made_.deposition_slope);
        constexpr int steps = 12;
        const double most = design_.heights.back();
        for (int k = 1; k <= steps; ++k) {
            const double h = most * k / steps;
            made_.capacity.emplace_back(h, behind(h, 0).volume);
        }
    }

    /// Repeats with particles the runs that a little less height lets pass, those that passed most first; if there are
    /// none, those that come nearest to passing.
    Result<bool> confirm() {
        const Trial& at = made_.shown();
        const Trial& below = made_.trials[*made_.found > 0 ? *made_.found - 1 : 0];
        std::vector<std::pair<double, std::size_t>> order;
        for (std::size_t r = 0; r < at.runs.size(); ++r) {
            if (at.runs[r] && below.runs[r])
                order.emplace_back(-below.runs[r]->passing() - 1e-9 * below.runs[r]->run_up, r);
        }
        std::sort(order.begin(), order.end());
        for (const auto& [passing, run] : order) {
            if (made_.confirmed_runs.size() == most_confirmed) break;
            made_.confirmed_runs.push_back(run);
        }
        std::sort(made_.confirmed_runs.begin(), made_.confirmed_runs.end());
        TALUS_ASSIGN(const Part part, particle_part(design_, line_, at.height, made_.confirmed_runs));
        TALUS_ASSIGN(auto read, run_part(part));
        if (!read) return false;
        made_.confirmed = std::move(read->runs);
        return true;
    }

    const Design& design_;
    std::size_t line_;
    const PartRunner& run_;
    LineResult made_;
    std::vector<ensemble::RunRecord> records_;
    bool interrupted_ = false;
};

}  // namespace

Spread spread_of(std::vector<double> values) {
    if (values.empty()) return {};
    return {ensemble::percentile(values, 50), ensemble::percentile(values, 84), ensemble::percentile(values, 95),
            *std::max_element(values.begin(), values.end())};
}

Result<std::optional<DesignResult>> search(const Design& design, const PartRunner& run) {
    DesignResult result;
    result.design = &design;
    for (std::size_t line = 0; line < design.lines.size(); ++line) {
        TALUS_ASSIGN(auto made, LineSearch(design, line, run).search());
        if (!made) return std::optional<DesignResult>();
        result.lines.push_back(*std::move(made));
    }
    return std::optional(std::move(result));
}

}  // namespace talus::design
