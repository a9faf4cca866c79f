#include "run/saved_state.hpp"

#include <algorithm>
#include <array>
#include <exception>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/archive.hpp"
#include "core/hash.hpp"
#include "core/try.hpp"
#include "params/fields.hpp"

namespace talus::run {
namespace {

using StateJson = nlohmann::ordered_json;

/// Whether a value has part in the debris or in what is measured of it. The others say when a run ends, how fast it is
/// computed, or what is written about it.
bool has_part(const params::Section& section, const params::Parameter& parameter, params::ModelChoice model) {
    constexpr std::array<std::string_view, 15> sections = {
        "terrain",    "flow_path", "material", "solver",          "zone",    "release", "bed",          "inflow",
        "hydrograph", "buildings", "barrier",  "barrier_opening", "outputs", "gauge",   "cross_section"};
    constexpr std::array<std::string_view, 10> other_keys = {
        "solver.end_time_s",         "solver.thread_count",    "solver.backend",         "outputs.series",
        "outputs.series_interval_s", "outputs.geoid_height_m", "outputs.peak_thickness", "outputs.intensity_guideline",
        "outputs.contours",          "outputs.tracks"};
    const std::string key = section.name + "." + parameter.key;
    const bool of_the_other = parameter.use == (model == params::ModelChoice::particles ? params::KeyUse::depth_averaged
                                                                                        : params::KeyUse::particles);
    // What is in a file counts, not where it lies.
    return !of_the_other && parameter.kind != params::ParameterKind::path &&
           std::find(sections.begin(), sections.end(), section.name) != sections.end() &&
           std::find(other_keys.begin(), other_keys.end(), key) == other_keys.end();
}

StateJson values_of(const scene::Scene& scene) {
    StateJson values = StateJson::object();
    for_each_value(scene.spec, [&](const params::Section& section, std::size_t index,
                                   const params::Parameter& parameter, const params::ParameterValue& value) {
        if (!has_part(section, parameter, scene.spec.solver.model)) return;
        values[key_path(section, index, parameter)] = params::toml_text(value);
    });
    return values;
}

std::string text_of(const StateJson& object, const std::string& key) {
    const auto found = object.find(key);
    if (found == object.end()) return "";
    return found->is_string() ? found->get<std::string>() : found->dump();
}

StateJson inputs_of(const scene::Scene& scene) {
    StateJson inputs = StateJson::object();
    for (const scene::InputFile& input : scene.inputs) {
        // Observations have no part in a run; a role can have several files.
        constexpr std::array<std::string_view, 4> others = {"scene", "deposit outline", "affected area",
                                                            "elevation change"};
        const auto begins = [&](std::string_view other) { return input.role.starts_with(other); };
        if (std::any_of(others.begin(), others.end(), begins)) continue;
        inputs[input.role] = text_of(inputs, input.role) + input.hash;
    }
    return inputs;
}

/// As loaded: a file of another format can hold the same.
std::string terrain_hash(const terrain::Terrain& terrain) {
    const Grid<float>& elevation = terrain.elevation();
    const GridGeometry& g = elevation.geometry;
    const std::array<double, 5> place = {g.x_min, g.y_min, g.cell, static_cast<double>(g.columns),
                                         static_cast<double>(g.rows)};
    StateHash hash;
    hash.add(place.data(), sizeof place);
    hash.add(elevation.values.data(), elevation.values.size() * sizeof(float));
    return to_hex(hash.value());
}

/// "particle_spacing_m", or that of cells.
const char* resolution_key(const scene::Scene& scene) {
    return scene.spec.solver.model == params::ModelChoice::particles ? "particle_spacing_m" : "grid_cell_m";
}

/// What a state is of.
StateJson identity_of(const scene::Scene& scene, double resolution) {
    return {{"version", TALUS_VERSION},
            {resolution_key(scene), resolution},
            {"terrain", terrain_hash(scene.terrain)},
            {"values", values_of(scene)},
            {"inputs", inputs_of(scene)}};
}

/// As text: what cannot be written in UTF-8 is the same in two states then.
std::string text_of(const StateJson& head) {
    return head.dump(-1, ' ', false, StateJson::error_handler_t::replace);
}

/// "material.friction_angle_deg = 20, here it is 25" of the first key that is not the same.
std::string first_difference(const StateJson& saved, const StateJson& here) {
    const auto given = [](const std::string& text) { return text.empty() ? std::string("not given") : text; };
    for (const StateJson* keys : {&saved, &here}) {
        for (const auto& item : keys->items()) {
            const std::string a = text_of(saved, item.key()), b = text_of(here, item.key());
            if (a != b) return fmt::format("{} = {}, here it is {}", item.key(), given(a), given(b));
        }
    }
    return "";
}

/// What is different; empty: nothing.
std::string difference(const StateJson& saved, const StateJson& here, const std::string& resolution) {
    const std::string version = text_of(saved, "version");
    if (version != TALUS_VERSION) {
        return fmt::format("was written by talus {}, this is talus {}", version, TALUS_VERSION);
    }
    // The model has keys of its own.
    const std::string model = "solver.model", was = text_of(saved.at("values"), model);
    if (was != text_of(here.at("values"), model)) {
        return fmt::format("is of a scene with {} = {}, here it is {}", model, was, text_of(here.at("values"), model));
    }
    // Values first: the particle spacing follows from them.
    const std::string value = first_difference(saved.at("values"), here.at("values"));
    if (!value.empty()) return "is of a scene with " + value;
    if (saved.at("terrain") != here.at("terrain")) return "is of another terrain";
    for (const StateJson* keys : {&saved.at("inputs"), &here.at("inputs")}) {
        for (const auto& item : keys->items()) {
            if (text_of(saved.at("inputs"), item.key()) == text_of(here.at("inputs"), item.key())) continue;
            return fmt::format("is of a scene with another input file for \"{}\"", item.key());
        }
    }
    const std::string a = text_of(saved, resolution), b = text_of(here, resolution);
    if (a == b) return "";
    return fmt::format("is of a run with {} = {}, here it is {}", resolution, a, b);
}

}  // namespace

Status check_state_can_be_saved(const scene::Scene& scene) {
    if (scene.zoom) return Error{"a zoom is two runs, and has no single state"};
    return {};
}

Status check_run_can_be_saved(const Run& run) {
    if (run.simulation().backend() == params::BackendChoice::cpu) return {};
    return Error{"a state can be saved, and a run start from one, with solver.backend = \"cpu\" only"};
}

std::string join_state(const scene::Scene& scene, double resolution, double time, const std::string& bytes) {
    StateJson head = identity_of(scene, resolution);
    head["time_s"] = time;
    return text_of(head) + "\n" + bytes;
}

Result<std::string_view> split_state(const scene::Scene& scene, double resolution, std::string_view state) {
    const std::size_t line = state.find('\n');
    try {
        const StateJson saved = StateJson::parse(state.substr(0, line));
        const StateJson here = StateJson::parse(text_of(identity_of(scene, resolution)));
        const std::string different = difference(saved, here, resolution_key(scene));
        if (!different.empty()) return Error{different};
    } catch (const std::exception&) {
        return Error{"is no state of a run"};
    }
    return line == std::string_view::npos ? std::string_view() : state.substr(line + 1);
}

Status check_whole(const ArchiveReader& archive) {
    if (archive.complete()) return {};
    return Error{"is no state of a run, or of another build of the program"};
}

Result<std::string> save_state(const scene::Scene& scene, Run& run) {
    TALUS_TRY(check_run_can_be_saved(run));
    if (run.phase() == RunPhase::fault) return Error{"the last step cannot be trusted, so its state is not saved"};
    ArchiveWriter archive;
    run.save(archive);
    return join_state(scene, run.model().particle_spacing, run.summary().time, archive.take());
}

Status restore_state(const scene::Scene& scene, Run& run, std::string_view state) {
    TALUS_TRY(check_run_can_be_saved(run));
    TALUS_ASSIGN(const std::string_view bytes, split_state(scene, run.model().particle_spacing, state));
    ArchiveReader archive(bytes);
    run.restore(archive);
    return check_whole(archive);
}

}  // namespace talus::run
