#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "observe/observer.hpp"
#include "run/comparison.hpp"
#include "run/run.hpp"
#include "run/run_scene.hpp"
#include "scene/particle_spacing.hpp"
#include "scene/scene_folder.hpp"
#include "sim/backend_choice.hpp"
#include "sim/simulation.hpp"
#include "sim/sources/seed.hpp"
#include "sim/step_watcher.hpp"

namespace talus::run {
namespace {

class WholeRun : public scene::SceneFolder {
  protected:
    [[nodiscard]] scene::Scene on(const std::string& backend) const {
        write_valley("[solver]\ntarget_particle_count = 1500\nend_time_s = 8\n");
        return loaded({"solver.backend=" + backend});
    }
};

TEST_F(WholeRun, on_a_device_is_within_the_limits_of_convergence_of_the_processor) {
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

/// Watches as an observer that knows nothing of devices: by the arrays of the state.
class OnCopies : public sim::StepWatcher {
  public:
    explicit OnCopies(observe::Observer& observer) : observer_(observer) {}
    void observe(const sim::Model& model, const sim::Ground& ground, const sim::State& state) override {
        observer_.observe(model, ground, state);
    }
    void follow_inflow(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
                       std::uint32_t first_new_id) override {
        observer_.follow_inflow(model, ground, state, first_new_id);
    }
    [[nodiscard]] const std::vector<std::size_t>& failed_buildings() const override {
        return observer_.failed_buildings();
    }

  private:
    observe::Observer& observer_;
};

/// A simulation on the device of the loops, and its observer.
struct Watched {
    sim::Simulation simulation;
    observe::Observer observer;

    explicit Watched(const scene::Scene& scene)
        : simulation(simulation_of(scene)),
          observer(simulation.model(), simulation.ground(), simulation.state(), scene.flow_path, scene.spec.outputs,
                   2) {
        observer.watch(scene.gauges);
    }
    [[nodiscard]] observe::Observation finish() const {
        return observer.finish(simulation.model(), simulation.ground(), simulation.state());
    }

    /// As a user who drags all debris down the valley.
    void shift() {
        simulation.change([](sim::Model&, sim::Ground&, sim::State& state) {
            for (std::uint32_t i = 0; i < state.count; ++i) {
                state.position.set(i, state.position.at(i) + LocalPoint{40, 0, -20});
            }
        });
        observer.follow(simulation.model(), simulation.ground(), simulation.state(), simulation.state().seeded);
    }

    static sim::Simulation simulation_of(const scene::Scene& scene) {
        sim::Model model =
            sim::make_model(scene.spec.material, scene.spec.solver, scene::particle_spacing(scene), scene.cover);
        sim::Ground ground(scene.terrain, scene.buildings, model.support_radius, scene.bed);
        Result<sim::State> state = seed_releases(model, ground, scene.releases);
        sim::InflowFeeder inflow(model, ground.terrain.frame(), scene.inflows);
        return {std::move(model), std::move(ground), *std::move(state), std::move(inflow)};
    }
};

std::string bits_of(const std::vector<float>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}
std::string bits_of(std::initializer_list<double> values) {
    return {reinterpret_cast<const char*>(values.begin()), values.size() * sizeof(double)};
}

void expect_same_maps(const HazardMaps& a, const HazardMaps& b) {
    EXPECT_EQ(a.peak_depth.geometry, b.peak_depth.geometry);
    const auto same = [](const Grid<float>& x, const Grid<float>& y) { return bits_of(x.values) == bits_of(y.values); };
    EXPECT_TRUE(same(a.peak_depth, b.peak_depth));
    EXPECT_TRUE(same(a.peak_speed, b.peak_speed));
    EXPECT_TRUE(same(a.peak_pressure, b.peak_pressure));
    EXPECT_TRUE(same(a.arrival_time, b.arrival_time));
    EXPECT_TRUE(same(a.arrival_speed, b.arrival_speed));
    EXPECT_TRUE(same(a.deposit_depth, b.deposit_depth));
}

std::string bits_of(const observe::BuildingImpact& i) {
    std::string bits =
        bits_of({i.first_hit_time, i.peak_force, i.peak_impact_pressure, i.peak_depth, i.peak_dynamic_pressure,
                 i.peak_speed, i.impulse, i.failure_time, i.overtopped_volume, i.first_overtopping_time,
                 i.passed_volume, i.retained_volume, i.peak_retained_volume, i.peak_filling_height});
    for (const observe::StructureSample& s : i.history) {
        bits += bits_of({s.time, s.force, s.impact_pressure, s.depth, s.dynamic_pressure, s.impulse,
                         s.overtopped_volume, s.passed_volume, s.retained_volume, s.filling_height});
    }
    return bits;
}

/// All but the energies, which are sums of floating-point numbers.
std::string bits_of(const observe::TimeSample& s) {
    return bits_of({s.time, s.volume_released, s.front_chainage, s.volume_held, s.volume_moving, s.volume_deposited,
                    s.volume_left, s.largest_speed, s.mean_compression});
}

/// What of a scene the observers look at: a net in the valley, a dam above it that breaks, a gauge, debris that waits.
const char* const watched_scene =
    "[solver]\nbackend = \"host\"\ntarget_particle_count = 800\n[outputs]\nsample_interval_s = 0.3\n"
    "[[release]]\nname = \"later\"\nfile = \"later.geojson\"\nthickness_m = 1\nstart_time_s = 2\n"
    "[[barrier]]\nname = \"net\"\nline_m = [[824060, 825085], [824060, 825115]]\nheight_m = 2\npassing_share = 0.5\n"
    "[[barrier]]\nname = \"dam\"\nline_m = [[824054, 825080], [824054, 825120]]\nheight_m = 1.5\n"
    "resistance_Npm = 1000\n"
    "[[gauge]]\nname = \"bridge\"\nx_m = 824064\ny_m = 825100\n";

TEST_F(WholeRun, on_a_device_observers_measure_what_they_measure_on_copies) {
    const std::string inflow = "[[inflow]]\nline_m = [[824045, 825095], [824045, 825105]]\nhydrograph = \"flow.csv\"\n";
    write_features("later.geojson", {rectangle(45, 108, 52, 118)});
    for (const bool own_densities : {false, true}) {
        write("flow.csv", own_densities ? "time_s,discharge_m3ps,velocity_mps,density_kgpm3\n0,40,4,1800\n4,40,4,2300\n"
                                        : "time_s,discharge_m3ps,velocity_mps\n0,40,4\n4,40,4\n");
        write_valley(watched_scene + inflow);
        const scene::Scene scene = loaded();
        Watched device(scene), copies(scene);
        OnCopies on_copies(copies.observer);
        const auto advance_to = [&](double time) {
            while (device.simulation.summary().time < time) {
                ASSERT_TRUE(device.simulation.advance(&device.observer));
                ASSERT_TRUE(copies.simulation.advance(&on_copies));
            }
        };
        advance_to(6);
        device.shift();
        copies.shift();
        advance_to(6.1);
        ASSERT_EQ(hash_state(device.simulation.state()), hash_state(copies.simulation.state()));

        const auto a = device.observer.maps().present(), b = copies.observer.maps().present();
        EXPECT_EQ(a.first_column, b.first_column);
        EXPECT_EQ(a.depth.geometry, b.depth.geometry);
        EXPECT_EQ(bits_of(a.depth.values), bits_of(b.depth.values));
        EXPECT_EQ(bits_of(a.speed.values), bits_of(b.speed.values));
        EXPECT_EQ(bits_of(a.density.values), bits_of(b.density.values));
        EXPECT_EQ(a.density.values.empty(), !own_densities);
        EXPECT_EQ(device.observer.maps().volume(), copies.observer.maps().volume());

        const observe::Observation on_device = device.finish(), on_copy = copies.finish();
        expect_same_maps(on_device.maps, on_copy.maps);
        ASSERT_EQ(on_device.front.size(), on_copy.front.size());
        EXPECT_GT(on_device.front.size(), 10U);
        for (std::size_t k = 0; k < on_copy.front.size(); ++k) {
            const observe::FrontSample &x = on_device.front[k], &y = on_copy.front[k];
            EXPECT_EQ(bits_of({x.chainage, x.arrival_time, x.front_velocity, x.particle_speed}),
                      bits_of({y.chainage, y.arrival_time, y.front_velocity, y.particle_speed}));
        }
        ASSERT_EQ(on_device.timeseries.size(), on_copy.timeseries.size());
        for (std::size_t k = 0; k < on_copy.timeseries.size(); ++k) {
            const observe::TimeSample &x = on_device.timeseries[k], &y = on_copy.timeseries[k];
            EXPECT_EQ(bits_of(x), bits_of(y)) << k;
            // Doubles, added in another order: 1e-15 of the sum for each of the some ten levels of the tree.
            EXPECT_NEAR(x.kinetic_energy, y.kinetic_energy, 1e-13 * y.kinetic_energy);
            EXPECT_NEAR(x.potential_energy, y.potential_energy, 1e-13 * y.potential_energy);
        }
        for (std::size_t b_index = 0; b_index < 2; ++b_index) {
            EXPECT_EQ(bits_of(on_device.buildings[b_index]), bits_of(on_copy.buildings[b_index])) << b_index;
        }
        const observe::BuildingImpact &net = on_copy.buildings[0], &dam = on_copy.buildings[1];
        EXPECT_GT(net.passed_volume, 0);
        EXPECT_GT(net.overtopped_volume, 0);
        EXPECT_GT(net.peak_retained_volume, 0);
        EXPECT_GT(dam.peak_dynamic_pressure, 0);
        EXPECT_FALSE(std::isnan(dam.failure_time)) << "it never failed";
        ASSERT_EQ(on_device.gauges.size(), 1U);
        const observe::GaugeRecord &x = on_device.gauges[0], &y = on_copy.gauges[0];
        EXPECT_EQ(bits_of({x.arrival_time, x.peak_depth, x.peak_depth_time, x.peak_speed, x.peak_speed_time}),
                  bits_of({y.arrival_time, y.peak_depth, y.peak_depth_time, y.peak_speed, y.peak_speed_time}));
        EXPECT_GT(y.peak_speed, 0);
    }
}

TEST_F(WholeRun, on_a_device_observers_give_the_same_bits_on_any_number_of_threads) {
    write_features("later.geojson", {rectangle(45, 108, 52, 118)});
    write_valley(watched_scene);
    const auto on = [&](const char* threads) {
        return test::value_of(run_scene(loaded({threads, "solver.end_time_s=3"}), {})).observation;
    };
    const observe::Observation one = on("solver.thread_count=1"), four = on("solver.thread_count=4");
    expect_same_maps(one.maps, four.maps);
    EXPECT_EQ(bits_of(one.buildings[0]), bits_of(four.buildings[0]));
    for (std::size_t k = 0; k < one.timeseries.size(); ++k) {
        EXPECT_EQ(bits_of(one.timeseries[k]), bits_of(four.timeseries[k]));
        EXPECT_EQ(one.timeseries[k].kinetic_energy, four.timeseries[k].kinetic_energy);
    }
}

TEST_F(WholeRun, on_a_device_a_step_without_frames_copies_no_particles) {
    write_features("later.geojson", {rectangle(45, 108, 52, 118)});
    write_valley(watched_scene);
    const scene::Scene scene = loaded({"solver.target_particle_count=6000"});
    auto run = Run::start(scene);
    ASSERT_TRUE(run) << run.error().message;
    ASSERT_TRUE((*run)->advance());  // takes model, terrain, particles and maps over
    const sim::Simulation& simulation = (*run)->simulation();
    const auto copied = [&] {
        const sim::device::Traffic before = simulation.device_traffic();
        EXPECT_TRUE((*run)->advance());
        const sim::device::Traffic after = simulation.device_traffic();
        return sim::device::Traffic{after.to_device - before.to_device, after.to_host - before.to_host};
    };
    const std::uint32_t count = (*run)->summary().count;
    ASSERT_GT(count, 5000U);
    std::uint64_t most = 0;
    for (int step = 0; step < 30; ++step) {
        const sim::device::Traffic traffic = copied();
        EXPECT_EQ(traffic.to_device, 0U) << step;
        most = std::max(most, traffic.to_host);  // what is at the front and at walls, and sums
    }
    RecordProperty("most_bytes_in_a_step", std::to_string(most));
    EXPECT_LT(most, count * sizeof(float)) << "as much as one number of every particle";
    EXPECT_GT(most, 0U) << "nothing was counted";

    const std::uint64_t before = simulation.device_traffic().to_host;
    (void)(*run)->state();
    EXPECT_GE(simulation.device_traffic().to_host - before, 58ULL * count) << "a frame has all of them";
}

TEST_F(WholeRun, on_a_card_that_is_not_there_is_refused_in_one_line) {
    if (sim::check_backend(params::BackendChoice::cuda)) GTEST_SKIP() << "there is a card";
    const Result<RunResult> result = run_scene(on("cuda"), {});
    ASSERT_FALSE(result);
    EXPECT_THAT(result.error().message, testing::HasSubstr("backend \"cuda\" is refused; "));
    EXPECT_THAT(result.error().message, testing::Not(testing::HasSubstr("\n")));
}

}  // namespace
}  // namespace talus::run
