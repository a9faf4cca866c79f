#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "run/comparison.hpp"
#include "run/run_result.hpp"

/// Whether a run can be relied on: said beside its results wherever they are shown.
namespace talus::run {

enum class CheckState { within, beyond, not_measured };

/// "within", "beyond", "not_measured".
[[nodiscard]] const char* state_name(CheckState state);

/// A number of a run against its limit.
struct Check {
    std::string_view key;   ///< "resolution"
    std::string_view name;  ///< "Resolution"
    CheckState state = CheckState::not_measured;
    double value = observe::never, limit = observe::never;
    std::string_view unit;  ///< of both; empty: a share
    std::string text;       ///< a sentence, without its full stop
};

/// Checks of a run, each once: resolution, compression, energy, what still moves at its end, and convergence.
struct RunVerdict {
    std::vector<Check> checks;

    [[nodiscard]] const Check& check(std::string_view key) const;
    [[nodiscard]] bool within_limits() const;
    /// "Within limits", "Beyond limits: resolution, still moving".
    [[nodiscard]] std::string text() const;
    /// Keys of what is beyond its limit, with a space between them; empty: nothing is.
    [[nodiscard]] std::string keys() const;
    /// The sentences of what is beyond its limit.
    [[nodiscard]] std::vector<std::string> warnings() const;
};

/// From the observations of a run of either model; convergence from its comparison with finer numerics, if one of
/// `comparisons` is that.
[[nodiscard]] RunVerdict judge(const RunResult& result, const std::vector<Comparison>& comparisons = {});

/// Share of the debris that may still move at the end.
inline constexpr double still_moving_limit = 0.01;

/// Of several runs of a scene, by check: the worst of them, and in how many it is beyond its limit.
[[nodiscard]] RunVerdict judge_together(const std::vector<RunVerdict>& verdicts);

/// {"within_limits", "text", "warnings", "checks": [{"key", "name", "state", "value", "limit", "unit", "text"}]}
[[nodiscard]] nlohmann::ordered_json verdict_json(const RunVerdict& verdict);
/// The same from its "checks", as far as this program knows them. Throws what nlohmann::json does.
[[nodiscard]] RunVerdict verdict_of(const nlohmann::ordered_json& checks);

}  // namespace talus::run
