#pragma once

#include <filesystem>

#include "core/result.hpp"
#include "run/fault_record.hpp"

namespace talus::products {

/// Creates `folder` and writes fault.json and last_good_state.csv there.
[[nodiscard]] Status write_fault(const run::FaultRecord& record, const std::filesystem::path& folder);

}  // namespace talus::products
