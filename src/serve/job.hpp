#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "calibrate/calibration.hpp"
#include "core/result.hpp"
#include "design/design.hpp"
#include "ensemble/plan.hpp"
#include "serve/long_task.hpp"

/// A job of the start page: an ensemble, a calibration, a validation, risk, options or the design of a barrier that a
/// command of the program computes.
namespace talus::serve {

enum class JobKind { ensemble, calibration, validation, risk, options, design };

/// Counts what is at risk, or compares options.
[[nodiscard]] bool is_risk(JobKind kind);
[[nodiscard]] const char* job_kind_name(JobKind kind);

/// What one request can ask for.
struct JobLimits {
    static constexpr std::size_t runs = 2000, ensemble_factors = 8, calibration_factors = 6;
};

/// An entry of a list of factors in a request: an object with key, low and high, uniform between them. `list`: the name
/// of the list, for errors; `check_key`: which keys it takes, all of them texts.
[[nodiscard]] Result<ensemble::Factor> read_factor(const nlohmann::json& entry, const char* list,
                                                   const std::function<Status(const nlohmann::json& key)>& check_key);

/// What the body of `POST /api/jobs` asks for.
struct WantedJob {
    JobKind kind = JobKind::ensemble;
    std::string scene;                 ///< its id; empty: a validation
    std::vector<std::string> factors;  ///< as of the option --vary
    ensemble::EnsemblePlan ensemble;
    calibrate::CalibrationPlan calibration;
    design::DesignRequest design;    ///< but for its plan, which is `ensemble`, and its scene
    bool quick = false;              ///< a validation: the quick cases only
    std::vector<std::string> cases;  ///< likewise: these; empty: all
};

/// Errors name key, value and what is allowed; whether a factor suits the scene is not known here.
[[nodiscard]] Result<WantedJob> read_wanted_job(const nlohmann::json& body);

/// The command that computes it into `folder`, without the program's name. `scene`: empty for the built-in one.
[[nodiscard]] std::vector<std::string> arguments_of(const WantedJob& wanted, const std::filesystem::path& scene,
                                                    const std::filesystem::path& folder);

struct Job : LongTask {
    Job() { state = State::waiting; }

    std::string id;  ///< also the name of its folder: "ensemble-3"
    JobKind kind = JobKind::ensemble;
    std::string title;                   ///< of its scene; of a validation which cases
    std::string scene;                   ///< id of its scene; empty: a validation
    std::vector<std::string> arguments;  ///< as arguments_of()
    std::string begun_at, ended_at;      ///< UTC; empty: not yet
    long process = 0;                    ///< of the program that has it
    // Runs, or cases of a validation.
    std::size_t done = 0, failed = 0, count = 0;
};

/// As a line for a shell.
[[nodiscard]] std::string command_text(const std::vector<std::string>& arguments);
/// Takes an object that the command printed on its way.
void take_progress(Job& job, const nlohmann::json& event);
/// Name of the page in its folder that shows the result.
[[nodiscard]] const char* report_of(JobKind kind);

[[nodiscard]] std::string job_text(const Job& job);
/// Error: not as job_text() writes it.
[[nodiscard]] Result<Job> read_job(const std::string& text);

}  // namespace talus::serve
