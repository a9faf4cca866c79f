#include "layers.hpp"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/try.hpp"
#include "params/fields.hpp"
#include "progress.hpp"
#include "scene/particle_spacing.hpp"

namespace talus::cli {
namespace {

constexpr std::string_view real_time_text = "real-time", key = "solver.target_layers=";

/// Errors: two of the overrides choose the particle spacing.
Status check_spacing_overrides(const std::vector<std::string>& overrides, const std::string& layers) {
    std::string first = layers.empty() ? "" : "--layers " + layers;
    for (const std::string& text : overrides) {
        const std::string_view path = std::string_view(text).substr(0, text.find('='));
        const bool chooses = path == "solver.particle_spacing_m" || path == "solver.target_layers" ||
                             path == "solver.target_particle_count";
        if (!chooses || text.ends_with("=none")) continue;
        const std::string option = "--set " + text;
        if (first.empty()) {
            first = option;
        } else if (std::string_view(first).substr(0, first.find('=')) != "--set " + std::string(path)) {
            return Error{fmt::format("{} and {}: both choose the particle spacing; give one of them", first, option)};
        }
    }
    return {};
}

/// The layers that run in real time, as overrides and in the notes of the scene loaded with them.
Status take_real_time(const std::filesystem::path& file, std::vector<std::string>& overrides,
                      const run::Rehearsal& rehearsal, const scene::ThinnestSource& thinnest, scene::Scene& scene) {
    const double layers = real_time_layers(scene, rehearsal, thinnest.thickness);
    if (layers < 1) {
        const LayersCost one{1, cost_of(scene, rehearsal, scene::spacing_of_layers(thinnest.thickness, 1))};
        return Error{
            fmt::format("--layers real-time is refused; this machine does not run one layer {} times as fast "
                        "as real time; {}",
                        run::real_time_margin, cost_text(one))};
    }
    *std::find(overrides.begin(), overrides.end(), fmt::format("{}1", key)) = fmt::format("{}{}", key, layers);
    TALUS_ASSIGN(scene, scene::load_scene(file, overrides));
    scene.notes.push_back(
        fmt::format("--layers real-time: {} layers are the most that this machine is estimated to run {} times as fast "
                    "as real time; --set solver.particle_spacing_m={} repeats the run on any machine",
                    layers, run::real_time_margin, particle_spacing(scene)));
    return {};
}

}  // namespace

void add_layers(CLI::App& command, std::string& layers, bool real_time) {
    command
        .add_option("--layers", layers,
                    real_time ? "particles over the thickness of the thinnest release; real-time: the most that this "
                                "machine runs in real time; says what they cost"
                              : "particles over the thickness of the thinnest release")
        ->type_name(real_time ? "N|real-time" : "N");
    if (real_time) return;
    command.get_option("--layers")->check([](const std::string& text) {
        return text == real_time_text ? std::string("real-time is for a single run; give a number") : std::string();
    });
}

Result<std::vector<std::string>> with_layers(std::vector<std::string> overrides, const std::string& layers) {
    TALUS_TRY(check_spacing_overrides(overrides, layers));
    if (layers == real_time_text) overrides.push_back(fmt::format("{}1", key));  // until settle_layers() finds them
    if (layers.empty() || layers == real_time_text) return overrides;
    double value = 0;
    const char* const end = layers.data() + layers.size();
    const auto [stopped, error] = std::from_chars(layers.data(), end, value);
    const params::Parameter& parameter = params::parameter_of("solver", "target_layers");
    if (error != std::errc() || stopped != end || !problem_with(parameter, value).empty()) {
        return Error{
            fmt::format("--layers {} is refused; it must be {}, or real-time", layers, allowed_text(parameter))};
    }
    overrides.push_back(fmt::format("{}{}", key, value));
    return overrides;
}

Result<scene::Scene> load_layered(const std::filesystem::path& file, const std::vector<std::string>& overrides,
                                  const std::string& layers) {
    Result<scene::Scene> scene = scene::load_scene(file, overrides);
    const std::string option = fmt::format("--set {}", key);
    if (scene || layers.empty() || !scene.error().message.starts_with(option)) return scene;
    const std::string& message = scene.error().message;
    return Error{fmt::format("--layers {}{}", layers, message.substr(message.find(": ")))};
}

Result<std::optional<LayersCost>> settle_layers(const std::filesystem::path& file, std::vector<std::string>& overrides,
                                                const std::string& layers, scene::Scene& scene,
                                                const std::function<void(const std::string&)>& say,
                                                const std::atomic<bool>& stop_requested) {
    const bool real_time = layers == real_time_text;
    if (!real_time && (!scene.spec.solver.target_layers || !say)) return std::optional<LayersCost>();
    const std::optional<scene::ThinnestSource> thinnest = thinnest_source(scene);
    if (!thinnest) return Error{"--layers real-time: needs a release or an inflow across a line"};
    if (say) say("measuring how fast this machine runs the scene");
    auto rehearsal = run::rehearse(scene, real_time ? 0 : particle_spacing(scene), stop_requested);
    if (stop_requested.load()) return std::optional<LayersCost>();
    if (!rehearsal) return Error{file.string() + ": " + rehearsal.error().message};
    if (real_time) TALUS_TRY(take_real_time(file, overrides, *rehearsal, *thinnest, scene));
    return std::optional(
        LayersCost{*scene.spec.solver.target_layers, cost_of(scene, *rehearsal, particle_spacing(scene))});
}

std::string cost_text(const LayersCost& settled) {
    const run::Cost& cost = settled.cost;
    return fmt::format(
        "{:.4g} layers: {:.0f} particles of {:.4g} m, about {} for {:.3g} s of debris ({:.2g} x real time), {:.2g} GB "
        "of memory",
        settled.layers, cost.particles, cost.particle_spacing, clock_text(cost.seeding_time + cost.wall_time),
        cost.simulated_time, cost.real_time_factor(), cost.memory / 1e9);
}

std::string cost_json(const LayersCost& settled) {
    const run::Cost& cost = settled.cost;
    return nlohmann::ordered_json{{"event", "cost"},
                                  {"layers", settled.layers},
                                  {"particle_spacing_m", cost.particle_spacing},
                                  {"particles", cost.particles},
                                  {"seeding_time_s", cost.seeding_time},
                                  {"wall_time_s", cost.wall_time},
                                  {"simulated_time_s", cost.simulated_time},
                                  {"real_time_factor", cost.real_time_factor()},
                                  {"memory_bytes", cost.memory}}
        .dump();
}

}  // namespace talus::cli
