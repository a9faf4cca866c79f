#pragma once

#include <string>
#include <vector>

#include "run/run_result.hpp"
#include "run/variants.hpp"
#include "scene/scene.hpp"

/// What variants change in the results of a scene, in percent of its run as given (the base).
namespace talus {

/// A number that runs are compared by.
struct Quantity {
    std::string key;     ///< "front_velocity_at_121_m"
    std::string suffix;  ///< unit in names of columns: "mps"
    std::string name;    ///< "front velocity at 121 m"
    std::string unit;    ///< "m/s"
    double base = never;
    std::string not_measured;  ///< why the base gives no value; empty where it does
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
    double value = never;
    double percent = never;  ///< of the base's value; NaN: one of the two is not known, or the base's is zero
    Verdict verdict = Verdict::missing;
};

enum class ComparisonKind {
    convergence,  ///< numerics refined: every change should stay within the limit
    sensitivity,  ///< inputs varied: changes are reported, not judged
};

/// Change of a result under refinement, in percent, above which a scene counts as not converged.
inline constexpr double refinement_limit_percent = 5;

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
    /// Whether every refinement ran and changed nothing by more than the limit; unknown where a run is missing or
    /// nothing could be measured, unless a change already exceeds the limit.
    [[nodiscard]] Answer converged() const;
    /// The same as a sentence: "not converged: 2 of 12 changes exceed 5 %". For sensitivity: how many variants ran.
    [[nodiscard]] std::string verdict_text() const;
};

/// Compares front velocity at every observation, arrival, and run-out. Arrival is the first hit of any building if the
/// base hits one, else when the front passed 90 % of the chainage that it reached in the base.
[[nodiscard]] Comparison compare(ComparisonKind kind, const Scene& scene, const RunResult& base,
                                 std::vector<VariantRun> runs);

}  // namespace talus
