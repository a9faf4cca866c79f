#pragma once

#include <filesystem>
#include <string>

#include "calibrate/calibration.hpp"
#include "calibrate/recovery.hpp"

/// Output of `talus calibrate`, as text or as one line of JSON.
namespace talus::cli {

[[nodiscard]] std::string calibration_text(const calibrate::Calibration& calibration,
                                           const std::filesystem::path& folder);
[[nodiscard]] std::string calibration_line(const calibrate::Calibration& calibration,
                                           const std::filesystem::path& folder);
[[nodiscard]] std::string progress_text(const calibrate::CalibrationProgress& progress);
[[nodiscard]] std::string progress_json(const calibrate::CalibrationProgress& progress);
[[nodiscard]] std::string recovery_text(const calibrate::Recovery& recovery, const std::filesystem::path& folder);
[[nodiscard]] std::string recovery_json(const calibrate::Recovery& recovery);

}  // namespace talus::cli
