#pragma once

#include <string>
#include <vector>

#include "run/run_result.hpp"
#include "run/variants.hpp"
#include "scene/scene.hpp"

/// Changes of a scene's results by its variants, in percent of its run as given (the base).
namespace talus::run {

/// A number by which runs are compared.
struct Quantity {
    std::string key;           ///< "front_velocity_at_121_m"
    std::string suffix;        ///< unit in names of columns: "mps"
    std::string name;          ///< "front velocity at 121 m"
    std::string unit;          ///< "m/s"
    double limit_percent = 5;  ///< change under refinement above which a scene is not converged
    double base = observe::never;
    std::string not_measured = {};  ///< why the base gives no value; empty where it does
};

enum class Verdict {
    pass,          ///< changes by no more than the limit
    fail,          ///< changes by more, or only one of the two runs gives a value
    not_measured,  ///< neither run gives a value
    missing,       ///< the variant did not run to its end
};

/// "pass", "fail", "not measured", "missing".
[[nodiscard]] const char* verdict_name(Verdict verdict);

/// One quantity of one variant.
struct Change {
    double value = observe::never;
    double percent = observe::never;  ///< of the base's value; NaN: one of the two is unknown, or the base's is zero
    Verdict verdict = Verdict::missing;
};

enum class ComparisonKind {
    convergence,  ///< numerics refined: every change should stay within the limit
    sensitivity,  ///< inputs varied: changes are reported, not judged
};

enum class Answer { yes, no, unknown };

struct Comparison {
    struct Row {
        VariantRun run;
        std::vector<Change> changes;            ///< as in quantities
        [[nodiscard]] Verdict verdict() const;  ///< the worst of its changes
    };

    ComparisonKind kind = ComparisonKind::convergence;
    std::vector<Quantity> quantities;
    std::vector<Row> rows;

    [[nodiscard]] bool all_ran() const;
    /// Whether every refinement ran and changed nothing by more than its limit; unknown where a run is missing or
    /// nothing could be measured, unless a change already exceeds its limit.
    [[nodiscard]] Answer converged() const;
    /// The same as a sentence: "not converged: 2 of 12 changes above their limits, the largest run-out, 12 %". For
    /// sensitivity: how many variants ran.
    [[nodiscard]] std::string verdict_text() const;
};

/// Compares front velocity at every observation, arrival, run-out, area and depth of the deposit; of a sensitivity also
/// peak depth, speed and dynamic pressure; of a convergence also which buildings are hit, and force and pressure on
/// each. Arrival is the first hit of any building if the base hits one, else when the front passed 90 % of the chainage
/// that it reached in the base. A building counts as hit if its force reaches `counting_force_share` of the largest in
/// the run: a touch is not a hit.
[[nodiscard]] Comparison compare(ComparisonKind kind, const scene::Scene& scene, const RunResult& base,
                                 std::vector<VariantRun> runs);
inline constexpr double counting_force_share = 0.05;

}  // namespace talus::run
