#include "run/variants.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "observe/observer.hpp"
#include "params/time_step.hpp"
#include "scene/particle_spacing.hpp"
#include "sim/physics/viscosity.hpp"
#include "terrain/map_cell.hpp"

namespace talus::run {
namespace {

constexpr std::string_view base_name = "as given";

double particles_of(const scene::Scene& scene) {
    return total_volume(scene) / std::pow(particle_spacing(scene), 3);
}

double largest_step(const scene::Scene& scene) {
    return params::largest_time_step(scene.spec.solver, particle_spacing(scene));
}

/// What a run costs, in arbitrary units: particles times iterations, over the time step at a speed that debris has.
double effort_of(const scene::Scene& scene) {
    constexpr double usual_speed = 10;         // m/s
    constexpr double beside_iterations = 2.2;  // cost of neighbours, contacts and observation, in iterations
    const params::SolverSpec& solver = scene.spec.solver;
    const double adaptive =
        std::min(largest_step(scene), solver.displacement_limit * particle_spacing(scene) / usual_speed);
    return particles_of(scene) * (solver.iteration_count + beside_iterations) / solver.time_step.value_or(adaptive);
}

/// "a,[b,c],\"d,e\"" -> "a", "[b,c]", "\"d,e\"".
std::vector<std::string> split_values(std::string_view text) {
    std::vector<std::string> values(1);
    int depth = 0;
    char quote = 0;
    for (const char c : text) {
        if (quote != 0) {
            quote = c == quote ? 0 : quote;
        } else if (c == '"' || c == '\'') {
            quote = c;
        } else if (c == '[' || c == ']') {
            depth += c == '[' ? 1 : -1;
        } else if (c == ',' && depth == 0) {
            values.emplace_back();
            continue;
        }
        values.back() += c;
    }
    return values;
}

/// Messages about overrides name the command-line option, which is not where a variant's values come from.
std::string of_variant(const Variant& variant, std::string_view message) {
    constexpr std::string_view option = "--set ";
    if (message.starts_with(option)) message.remove_prefix(option.size());
    std::string set = variant.name;  // "key = value", if one value varies
    std::erase(set, ' ');
    if (message.starts_with(set)) return fmt::format("variant {}", message);
    return fmt::format("variant {}: {}", variant.name, message);
}

Result<scene::Scene> load_variant(const SceneSource& source, const Variant& variant) {
    std::vector<std::string> overrides = source.overrides;
    overrides.insert(overrides.end(), variant.overrides.begin(), variant.overrides.end());
    Result<scene::Scene> scene = scene::load_scene(source.file, overrides);
    if (!scene) return Error{of_variant(variant, scene.error().message)};
    return scene;
}

double kinematic_viscosity_of(const scene::Scene& scene) {
    const params::MaterialSpec& material = scene.spec.material;
    if (material.kinematic_viscosity) return *material.kinematic_viscosity;
    const double spacing = particle_spacing(scene), radius = scene.spec.solver.support_ratio * spacing;
    return sim::kinematic_viscosity(material.viscosity,
                                    sim::make_kernel(scene.spec.solver.kernel, spacing, radius).second_moment);
}

}  // namespace

std::vector<Variant> refinements(const scene::Scene& base) {
    const params::SolverSpec& solver = base.spec.solver;
    Variant step{.name = "half the time step", .overrides = {}};
    if (solver.time_step) {
        step.overrides = {fmt::format("solver.time_step_s={}", *solver.time_step / 2)};
    } else {
        step.overrides = {fmt::format("solver.largest_time_step_s={}", largest_step(base) / 2),
                          fmt::format("solver.smallest_time_step_s={}", solver.smallest_time_step / 2),
                          fmt::format("solver.displacement_limit={}", solver.displacement_limit / 2)};
    }
    Variant iterations{.name = "double the iterations",
                       .overrides = {fmt::format("solver.iteration_count={}", 2 * solver.iteration_count)}};
    const double map_cell =
        base.spec.outputs.map_cell.value_or(terrain::default_map_cell(base.terrain.cell(), particle_spacing(base)));
    Variant particles{
        .name = "three times the particles",
        .overrides = {fmt::format("solver.particle_spacing_m={}", particle_spacing(base) / std::cbrt(3.0)),
                      // The same smoothing would be another material at another spacing.
                      fmt::format("material.kinematic_viscosity_m2ps={}", kinematic_viscosity_of(base)),
                      // Areas and depths are compared on the same cells.
                      fmt::format("outputs.map_cell_m={}", map_cell)}};
    return {step, iterations, particles};
}

Result<std::vector<Variant>> variations(std::string_view text) {
    const std::size_t equals = text.find('=');
    const std::string_view key = text.substr(0, equals);
    const auto problem = [&](std::string_view what) {
        return Error{fmt::format("variation \"{}\": {}; write section.key=value,value", text, what)};
    };
    if (equals == std::string_view::npos || key.empty()) return problem("there is no key with values");
    std::vector<Variant> variants;
    for (const std::string& value : split_values(text.substr(equals + 1))) {
        if (value.empty()) return problem("a value is empty");
        variants.push_back(
            {.name = fmt::format("{} = {}", key, value), .overrides = {fmt::format("{}={}", key, value)}});
    }
    return variants;
}

std::vector<Variant> named_variants(const params::SceneSpec& scene) {
    std::vector<Variant> variants;
    for (const params::VariantSpec& named : scene.variants) {
        std::string about = named.notes;
        if (!named.source.empty()) about += fmt::format("{}Source: {}", about.empty() ? "" : " ", named.source);
        variants.push_back({.name = named.name, .overrides = named.set, .about = std::move(about)});
    }
    return variants;
}

Result<std::vector<Variant>> prepare_variants(const SceneSource& source, const scene::Scene& base,
                                              std::vector<Variant> variants) {
    for (Variant& variant : variants) {
        TALUS_ASSIGN(const scene::Scene scene, load_variant(source, variant));
        variant.effort = effort_of(scene) / effort_of(base);
    }
    return variants;
}

VariantRun run_variant(const SceneSource& source, const Variant& variant, const RunOptions& options) {
    VariantRun run{variant, std::nullopt, ""};
    if (options.stop_requested && options.stop_requested->load()) {
        run.missing = "interrupted before it began";
        return run;
    }
    const Result<scene::Scene> scene = load_variant(source, variant);
    if (!scene) {
        run.missing = scene.error().message;
        return run;
    }
    Result<RunResult> result = run_scene(*scene, options);
    if (!result) {
        run.missing = of_variant(variant, result.error().message);
    } else if (result->status == RunStatus::interrupted) {
        run.missing = fmt::format("interrupted at t = {:.4g} s", result->simulated_time);
    } else if (result->status == RunStatus::fault) {
        run.missing = "fault " + result->stop_reason;
    } else {
        run.peaks = observe::measure_peaks(result->observation.maps);
        result->observation.maps = {};
        result->observation.timeseries = {};
        run.result = *std::move(result);
    }
    return run;
}

namespace {

std::vector<double> efforts_of(const std::vector<Variant>& variants) {
    std::vector<double> efforts = {1};  // of the base
    for (const Variant& variant : variants) efforts.push_back(variant.effort);
    return efforts;
}

}  // namespace

SeriesClock::SeriesClock(std::vector<Variant> variants) : variants_(std::move(variants)), work_(efforts_of(variants_)) {
    work_.begin(0, 0);
}

SeriesProgress SeriesClock::at(const Progress& now) {
    now_ = before_ + (now.real_time_factor > 0 ? now.time / now.real_time_factor : 0);
    work_.tick(run_, now_, now.wall_remaining);
    return {run_ + 1, variants_.size() + 1, run_ == 0 ? base_name : variants_[run_ - 1].name, work_.share_done(now_),
            work_.wall_remaining(now_)};
}

void SeriesClock::base_ended(const RunResult& result) {
    now_ = result.wall_time;
    next_begins();
}

void SeriesClock::variant_ended() {
    next_begins();
}

void SeriesClock::next_begins() {
    work_.end(run_, now_);
    before_ = now_;
    ++run_;
    if (run_ <= variants_.size()) work_.begin(run_, now_);
}

}  // namespace talus::run
