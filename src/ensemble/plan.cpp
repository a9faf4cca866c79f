#include "ensemble/plan.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/try.hpp"
#include "params/fields.hpp"
#include "scene/particle_spacing.hpp"
#include "terrain/map_cell.hpp"

namespace talus::ensemble {
namespace {

constexpr std::size_t max_runs = 1000000;

/// The section and the key of "section.key" or "section[0].key", where both exist.
const params::Parameter* find_parameter(std::string_view key_path) {
    const std::size_t dot = key_path.find('.');
    if (dot == std::string_view::npos) return nullptr;
    const std::string_view name = key_path.substr(0, dot);
    const params::Section* section = params::find_section(name.substr(0, name.find('[')));
    return section != nullptr ? section->find(key_path.substr(dot + 1)) : nullptr;
}

/// The size of a release may be given in one way only: a factor replaces the value of the scene.
std::vector<std::string> replaced_by(const std::string& key_path) {
    constexpr std::string_view ways[] = {"thickness_m", "thickness_attribute", "thickness_raster", "volume_m3"};
    const std::size_t dot = key_path.find('.');
    if (!key_path.starts_with("release") ||
        std::find(std::begin(ways), std::end(ways), key_path.substr(dot + 1)) == std::end(ways)) {
        return {};
    }
    std::vector<std::string> overrides;
    for (const std::string_view way : ways) {
        if (key_path.substr(dot + 1) != way)
            overrides.push_back(fmt::format("{}.{}=none", key_path.substr(0, dot), way));
    }
    return overrides;
}

std::string number_text(double value, bool whole) {
    return whole ? fmt::format("{}", std::llround(value)) : fmt::format("{:.9g}", value);
}

/// The parser's message about an override, as one about a factor.
Error about_factor(const Error& error) {
    constexpr std::string_view option = "--set ";
    std::string message = error.message;
    if (message.starts_with(option)) message = "factor " + message.substr(option.size());
    return Error{message};
}

/// Cuts a normal distribution to what the key allows; everything else is checked by parsing its ends.
void cut_to_range(stats::Distribution& d, const params::Range& range) {
    if (d.kind != stats::DistributionKind::normal) return;
    const auto inward = [](double bound, bool included, double towards) {
        return included ? bound : std::nextafter(bound, towards);
    };
    d.low = std::max(d.low, inward(range.low, range.low_included, range.high));
    d.high = std::min(d.high, inward(range.high, range.high_included, range.low));
}

/// Extreme values of the factor, or all entries of its list.
std::vector<std::string> ends_of(const Factor& factor, bool whole) {
    const stats::Distribution& d = factor.distribution;
    if (d.kind == stats::DistributionKind::list) return d.entries;
    return {number_text(d.quantile(0), whole), number_text(d.quantile(1), whole)};
}

Status check_factor(const Factor& factor, bool whole, const run::SceneSource& source) {
    const std::vector<std::string> replaced = replaced_by(factor.key);
    for (const std::string& value : ends_of(factor, whole)) {
        std::vector<std::string> overrides = source.overrides;
        overrides.insert(overrides.end(), replaced.begin(), replaced.end());
        overrides.push_back(factor.key + "=" + value);
        if (const auto parsed = scene::parse_scene(source.file, overrides); !parsed)
            return about_factor(parsed.error());
    }
    return {};
}

Result<stats::Points> make_points(const EnsemblePlan& plan, const std::vector<std::size_t>& levels) {
    const std::size_t factors = plan.factors.size();
    const auto too_few = [&](std::size_t fewest, std::string_view block) {
        return Error{fmt::format("runs = {} is refused; {} of {} factors needs at least {} ({})", plan.runs,
                                 design_name(plan.design), factors, fewest, block)};
    };
    switch (plan.design) {
        case stats::DesignKind::grid: {
            double count = 1;
            for (const std::size_t n : levels) count *= static_cast<double>(n);
            if (count > static_cast<double>(max_runs)) {
                return Error{fmt::format("a grid of {:.3g} runs is refused; it must have at most {}", count, max_runs)};
            }
            return stats::grid_points(levels);
        }
        case stats::DesignKind::saltelli: {
            if (2 * factors > stats::sobol_dimensions) break;
            const std::size_t block = factors + 2;
            if (plan.runs < 2 * block) return too_few(2 * block, fmt::format("two blocks of factors + 2 = {}", block));
            return stats::saltelli_points(plan.runs / block, factors, plan.seed);
        }
        case stats::DesignKind::morris: {
            const std::size_t block = factors + 1;
            if (plan.runs < 2 * block)
                return too_few(2 * block, fmt::format("two trajectories of factors + 1 = {}", block));
            return stats::morris_points(plan.runs / block, factors, plan.seed);
        }
        case stats::DesignKind::sobol:
            if (factors > stats::sobol_dimensions) break;
            return sample_points(plan.design, plan.runs, factors, plan.seed);
        case stats::DesignKind::monte_carlo:
        case stats::DesignKind::latin_hypercube:
            return sample_points(plan.design, plan.runs, factors, plan.seed);
    }
    return Error{fmt::format(
        "{} factors are refused; the design {} takes at most {}", factors, design_name(plan.design),
        plan.design == stats::DesignKind::saltelli ? stats::sobol_dimensions / 2 : stats::sobol_dimensions)};
}

}  // namespace

Status add_factor(EnsemblePlan& plan, std::string_view text) {
    const std::size_t equals = text.find('=');
    const auto refused = [&](std::string_view why) { return Error{fmt::format("factor \"{}\": {}", text, why)}; };
    if (equals == std::string_view::npos || equals == 0) return refused("write section.key=low:high");
    Result<stats::Distribution> distribution = stats::parse_distribution(text.substr(equals + 1));
    if (!distribution) return refused(distribution.error().message);
    const std::string key(text.substr(0, equals));
    const auto same =
        std::find_if(plan.factors.begin(), plan.factors.end(), [&](const Factor& f) { return f.key == key; });
    if (same != plan.factors.end()) {
        same->distribution = *std::move(distribution);
    } else {
        plan.factors.push_back({key, *std::move(distribution)});
    }
    return {};
}

Result<std::vector<double>> parse_thresholds(std::string_view text, std::string_view what) {
    std::vector<double> values;
    const char* at = text.data();
    const char* const end = at + text.size();
    while (true) {
        double value = 0;
        const auto [stopped, error] = std::from_chars(at, end, value);
        const bool ascending = values.empty() || value > values.back();
        if (error != std::errc() || !std::isfinite(value) || value < 0 || !ascending ||
            (stopped != end && *stopped != ',')) {
            return Error{
                fmt::format("{} = \"{}\" is refused; it must be ascending numbers from 0, such as 0.5,1", what, text)};
        }
        values.push_back(value);
        if (stopped == end) return values;
        at = stopped + 1;
    }
}

Result<PlannedRuns> PlannedRuns::make(const EnsemblePlan& plan, const run::SceneSource& source,
                                      const scene::Scene& base) {
    PlannedRuns runs;
    runs.plan_ = plan;
    if (plan.factors.empty()) {
        return Error{"there is nothing to vary; give a plan file with [[factor]] or --vary section.key=low:high"};
    }
    if (plan.runs < 1 || plan.runs > max_runs) {
        return Error{fmt::format("runs = {} is refused; it must be 1 to {}", plan.runs, max_runs)};
    }
    bool own_spacing = false;
    const bool on_grid = base.spec.solver.model == params::ModelChoice::depth_averaged;
    for (Factor& factor : runs.plan_.factors) {
        const params::Parameter* parameter = find_parameter(factor.key);
        const bool number = parameter != nullptr && (parameter->kind == params::ParameterKind::number ||
                                                     parameter->kind == params::ParameterKind::integer);
        if (parameter != nullptr && !number && factor.distribution.kind != stats::DistributionKind::list) {
            return Error{fmt::format("factor {}: is not a number; give a list of its values", factor.key)};
        }
        if (plan.design == stats::DesignKind::grid && !factor.distribution.weights.empty()) {
            return Error{fmt::format("factor {}: has weights, but a grid runs every value once; choose another design",
                                     factor.key)};
        }
        runs.whole_.push_back(parameter != nullptr && parameter->kind == params::ParameterKind::integer);
        if (parameter != nullptr && number) cut_to_range(factor.distribution, parameter->range);
        TALUS_TRY(check_factor(factor, runs.whole_.back(), source));
        if (factor.key == "solver.model" || (on_grid && factor.key == "solver.grid_cell_m")) {
            return Error{fmt::format("factor {}: is refused; maps of all runs need the same cells", factor.key)};
        }
        own_spacing = own_spacing || factor.key == "solver.particle_spacing_m" ||
                      factor.key == "solver.target_layers" || factor.key == "solver.target_particle_count";
        runs.levels_.push_back(factor.distribution.kind == stats::DistributionKind::list
                                   ? factor.distribution.entries.size()
                                   : plan.levels);
    }
    if (plan.levels < 2 || plan.levels > 1000) {
        return Error{fmt::format("levels = {} is refused; it must be 2 to 1000", plan.levels)};
    }
    TALUS_ASSIGN(runs.points_, make_points(plan, runs.levels_));

    if (on_grid) return runs;  // its cells are those of the terrain, or as the scene says
    const double spacing = particle_spacing(base);
    const double cell = base.spec.outputs.map_cell.value_or(terrain::default_map_cell(base.terrain.cell(), spacing));
    if (!own_spacing) runs.fixed_.push_back(fmt::format("solver.particle_spacing_m={:.9g}", spacing));
    runs.fixed_.push_back(fmt::format("outputs.map_cell_m={:.17g}", cell));
    return runs;
}

PlannedRun PlannedRuns::at(std::size_t run) const {
    PlannedRun planned;
    planned.overrides = fixed_;
    planned.overrides.emplace_back("outputs.series=[]");  // runs do not write result folders
    for (std::size_t k = 0; k < plan_.factors.size(); ++k) {
        const Factor& factor = plan_.factors[k];
        double share = points_[run][k];
        const bool bounded = factor.distribution.kind == stats::DistributionKind::uniform ||
                             factor.distribution.kind == stats::DistributionKind::log_uniform;
        if (plan_.design == stats::DesignKind::grid && bounded) {  // from end to end
            const auto n = static_cast<double>(levels_[k]);
            share = (share * n - 0.5) / (n - 1);
        }
        const bool list = factor.distribution.kind == stats::DistributionKind::list;
        planned.values.push_back(list ? factor.distribution.entry(share)
                                      : number_text(factor.distribution.quantile(share), whole_[k]));
        const std::vector<std::string> replaced = replaced_by(factor.key);
        planned.overrides.insert(planned.overrides.end(), replaced.begin(), replaced.end());
        planned.overrides.push_back(factor.key + "=" + planned.values.back());
    }
    return planned;
}

}  // namespace talus::ensemble
