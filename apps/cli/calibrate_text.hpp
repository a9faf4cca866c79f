#pragma once

#include <filesystem>
#include <string>

#include "calibrate/calibration.hpp"
#include "calibrate/recovery.hpp"

/// What `talus calibrate` says, as text or as JSON of one line.
namespace talus {

[[nodiscard]] std::string calibration_text(const Calibration& calibration, const std::filesystem::path& folder);
[[nodiscard]] std::string calibration_line(const Calibration& calibration, const std::filesystem::path& folder);
[[nodiscard]] std::string progress_text(const CalibrationProgress& progress);
[[nodiscard]] std::string progress_json(const CalibrationProgress& progress);
[[nodiscard]] std::string recovery_text(const Recovery& recovery, const std::filesystem::path& folder);
[[nodiscard]] std::string recovery_json(const Recovery& recovery);

}  // namespace talus
