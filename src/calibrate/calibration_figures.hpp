#pragma once

#include "calibrate/calibration_products.hpp"
#include "report/chart.hpp"

/// The charts of a calibration's report.
namespace talus::calibrate {

/// Misfit over the first two factors (over the only one: as a line) with a dot per run, beside it draws from the
/// posterior.
[[nodiscard]] report::Chart misfit_chart(const Calibration& calibration, const MisfitMap& map);

/// Prior and posterior of each factor.
[[nodiscard]] report::Chart factor_chart(const Calibration& calibration, const CalibrationSummary& summary);

/// Deviations of predictions from each observation, in standard deviations.
[[nodiscard]] report::Chart observation_chart(const Calibration& calibration, const CalibrationSummary& summary);

/// Misfit run by run, and emulator predictions of unknown runs against computed values.
[[nodiscard]] report::Chart convergence_chart(const Calibration& calibration);

}  // namespace talus::calibrate
