#pragma once

#include <string>

#include "calibrate/calibration_products.hpp"

/// The figures of a calibration's report, as HTML.
namespace talus::report {

/// Misfit over the first two factors (over the only one: as a line) with a dot per run, beside it draws from the
/// posterior.
[[nodiscard]] std::string misfit_figure(const Calibration& calibration, const MisfitMap& map, int number);

/// The same as a picture of its own.
[[nodiscard]] std::string misfit_picture(const Calibration& calibration, const MisfitMap& map);

/// What is known of each factor before and after.
[[nodiscard]] std::string factor_figure(const Calibration& calibration, const CalibrationSummary& summary, int number);

/// Observed and predicted, for each observation in standard deviations from what was observed.
[[nodiscard]] std::string observation_figure(const Calibration& calibration, const CalibrationSummary& summary,
                                             int number);

/// Misfit run by run, and what emulators say of runs that they do not know against what was computed.
[[nodiscard]] std::string convergence_figure(const Calibration& calibration, int number);

}  // namespace talus::report
