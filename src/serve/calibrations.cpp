#include "serve/calibrations.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "calibrate/calibration_products.hpp"
#include "core/try.hpp"
#include "ensemble/ensemble_folder.hpp"
#include "params/fields.hpp"
#include "serve/job.hpp"
#include "twin/json_keys.hpp"
#include "twin/setup.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr std::chrono::milliseconds tell_every{1000};
constexpr std::size_t max_parameters = 6;

/// Four digits are more than a colour can show, and reduce the message to a third.
double rounded(double value) {
    if (!(value > 0)) return value;
    const double unit = std::pow(10, std::floor(std::log10(value)) - 3);
    return std::round(value / unit) * unit;
}

const params::Parameter* find_live_parameter(const std::string& key) {
    for (const params::Parameter* parameter : twin::live_parameters()) {
        if ("material." + parameter->key == key) return parameter;
    }
    return nullptr;
}

Status is_live(const json& key) {
    if (key.is_string() && find_live_parameter(key.get<std::string>()) != nullptr) return {};
    return Error{fmt::format("parameters: key = {}: must be one of the scene's parameters", key.dump().substr(0, 80))};
}

Result<calibrate::CalibrationPlan> read_plan(const json& wanted) {
    calibrate::CalibrationPlan plan;
    if (wanted.is_object()) TALUS_TRY(twin::check_keys(wanted, {"parameters", "runs", "search_with"}));
    const auto list = wanted.is_object() ? wanted.find("parameters") : wanted.end();
    if (list == wanted.end() || !list->is_array() || list->empty() || list->size() > max_parameters) {
        return Error{fmt::format("parameters: must be a list of 1 to {}, each with key, low and high", max_parameters)};
    }
    for (const json& entry : *list) {
        TALUS_ASSIGN(auto factor, read_factor(entry, "parameters", is_live));
        for (const ensemble::Factor& other : plan.factors) {
            if (other.key == factor.key) return Error{fmt::format("parameters: {} is given twice", other.key)};
        }
        plan.factors.push_back(std::move(factor));
    }
    if (const auto with = wanted.find("search_with"); with != wanted.end() && !with->is_null()) {
        if (*with != "depth_averaged") {
            return Error{fmt::format("search_with = {}: must be depth_averaged or null", with->dump().substr(0, 40))};
        }
        plan.search.runs = calibrate::runs_beside_fast;
        plan.search.fast_runs = calibrate::default_fast_runs;
    }
    if (const auto runs = wanted.find("runs"); runs != wanted.end()) {
        if (!runs->is_number_unsigned() || runs->get<std::uint64_t>() > 2000) {
            return Error{fmt::format("runs = {}: must be a whole number up to 2000", runs->dump().substr(0, 40))};
        }
        plan.search.runs = runs->get<std::size_t>();
    }
    return plan;
}

}  // namespace

Calibrations::Calibrations(Executor& executor, std::shared_ptr<const scene::Scene> scene, CalibrationSettings settings,
                           std::function<void(json)> tell)
    : settings_(std::move(settings)),
      opened_(std::move(scene)),
      scene_(opened_),
      observed_(ensemble::observed_values(*scene_)),
      tell_(std::move(tell)),
      status_{.state = calibration_.state_name(),
              .why_not = why_none(observed_, settings_.source),
              .by = {},
              .message = {},
              .observations = listed(observed_),
              .parameters = {},
              .phase = {},
              .runs_at_most = 0,
              .runs_failed = 0,
              .fast_runs = {},
              .fast_runs_at_most = 0,
              .wall_remaining_s = {},
              .runs = {},
              .map = {},
              .best = {},
              .result = {}},
      followed_(entries_of(scene_->spec, twin::TableKind::observation)),
      taken_(followed_),
      lane_(executor, "calibration", Priority::idle) {}

Calibrations::~Calibrations() {
    close();
}

void Calibrations::close() {
    {
        const std::lock_guard lock(mutex_);
        closed_ = true;
        *calibration_.stop = true;
    }
    lane_.close();
}

json Calibrations::describe() const {
    const std::lock_guard lock(mutex_);
    return describe_now();
}

json Calibrations::describe_now() const {
    messages::CalibrationStatus now = status_;
    now.state = calibration_.state_name();
    now.message = calibration_.message;
    now.wall_remaining_s = calibration_.wall_remaining;
    return now;
}

void Calibrations::tell_now() {
    told_ = Clock::now();
    if (!closed_) tell_(describe_now());
}

void Calibrations::start(const json& wanted, const std::string& by, const Respond& respond) {
    auto plan = read_plan(wanted);
    if (!plan) {
        respond(error_response(400, plan.error().message));
        return;
    }
    const std::lock_guard lock(mutex_);
    if (busy_ || closed_) {
        respond(
            error_response(409, closed_ ? "the program ends" : "a calibration runs; cancel it or wait for its end"));
        return;
    }
    take_observations();
    if (status_.why_not) {
        respond(error_response(409, *status_.why_not));
        return;
    }
    busy_ = true;
    *calibration_.stop = false;  // from now on it can be cancelled
    lane_.post([this, plan = std::move(*plan), by, respond] { work(plan, by, respond); });
}

Status Calibrations::cancel() {
    const std::lock_guard lock(mutex_);
    if (!busy_) return Error{"no calibration runs"};
    if (calibration_.cancel()) tell_now();
    return {};
}

fs::path Calibrations::new_folder() const {
    if (!settings_.keep) return settings_.folder / "calibration";
    std::error_code error;
    for (int number = 1;; ++number) {
        fs::path folder = settings_.folder / fmt::format("calibration_{}", number);
        if (!fs::exists(folder, error)) return folder;
    }
}

void Calibrations::work(calibrate::CalibrationPlan plan, const std::string& by, const Respond& respond) {
    const fs::path folder = new_folder();
    Ending ending;
    try {
        const auto refuse = [&](const std::string& why) {
            {
                const std::lock_guard lock(mutex_);
                busy_ = false;
            }
            respond(error_response(400, why));
        };
        auto source = source_of_runs();
        if (!source) return refuse(source.error().message);
        source_ = std::move(*source);
        const Result<ensemble::PlannedRuns> runs = plan_calibration(plan, source_, *scene_);
        if (!runs) return refuse(runs.error().message);
        if (plan.search.fast_runs > 0) {
            auto fast = plan_fast_model(plan, source_, *scene_);
            if (!fast) return refuse(fast.error().message);
            plan.fast.emplace(*std::move(fast));
        }
        begin(plan, by);
        std::string names;
        for (const ensemble::Factor& factor : plan.factors) {
            names += (names.empty() ? "" : ", ") + twin::label_of(*find_live_parameter(factor.key));
        }
        std::string done = fmt::format("calibration of {} with at most {} runs", names, plan.search.runs);
        if (plan.fast) done += fmt::format(" and {} of the depth-averaged model", plan.search.fast_runs);
        respond(json_response(200, messages::Done{.done = done, .created = {}}));
        ending = calibrate_in(folder, plan, *runs);
    } catch (const std::exception& error) {  // running out of memory here must not end the live run
        ending = {State::failed, fmt::format("the calibration ended unexpectedly: {}", error.what())};
    }
    std::error_code ignored;
    if (!settings_.keep) fs::remove_all(folder, ignored);
    end(ending);
}

Calibrations::Ending Calibrations::calibrate_in(const fs::path& path, const calibrate::CalibrationPlan& plan,
                                                const ensemble::PlannedRuns& runs) {
    const auto folder = ensemble::EnsembleFolder::open(
        path, calibration_definition("calibration", plan, runs, source_, *scene_, observed_, settings_.scene_name));
    if (!folder) return {State::failed, folder.error().message};
    calibrate::CalibrationOptions options;
    options.stop_requested = calibration_.stop.get();
    options.on_progress = [this](const calibrate::CalibrationProgress& now) { take_progress(now); };
    options.on_run = [this](const calibrate::CalibrationRun& run) { take_run(run); };
    options.on_fit = [this](const calibrate::Calibration& now) { take_fit(now); };
    const auto made = calibrate::calibrate(plan, runs, source_, *scene_, observed_, *folder, options);
    if (!made) return {State::failed, made.error().message};
    if (!made->fault.empty()) return {State::failed, made->fault};
    if (made->result.interrupted || *calibration_.stop) return {State::cancelled, ""};
    take_fit(*made);
    take_result(*made);
    if (!settings_.keep) return {State::done, ""};
    const Status written = write_calibration(*made, source_, settings_.own_files, path);
    return {State::done, written ? "" : written.error().message};
}

void Calibrations::begin(const calibrate::CalibrationPlan& plan, const std::string& by) {
    const std::lock_guard lock(mutex_);
    status_.parameters.clear();
    status_.parameters.reserve(plan.factors.size());
    for (const ensemble::Factor& factor : plan.factors) {
        const params::Parameter& parameter = *find_live_parameter(factor.key);
        status_.parameters.push_back({.key = factor.key,
                                      .label = twin::label_of(parameter),
                                      .unit = parameter.unit,
                                      .low = factor.distribution.low,
                                      .high = factor.distribution.high});
    }
    calibration_.state = State::running;
    calibration_.message.clear();
    calibration_.wall_remaining.reset();
    status_.by = by;
    status_.observations = listed(observed_);
    status_.phase = search_phase_name(calibrate::SearchPhase::design);
    status_.runs_at_most = plan.search.runs;
    status_.runs_failed = 0;
    status_.fast_runs.clear();
    status_.fast_runs_at_most = plan.search.fast_runs;
    status_.runs.clear();
    status_.map.reset();
    status_.best.reset();
    status_.result.reset();
    tell_now();
}

void Calibrations::take_run(const calibrate::CalibrationRun& run) {
    const std::lock_guard lock(mutex_);
    messages::CalibrationRun made{.values = run.values, .phase = search_phase_name(run.phase), .misfit = run.misfit};
    if (run.fast) {
        status_.fast_runs.push_back(std::move(made));
        return tell_now();
    }
    if (!std::isfinite(run.misfit)) {
        ++status_.runs_failed.value;
    } else if (!status_.best || run.misfit < status_.best->misfit) {
        status_.best = {.run = run.run, .values = run.values, .misfit = run.misfit};
    }
    status_.runs.push_back(std::move(made));
    tell_now();
}

void Calibrations::take_progress(const calibrate::CalibrationProgress& now) {
    const std::lock_guard lock(mutex_);
    status_.phase = search_phase_name(now.phase);
    calibration_.wall_remaining = std::isfinite(now.wall_remaining) ? std::optional(now.wall_remaining) : std::nullopt;
    if (Clock::now() - told_ >= tell_every) tell_now();
}

void Calibrations::take_fit(const calibrate::Calibration& now) {
    if (!now.result.best) return;
    const calibrate::MisfitMap map = misfit_map(now);
    std::vector<double> misfit(map.misfit.size());
    std::transform(map.misfit.begin(), map.misfit.end(), misfit.begin(), rounded);
    const std::vector<double>& predicted = now.result.runs[*now.result.best].predicted;
    const std::lock_guard lock(mutex_);
    status_.map = {.columns = map.cells, .rows = map.misfit.size() / map.cells, .misfit = std::move(misfit)};
    for (std::size_t j = 0; j < observed_.size() && j < predicted.size(); ++j) {
        const double value = std::isfinite(predicted[j]) ? predicted[j] : observed_[j].unreached;
        status_.observations[j].best = predicted[j];
        status_.observations[j].deviation = deviation_of(observed_[j], value);
    }
    tell_now();
}

void Calibrations::take_result(const calibrate::Calibration& made) {
    const calibrate::CalibrationSummary summary = summarise(made);
    std::vector<messages::FoundParameter> parameters;
    parameters.reserve(summary.factors.size());
    for (std::size_t k = 0; k < summary.factors.size(); ++k) {
        const calibrate::FactorResult& f = summary.factors[k];
        parameters.push_back({.key = made.factors[k].key,
                              .best = f.best,
                              .median = f.median,
                              .low_95 = f.low,
                              .high_95 = f.high,
                              .share_of_prior_width = f.kept});
    }
    const std::lock_guard lock(mutex_);
    status_.result = {.settled = made.result.settled,
                      .checks_within_95 = summary.checks_within,
                      .parameters = std::move(parameters),
                      .warnings = summary.warnings};
}

void Calibrations::end(const Ending& ending) {
    const std::lock_guard lock(mutex_);
    calibration_.end(ending.state, ending.message);
    status_.phase.reset();
    busy_ = false;
    if (!closed_) take_observations();  // what was followed meanwhile
    tell_now();
}

}  // namespace talus::serve
