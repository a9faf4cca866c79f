#pragma once

#include <string>

#include "core/result.hpp"
#include "report/page.hpp"
#include "run/run_result.hpp"
#include "scene/scene.hpp"

namespace talus::report {

/// The self-contained report of `results`, from run_results(), with maps of the run. Errors: a picture of a map could
/// not be encoded.
[[nodiscard]] Result<std::string> run_report(const scene::Scene& scene, const run::RunResult& result,
                                             const Json& results);

}  // namespace talus::report
