#pragma once

#include <string>

#include "report/table.hpp"
#include "risk/criteria.hpp"
#include "risk/risk_products.hpp"

/// The tables of the report, as data. Null where there is nothing to tell.
namespace talus::risk {

/// Risk is small: "1.3 × 10⁻⁵"; above a thousandth and below a million as usual.
[[nodiscard]] std::string small(double value);
/// Impact as people ask for it: the probability in a year; per event it is a probability already.
[[nodiscard]] stats::Estimate impact_of(const StudyResult& result, const ItemRisk& item);
/// nullptr: none is wanted, or nothing is known of deaths in a year.
[[nodiscard]] const Criteria* criteria_for(const StudyResult& result);

/// All that is exposed together, a row per option.
[[nodiscard]] report::Json totals_table(const StudyResult& result);
/// Each option less the ground as it is.
[[nodiscard]] report::Json differences_table(const StudyResult& result);
/// Cost of a year against what it averts.
[[nodiscard]] report::Json costs_table(const StudyResult& result);
/// What is exposed, of the ground as it is: the worst first.
[[nodiscard]] report::Json items_table(const StudyResult& result);
/// Impact and individual risk of each item, side by side for all options.
[[nodiscard]] report::Json side_by_side(const StudyResult& result);
[[nodiscard]] report::Json scenarios_table(const StudyResult& result);
[[nodiscard]] report::Json factors_table(const StudyResult& result);
/// The curves that the scene uses, with what was checked of them.
[[nodiscard]] report::Json curves_table(const StudyResult& result);

}  // namespace talus::risk
