#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "validate/case.hpp"

/// Runs cases and judges their results.
namespace talus::validate {

enum class Verdict {
    pass,
    fail,
    known_failure,  ///< a failure announced in the case file: still a failure
    shown,          ///< compared, but fails nothing
    skipped,        ///< its data are missing
};

/// A line of the validation table.
struct Row {
    std::string case_name;
    std::string quantity;  ///< with its variant
    std::string unit;      ///< "1" for a pure number
    double expected = not_computed, computed = not_computed;
    /// (computed - expected) / |expected|, or the difference where the expected value is 0. For at_most and at_least
    /// only the part beyond the bound, so that a row passes when this is within the tolerance, whatever the comparison.
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

/// "at chainage 121 m", the entry's place of the quantity; `where` where it names a variant.
[[nodiscard]] std::string place_text(const Expectation& expectation);

/// Compares computed with expected values: a row for every measurement with an entry, and a failing one for every entry
/// without a computed value.
[[nodiscard]] std::vector<Row> judge(const Case& validation_case, const std::vector<Measurement>& measurements);

/// Runs a case on the threads that `watch` allows. Never fails: a value that cannot be computed is a failing row.
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

/// The texts of a table's cells.
[[nodiscard]] std::string expected_text(const Row& row);
[[nodiscard]] std::string computed_text(const Row& row);
[[nodiscard]] std::string deviation_text(const Row& row);
[[nodiscard]] std::string tolerance_text(const Row& row);

/// Names of the built-in cases.
[[nodiscard]] std::vector<std::string> builtin_case_names();

/// Writes the built-in cases, with the scenes that they run, into `folder`, and returns the folder of the case folders.
/// Errors: a folder or file that cannot be created.
[[nodiscard]] Result<std::filesystem::path> unpack_builtin_cases(const std::filesystem::path& folder);

}  // namespace talus::validate
