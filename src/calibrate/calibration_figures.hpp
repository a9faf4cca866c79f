#pragma once

#include "calibrate/calibration_products.hpp"
#include "report/chart.hpp"

/// The charts of a calibration's report.
namespace talus::report {

/// Misfit over the first two factors (over the only one: as a line) with a dot per run, beside it draws from the
/// posterior.
[[nodiscard]] Chart misfit_chart(const Calibration& calibration, const MisfitMap& map);

/// What is known of each factor before and after.
[[nodiscard]] Chart factor_chart(const Calibration& calibration, const CalibrationSummary& summary);

/// Observed and predicted, for each observation in standard deviations from what was observed.
[[nodiscard]] Chart observation_chart(const Calibration& calibration, const CalibrationSummary& summary);

/// Misfit run by run, and what emulators say of runs that they do not know against what was computed.
[[nodiscard]] Chart convergence_chart(const Calibration& calibration);

}  // namespace talus::report
