#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "run/comparison.hpp"
#include "run/run_scene.hpp"
#include "scene/scene_folder.hpp"
#include "sim/backend_choice.hpp"

namespace talus::run {
namespace {

class WholeRun : public scene::SceneFolder {
  protected:
    [[nodiscard]] scene::Scene on(const std::string& backend) const {
        write_valley("[solver]\ntarget_particle_count = 1500\nend_time_s = 8\n");
        auto scene = scene::load_scene(folder / "scene.toml", {"solver.backend=" + backend});
        if (!scene) throw std::runtime_error(scene.error().message);
        return *std::move(scene);
    }
};

TEST_F(WholeRun, OnADeviceIsWithinTheLimitsOfConvergenceOfTheProcessor) {
    const scene::Scene scene = on("cpu");
    const Result<RunResult> processor = run_scene(scene, {});
    ASSERT_TRUE(processor) << processor.error().message;
    EXPECT_EQ(processor->backend, "cpu");
    for (const char* backend : {"host", "cuda"}) {
        if (std::string(backend) == "cuda" && !sim::check_backend(params::BackendChoice::cuda)) continue;
        Result<RunResult> device = run_scene(on(backend), {});
        ASSERT_TRUE(device) << device.error().message;
        EXPECT_EQ(device->backend, backend);
        EXPECT_NE(device->hash, processor->hash) << "the same code ran twice";
        EXPECT_EQ(device->particles, processor->particles);
        std::vector<VariantRun> runs(1);
        runs[0].variant.name = backend;
        runs[0].result = *std::move(device);
        const Comparison comparison = compare(ComparisonKind::convergence, scene, *processor, std::move(runs));
        EXPECT_EQ(comparison.converged(), Answer::yes) << comparison.verdict_text();
        EXPECT_GE(comparison.quantities.size(), 3U);
    }
}

TEST_F(WholeRun, OnACardThatIsNotThereIsRefusedInOneLine) {
    if (sim::check_backend(params::BackendChoice::cuda)) GTEST_SKIP() << "there is a card";
    const Result<RunResult> result = run_scene(on("cuda"), {});
    ASSERT_FALSE(result);
    EXPECT_THAT(result.error().message, testing::HasSubstr("backend \"cuda\" is refused; "));
    EXPECT_THAT(result.error().message, testing::Not(testing::HasSubstr("\n")));
}

}  // namespace
}  // namespace talus::run
