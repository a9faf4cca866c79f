#include "serve/job_forms.hpp"

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "core/temporary_folder.hpp"
#include "core/try.hpp"
#include "design/design.hpp"
#include "ensemble/predict.hpp"
#include "messages/messages.hpp"
#include "params/fields.hpp"
#include "risk/study.hpp"
#include "run/cost.hpp"
#include "scene/builtin.hpp"
#include "scene/particle_spacing.hpp"
#include "twin/answers.hpp"
#include "twin/setup.hpp"
#include "validate/suite.hpp"

namespace talus::serve {
namespace {

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

/// With the value that the scene has.
messages::Parameter parameter_of(const params::Parameter& parameter, std::string key, double value) {
    messages::Parameter row = twin::described(parameter, std::move(key));
    row.default_ = row.value = value;
    return row;
}

void add_material(const params::SceneSpec& spec, std::vector<messages::Parameter>& list) {
    for (const params::Parameter* parameter : twin::live_parameters()) {
        // What the scene's model has no use for explains nothing.
        const bool for_particles = parameter->use == params::KeyUse::particles;
        if (spec.solver.model == params::ModelChoice::depth_averaged && for_particles) continue;
        list.push_back(
            parameter_of(*parameter, "material." + parameter->key, twin::value_in_force(spec.material, *parameter, 0)));
    }
}

template <class Spec>
std::vector<std::string> names_of(const std::vector<Spec>& entries) {
    std::vector<std::string> names;
    names.reserve(entries.size());
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

std::vector<std::string> barriers_of(const scene::Scene& scene) {
    std::vector<std::string> names;
    for (const terrain::Building& building : scene.buildings) {
        if (building.barrier) names.push_back(building.name);
    }
    return names;
}

/// Thickness or volume, whichever the scene gives.
void add_releases(const params::SceneSpec& spec, std::vector<messages::Parameter>& list) {
    const params::Section& section = *params::find_section("release");
    for (std::size_t i = 0; i < spec.releases.size(); ++i) {
        const params::ReleaseSpec& release = spec.releases[i];
        const bool alone = spec.releases.size() == 1;
        for (const auto& [key, value] : {std::pair{"thickness_m", release.thickness}, {"volume_m3", release.volume}}) {
            if (!value) continue;
            messages::Parameter& row = list.emplace_back(
                parameter_of(*section.find(key),
                             alone ? fmt::format("release.{}", key) : fmt::format("release[{}].{}", i, key), *value));
            row.label = "release " + row.label;
            if (!alone) row.label += " of " + (release.name.empty() ? fmt::format("{}", i + 1) : release.name);
        }
    }
}

messages::JobForm form_of(const scene::Scene& scene) {
    messages::JobForm form{.title = scene.spec.scene.title,
                           .parameters = {},
                           .observations = names_of(ensemble::observed_values(scene)),
                           .events = names_of(scene.spec.risk_scenarios),
                           .options = names_of(scene.spec.options),
                           .barriers = barriers_of(scene),
                           .limits = {.runs = JobLimits::runs,
                                      .ensemble_factors = JobLimits::ensemble_factors,
                                      .calibration_factors = JobLimits::calibration_factors}};
    add_material(scene.spec, form.parameters);
    add_releases(scene.spec, form.parameters);
    return form;
}

/// Of one run on all cores: as many runs on one core each, side by side, take together not longer than one by one.
messages::JobEstimate estimate_of(const scene::Scene& scene, const run::Rehearsal& rehearsal) {
    const run::Cost cost = cost_of(scene, rehearsal, particle_spacing(scene));
    return {.run_s = cost.seeding_time + cost.wall_time,
            .particles = std::llround(cost.particles),
            .memory_bytes = std::llround(cost.memory),
            .cores = std::max(1U, std::thread::hardware_concurrency())};
}

Result<messages::ValidationCases> validation_cases() {
    const TemporaryFolder unpacked;
    if (unpacked.path().empty()) return Error{"cannot make a temporary folder; set TMPDIR"};
    TALUS_ASSIGN(const fs::path folder, validate::unpack_builtin_cases(unpacked.path()));
    messages::ValidationCases all{.cases = {}};
    for (const std::string& name : validate::builtin_case_names()) {
        TALUS_ASSIGN(const validate::Case loaded, validate::load_case(folder / name));
        all.cases.push_back({.name = name, .title = loaded.title, .quick = loaded.quick});
    }
    return Result<messages::ValidationCases>(std::move(all));
}

template <class Message>
Response of(const Result<Message>& content, int refused) {
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
        respond(json_response(200, form_of((*loaded)->scene)));
    });
}

void JobForms::estimate(const KnownScene& scene, const Respond& respond) {
    lane_.post([scene, respond, stop = begin_estimate()] {
        const auto estimated = [&]() -> Result<messages::JobEstimate> {
            if (*stop) return Error{"another estimate was asked for"};
            TALUS_ASSIGN(const auto loaded, load(scene));
            if (loaded->scene.spec.solver.model != params::ModelChoice::particles) {
                return Error{"there is no estimate for the depth-averaged model"};
            }
            TALUS_ASSIGN(const auto rehearsal, run::rehearse(loaded->scene, particle_spacing(loaded->scene), *stop));
            if (*stop) return Error{"another estimate was asked for"};
            return estimate_of(loaded->scene, rehearsal);
        }();
        respond(of(estimated, 409));
    });
}

void JobForms::cases(const Respond& respond) {
    lane_.post([respond] { respond(of(validation_cases(), 500)); });
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
