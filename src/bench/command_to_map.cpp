#include "bench/command_to_map.hpp"

#include <string>
#include <vector>

#include "bench/measure.hpp"
#include "core/phases.hpp"
#include "core/temporary_folder.hpp"
#include "core/try.hpp"
#include "products/products.hpp"
#include "run/run_scene.hpp"
#include "run/threads.hpp"
#include "scene/scene.hpp"

namespace talus::bench {

Result<CommandToMap> measure_command_to_map(const std::filesystem::path& builtin_scene, int repeats,
                                            Calibration& calibration) {
    const std::vector<std::string> settings = {"solver.model=depth_averaged", "solver.grid_cell_m=2.5",
                                               "solver.thread_count=1"};
    return run::Threads(1).execute([&]() -> Result<CommandToMap> {
        std::vector<double> seconds, relative_rates, steps_rates;
        (void)calibration.measure();  // wakes the thread
        for (int repeat = 0; repeat < repeats; ++repeat) {
            const double rate_before = calibration.measure();
            const TemporaryFolder folder;
            const StopWatch watch;
            TALUS_ASSIGN(const scene::Scene scene, scene::load_scene(builtin_scene, settings));
            TALUS_ASSIGN(const run::RunResult result, run::run_scene(scene, {}));
            if (result.fault) return Error{result.fault->sentence};
            TALUS_TRY(products::write_products(scene, result, folder.path()));
            seconds.push_back(watch.seconds() - result.step_time());
            const double rate = (rate_before + calibration.measure()) / 2;
            relative_rates.push_back(1e9 / (seconds.back() * rate));
            steps_rates.push_back(static_cast<double>(result.cell_updates) / (result.step_time() * rate));
        }
        return CommandToMap{median(seconds), median(relative_rates), median(steps_rates)};
    });
}

}  // namespace talus::bench
