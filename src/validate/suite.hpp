#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "validate/case.hpp"

/// Runs cases and judges what they computed.
namespace talus::validate {

enum class Verdict {
    pass,
    fail,
    known_failure,  ///< a failure that the case file announces: still a failure
    shown,          ///< compared, but fails nothing
    skipped,        ///< its data are not here
};

/// A line of the validation table.
struct Row {
    std::string case_name;
    std::string quantity;  ///< with its variant
    std::string unit;      ///< "1" for a pure number
    double expected = not_computed, computed = not_computed;
    /// (computed - expected) / |expected|, or the difference where the expected value is 0. For at_most and at_least
    /// only what is beyond the bound, so that a row passes when this is within the tolerance, whatever the comparison.
    double relative_error = not_computed;
    std::optional<double> tolerance;
    Comparison comparison = Comparison::near;
    Verdict verdict = Verdict::fail;
    std::string source;
    std::string known_failure;
};

struct CaseResult {
    Case validation_case;
    std::vector<Row> rows;
    std::vector<Chart> charts;
    std::vector<std::string> notes;
    std::string skipped;   ///< why it was not run; empty: it was
    double wall_time = 0;  ///< s
};

/// "at chainage 121 m", what the entry says where its quantity is taken; `where` where it names a variant.
[[nodiscard]] std::string place_text(const Expectation& expectation);

/// Holds what was computed against what is expected: a row for every measurement that an entry speaks of, and a failing
/// one for every entry that nothing was computed for.
[[nodiscard]] std::vector<Row> judge(const Case& validation_case, const std::vector<Measurement>& measurements);

/// Runs a case on the threads that `watch` allows. Never fails: what cannot be computed is a failing row.
[[nodiscard]] CaseResult run_case(const Case& validation_case, const Watch& watch);

/// Counts over all rows.
struct Tally {
    int passed = 0, failed = 0, known_failures = 0, shown = 0, skipped = 0;
};
[[nodiscard]] Tally count(const std::vector<CaseResult>& results);

/// The validation table for a terminal.
[[nodiscard]] std::string table_text(const std::vector<CaseResult>& results);

/// The same as JSON: a list of objects with case, quantity, expected, computed, relative_error, tolerance, pass,
/// source, then unit, comparison, verdict, known_failure. Numbers that do not exist are null, and so is `pass` of a row
/// that is only shown or was skipped.
[[nodiscard]] std::string table_json(const std::vector<CaseResult>& results);

/// "pass", "FAIL", "FAIL (known)", "shown", "skipped".
[[nodiscard]] std::string verdict_text(Verdict verdict);

/// What a table's cells say.
[[nodiscard]] std::string expected_text(const Row& row);
[[nodiscard]] std::string computed_text(const Row& row);
[[nodiscard]] std::string deviation_text(const Row& row);
[[nodiscard]] std::string tolerance_text(const Row& row);

/// Names of the cases that travel inside the program.
[[nodiscard]] std::vector<std::string> builtin_case_names();

/// Writes the cases that travel inside the program, with the scenes that they run, into `folder`, and returns where the
/// case folders lie. Errors: a folder or file that cannot be made.
[[nodiscard]] Result<std::filesystem::path> unpack_builtin_cases(const std::filesystem::path& folder);

}  // namespace talus::validate
