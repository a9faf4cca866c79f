#pragma once

#include <filesystem>
#include <string>

#include "calibrate/calibration.hpp"
#include "calibrate/recovery.hpp"

/// Output of `talus calibrate`, as text or as one line of JSON.
namespace talus {

[[nodiscard]] std::string calibration_text(const Calibration& calibration, const std::filesystem::path& folder);
[[nodiscard]] std::string calibration_line(const Calibration& calibration, const std::filesystem::path& folder);
[[nodiscard]] std::string progress_text(const CalibrationProgress& progress);
[[nodiscard]] std::string progress_json(const CalibrationProgress& progress);
[[nodiscard]] std::string recovery_text(const Recovery& recovery, const std::filesystem::path& folder);
[[nodiscard]] std::string recovery_json(const Recovery& recovery);

}  // namespace talus
