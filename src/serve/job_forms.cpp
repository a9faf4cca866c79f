#include "serve/job_forms.hpp"

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "core/number_or_null.hpp"
#include "core/temporary_folder.hpp"
#include "core/try.hpp"
#include "design/design.hpp"
#include "ensemble/predict.hpp"
#include "params/fields.hpp"
#include "risk/study.hpp"
#include "run/cost.hpp"
#include "scene/builtin.hpp"
#include "scene/particle_spacing.hpp"
#include "twin/setup.hpp"
#include "validate/suite.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

/// A scene as a command loads it, and where from.
struct Loaded {
    TemporaryFolder folder;  // of the built-in one
    run::SceneSource source;
    scene::Scene scene;
};

Result<std::unique_ptr<Loaded>> load(const KnownScene& known) {
    auto loaded = std::make_unique<Loaded>();
    fs::path file = known.file;
    if (file.empty()) {
        if (loaded->folder.path().empty()) return Error{"cannot make a temporary folder; set TMPDIR"};
        TALUS_ASSIGN(file, scene::unpack_builtin_scene(loaded->folder.path()));
    }
    TALUS_ASSIGN(loaded->scene, scene::load_scene(file));
    loaded->source.file = file;
    return Result<std::unique_ptr<Loaded>>(std::move(loaded));
}

json parameter_json(const params::Parameter& parameter, const std::string& key, const std::string& label,
                    std::optional<double> value) {
    const params::Range& range = parameter.range;
    return {{"key", key},
            {"label", label},
            {"unit", parameter.unit},
            {"default", value ? json(*value) : json()},
            {"value", value ? json(*value) : json()},
            {"range",
             {{"low", number_or_null<json>(range.low)},
              {"high", number_or_null<json>(range.high)},
              {"low_included", range.low_included},
              {"high_included", range.high_included}}},
            {"help", parameter.help},
            {"used_by_depth_averaged", parameter.use != params::KeyUse::particles}};
}

void add_material(const params::SceneSpec& spec, json& list) {
    for (const params::Parameter* parameter : twin::live_parameters()) {
        const std::string key = "material." + parameter->key;
        // What the scene's model has no use for explains nothing.
        const bool for_particles = parameter->use == params::KeyUse::particles;
        if (spec.solver.model == params::ModelChoice::depth_averaged && for_particles) continue;
        const double value = twin::value_in_force(spec.material, *parameter, 0);
        list.push_back(parameter_json(*parameter, key, twin::label_of(*parameter),
                                      std::isfinite(value) ? std::optional(value) : std::nullopt));
    }
}

template <class Spec>
json names_of(const std::vector<Spec>& entries) {
    json names = json::array();
    for (const Spec& entry : entries) names.push_back(entry.name);
    return names;
}

/// As the commands of risk and options plan it.
Status check_risk(const WantedJob& wanted, const Loaded& loaded) {
    const params::SceneSpec& spec = loaded.scene.spec;
    const bool compare = wanted.kind == JobKind::options;
    if (compare && spec.options.empty()) return Error{"this scene has no [[option]]; there is nothing to compare"};
    std::vector<std::string> options = {compare ? "" : spec.scene.option};
    for (const params::OptionSpec& option : spec.options) {
        if (compare) options.push_back(option.name);
    }
    TALUS_TRY(risk::plan_study({wanted.ensemble, loaded.source, "", std::move(options), {}, !compare}));
    return {};
}

/// As the command plans it.
Status check_design(const WantedJob& wanted, const Loaded& loaded) {
    design::DesignRequest request = wanted.design;
    request.plan = wanted.ensemble;
    request.source = loaded.source;
    TALUS_TRY(design::plan_design(request));
    return {};
}

json barriers_of(const scene::Scene& scene) {
    json names = json::array();
    for (const terrain::Building& building : scene.buildings) {
        if (building.barrier) names.push_back(building.name);
    }
    return names;
}

/// Thickness or volume, whichever the scene gives.
void add_releases(const params::SceneSpec& spec, json& list) {
    const params::Section& section = *params::find_section("release");
    for (std::size_t i = 0; i < spec.releases.size(); ++i) {
        const params::ReleaseSpec& release = spec.releases[i];
        const bool alone = spec.releases.size() == 1;
        for (const auto& [key, value] : {std::pair{"thickness_m", release.thickness}, {"volume_m3", release.volume}}) {
            if (!value) continue;
            const params::Parameter& parameter = *section.find(key);
            std::string label = "release " + twin::label_of(parameter);
            if (!alone) label += " of " + (release.name.empty() ? fmt::format("{}", i + 1) : release.name);
            list.push_back(parameter_json(
                parameter, alone ? fmt::format("release.{}", key) : fmt::format("release[{}].{}", i, key), label,
                value));
        }
    }
}

json form_json(const scene::Scene& scene) {
    json parameters = json::array(), observations = json::array();
    add_material(scene.spec, parameters);
    add_releases(scene.spec, parameters);
    for (const ensemble::ObservedValue& observed : ensemble::observed_values(scene)) {
        observations.push_back(observed.name);
    }
    return {{"title", scene.spec.scene.title},
            {"parameters", parameters},
            {"observations", observations},
            {"events", names_of(scene.spec.risk_scenarios)},
            {"options", names_of(scene.spec.options)},
            {"barriers", barriers_of(scene)},
            {"limits",
             {{"runs", JobLimits::runs},
              {"ensemble_factors", JobLimits::ensemble_factors},
              {"calibration_factors", JobLimits::calibration_factors}}}};
}

/// Of one run on all cores: as many runs on one core each, side by side, take together not longer than one by one.
json estimate_json(const scene::Scene& scene, const run::Rehearsal& rehearsal) {
    const run::Cost cost = cost_of(scene, rehearsal, particle_spacing(scene));
    return {{"run_s", number_or_null<json>(cost.seeding_time + cost.wall_time)},
            {"particles", std::llround(cost.particles)},
            {"memory_bytes", std::llround(cost.memory)},
            {"cores", std::max(1U, std::thread::hardware_concurrency())}};
}

Result<json> cases_json() {
    const TemporaryFolder unpacked;
    if (unpacked.path().empty()) return Error{"cannot make a temporary folder; set TMPDIR"};
    TALUS_ASSIGN(const fs::path folder, validate::unpack_builtin_cases(unpacked.path()));
    json list = json::array();
    for (const std::string& name : validate::builtin_case_names()) {
        TALUS_ASSIGN(const validate::Case loaded, validate::load_case(folder / name));
        list.push_back({{"name", name}, {"title", loaded.title}, {"quick", loaded.quick}});
    }
    return json{{"cases", list}};
}

Response of(const Result<json>& content, int refused) {
    return content ? json_response(200, *content) : error_response(refused, content.error().message);
}

}  // namespace

JobForms::~JobForms() {
    (void)begin_estimate();  // ends the one under way
    lane_.close();
}

JobForms::Stop JobForms::begin_estimate() {
    const std::lock_guard lock(mutex_);
    *stop_ = true;
    return stop_ = std::make_shared<std::atomic<bool>>(false);
}

void JobForms::describe(const KnownScene& scene, const Respond& respond) {
    lane_.post([scene, respond] {
        const auto loaded = load(scene);
        if (!loaded) return respond(error_response(409, loaded.error().message));
        respond(json_response(200, form_json((*loaded)->scene)));
    });
}

void JobForms::estimate(const KnownScene& scene, const Respond& respond) {
    lane_.post([scene, respond, stop = begin_estimate()] {
        const auto estimated = [&]() -> Result<json> {
            if (*stop) return Error{"another estimate was asked for"};
            TALUS_ASSIGN(const auto loaded, load(scene));
            if (loaded->scene.spec.solver.model != params::ModelChoice::particles) {
                return Error{"there is no estimate for the depth-averaged model"};
            }
            TALUS_ASSIGN(const auto rehearsal, run::rehearse(loaded->scene, particle_spacing(loaded->scene), *stop));
            if (*stop) return Error{"another estimate was asked for"};
            return estimate_json(loaded->scene, rehearsal);
        }();
        respond(of(estimated, 409));
    });
}

void JobForms::cases(const Respond& respond) {
    lane_.post([respond] { respond(of(cases_json(), 500)); });
}

void JobForms::check(const WantedJob& wanted, const KnownScene& scene, const Respond& respond,
                     std::function<void()> then) {
    lane_.post([wanted, scene, respond, then = std::move(then)] {
        const auto checked = [&]() -> Status {
            TALUS_ASSIGN(const auto loaded, load(scene));
            if (wanted.kind == JobKind::ensemble) {
                TALUS_TRY(ensemble::PlannedRuns::make(wanted.ensemble, loaded->source, loaded->scene));
            } else if (is_risk(wanted.kind)) {
                TALUS_TRY(check_risk(wanted, *loaded));
            } else if (wanted.kind == JobKind::design) {
                TALUS_TRY(check_design(wanted, *loaded));
            } else {
                TALUS_TRY(calibrate::plan_calibration(wanted.calibration, loaded->source, loaded->scene));
            }
            return {};
        }();
        if (!checked) return respond(error_response(400, checked.error().message));
        then();
    });
}

}  // namespace talus::serve
