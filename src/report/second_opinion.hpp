#pragma once

#include <string>
#include <vector>

#include "core/result.hpp"
#include "report/page.hpp"
#include "run/run_result.hpp"
#include "run/second_opinion.hpp"
#include "scene/scene.hpp"

/// The report of both models on one scene.
namespace talus::report {

/// A scene as each model loads it, and what it computed.
struct BothModels {
    const scene::Scene& scene;  ///< of the particles
    const run::RunResult& particles;
    const scene::Scene& grid_scene;  ///< of the depth-averaged model: the same but for its notes
    const run::RunResult& depth_averaged;
};

/// Where the models differ, in sentences, the most important first.
[[nodiscard]] std::vector<std::string> differences(const BothModels& models, const run::SecondOpinion& opinion);

/// results.json of `talus compare` (docs/results.md).
[[nodiscard]] Json second_opinion_results(const BothModels& models, const run::SecondOpinion& opinion);

/// Its page. Errors: a picture of a map could not be encoded.
[[nodiscard]] Result<std::string> second_opinion_report(const BothModels& models, const run::SecondOpinion& opinion,
                                                        const Json& results);

}  // namespace talus::report
