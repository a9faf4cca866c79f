#include <cmath>

#include <gmock/gmock.h>

#include "params/fields.hpp"
#include "run/run.hpp"
#include "scene/scene_folder.hpp"

namespace talus::run {
namespace {

using testing::HasSubstr;

class Extremes : public scene::SceneFolder {};

/// Every number of these sections, at both ends of its range: the scene is refused with the key's name, or it runs.
TEST_F(Extremes, are_refused_by_name_or_run) {
    write_valley("[material]\nturbulent_friction_mps2 = 500\nturbulent_friction_thickness_m = 1\n");
    int ran = 0;
    for (const char* name : {"release", "material", "solver", "outputs", "flow_path"}) {
        for (const params::Parameter& parameter : params::find_section(name)->parameters) {
            const bool whole = parameter.kind == params::ParameterKind::integer;
            if (!whole && parameter.kind != params::ParameterKind::number) continue;
            if (parameter.key == "thread_count") continue;  // hundreds of threads would slow down all other tests
            const params::Range& range = parameter.range;
            ASSERT_TRUE(std::isfinite(range.low) && std::isfinite(range.high)) << name << "." << parameter.key;
            const double low = range.low_included ? range.low : std::nextafter(range.low, range.high);
            const double high = range.high_included ? range.high : std::nextafter(range.high, range.low);
            for (const double value : {low, high}) {
                const std::string key = fmt::format("{}.{}", name, parameter.key);
                std::vector<std::string> overrides{"solver.target_particle_count=200"};
                if (parameter.key == "volume_m3") overrides.emplace_back("release.thickness_m=none");
                overrides.push_back(whole ? fmt::format("{}={:.0f}", key, value)
                                          : fmt::format("{}={:.17e}", key, value));
                SCOPED_TRACE(overrides.back());
                const auto scene = scene::load_scene(folder / "scene.toml", overrides);
                if (!scene) {
                    EXPECT_THAT(scene.error().message, HasSubstr(parameter.key));
                    continue;
                }
                const auto run = Run::start(*scene);
                ASSERT_TRUE(run) << run.error().message;
                for (int step = 0; step < 3; ++step) (void)(*run)->advance();
                EXPECT_TRUE((*run)->phase() == RunPhase::ended || (*run)->result().simulated_time > 0);
                ++ran;
            }
        }
    }
    EXPECT_GT(ran, 60);
}

}  // namespace
}  // namespace talus::run
