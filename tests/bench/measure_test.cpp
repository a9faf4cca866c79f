#include "bench/measure.hpp"

#include <atomic>
#include <iterator>
#include <numeric>
#include <regex>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bench/figure.hpp"
#include "bench/table.hpp"

namespace talus::bench {
namespace {

using testing::HasSubstr;

Start small_slab() {
    return *make_start("slab", 500, "");
}

Task short_task(params::InternalFriction method = params::InternalFriction::stress, int threads = 1) {
    Task task;
    task.method = method;
    task.threads = threads;
    task.length = {3, 2, 1};
    return task;
}

TEST(Measure, fills_a_row) {
    Calibration calibration;
    const Start start = small_slab();
    const Result<Row> row = measure(start, short_task(), calibration);
    ASSERT_TRUE(row) << row.error().message;
    EXPECT_EQ(row->scene, "slab");
    EXPECT_EQ(row->method, "stress");
    EXPECT_EQ(row->backend, "cpu");
    EXPECT_EQ(row->particles, start.state.count);
    EXPECT_EQ(row->iterations, 4);
    EXPECT_EQ(row->warm_up, 1);
    EXPECT_EQ(row->steps, 2);
    EXPECT_EQ(row->repeats, 3);
    EXPECT_EQ(row->instruction_set, calibration.instruction_set());
    EXPECT_GT(row->neighbours, 5);
    EXPECT_LT(row->neighbours, 60);
    EXPECT_GT(row->time_step, 0);
    EXPECT_LE(row->time_step, start.model.largest_time_step() * 1.0001);
    EXPECT_GT(row->relative_rate, 0);
    EXPECT_GT(row->stage_seconds[static_cast<std::size_t>(sim::Stage::solve_density)], 0);
}

TEST(Measure, observing_is_part_of_the_step) {
    Calibration calibration;
    Start start = small_slab();
    start.outputs.map_cell = 0.02;  // so fine that maps take a tenth of the time
    const Result<Row> row = measure(start, short_task(), calibration);
    ASSERT_TRUE(row) << row.error().message;
    // A timer around nothing takes less than a ten-thousandth, and a busy machine makes steps some times longer.
    EXPECT_GT(row->stage_seconds[static_cast<std::size_t>(sim::Stage::observe)], 2e-3 * row->step_seconds);
}

TEST(Measure, relates_the_rate_to_the_calibration_beside_it) {
    Calibration calibration;
    Task task = short_task();
    task.length.repeats = 1;  // of one, the median of quotients is the quotient of medians
    const Result<Row> row = measure(small_slab(), task, calibration);
    ASSERT_TRUE(row);
    EXPECT_DOUBLE_EQ(row->relative_rate, row->particle_iterations_per_second() / row->calibration_rate);
}

TEST(Measure, stages_make_up_the_step) {
    Calibration calibration;
    Task task = short_task();
    task.length.repeats = 1;  // medians of several need not add up
    const Result<Row> row = measure(small_slab(), task, calibration);
    ASSERT_TRUE(row);
    const double stages = std::accumulate(row->stage_seconds.begin(), row->stage_seconds.end(), 0.0);
    EXPECT_GT(stages, 0.5 * row->step_seconds);
    EXPECT_LT(stages, 1.5 * row->step_seconds);
}

TEST(Measure, hash_hangs_on_the_work_and_not_on_the_threads) {
    Calibration calibration;
    const Start start = small_slab();
    const auto hash_of = [&](const Task& task) { return measure(start, task, calibration)->hash; };
    for (const params::InternalFriction method : {params::InternalFriction::stress, params::InternalFriction::pair}) {
        const std::uint64_t hash = hash_of(short_task(method));
        EXPECT_EQ(hash, hash_of(short_task(method, 2)));
        EXPECT_EQ(hash, hash_of(short_task(method, 3)));
        Task more = short_task(method);
        more.iterations = 5;
        EXPECT_NE(hash, hash_of(more));
    }
    EXPECT_NE(hash_of(short_task(params::InternalFriction::stress)),
              hash_of(short_task(params::InternalFriction::pair)));
}

TEST(Measure, a_step_that_cannot_be_trusted_is_an_error) {
    Calibration calibration;
    Start start = small_slab();
    start.model.solver.compression_limit = -1;
    const Result<Row> row = measure(start, short_task(), calibration);
    ASSERT_FALSE(row);
    EXPECT_THAT(row.error().message, HasSubstr("scene slab, method stress"));
}

TEST(Measure, stops_when_asked) {
    Calibration calibration;
    const std::atomic<bool> stop{true};
    EXPECT_FALSE(measure(small_slab(), short_task(), calibration, &stop));
}

TEST(Measure, larger_scenes_take_fewer_steps) {
    EXPECT_GT(usual_steps(5000), usual_steps(75000));
    EXPECT_GE(usual_steps(1000000), 2);
    EXPECT_GE(usual_warm_up(1000000), 1);
}

TEST(Median, is_the_middle_one) {
    EXPECT_EQ(median({3, 1, 100}), 3);
    EXPECT_EQ(median({4, 1, 2, 100}), 3);
    EXPECT_EQ(median({}), 0);
}

TEST(Calibration, measures_and_does_its_work) {
    Calibration calibration;
    EXPECT_GT(calibration.measure(), 1e4);
    const double total = calibration.total();
    EXPECT_NE(total, 0);
    EXPECT_GT(calibration.measure(), 1e4);
    EXPECT_EQ(calibration.total(), total) << "always the same work";
}

Row sample_row() {
    Row row;
    row.scene = "slab";
    row.method = "pair";
    row.instruction_set = "AVX2";
    row.particles = 1000;
    row.iterations = 4;
    row.mean_iterations = 4;
    row.threads = 2;
    row.repeats = 7;
    row.step_seconds = 0.002;
    row.time_step = 0.01;
    row.stage_seconds[static_cast<std::size_t>(sim::Stage::solve_density)] = 0.001;
    row.relative_rate = 0.125;
    row.hash = 0xabc;
    return row;
}

TEST(Table, shows_rates_and_shares) {
    const std::string text = table_text({sample_row()});
    for (const char* part :
         {"slab", "pair", "500.0", "2.00", "AVX2", "adaptive", "0.1250", "0000000000000abc", "50.0"}) {
        EXPECT_THAT(text, HasSubstr(part));
    }
    EXPECT_THAT(table_text({}), HasSubstr("nothing"));
}

TEST(Figure, draws_a_line_per_scene_method_and_threads) {
    Row small = sample_row(), large = sample_row(), other = sample_row();
    large.particles = 4 * small.particles;
    large.step_seconds = 4 * small.step_seconds;  // the same rate
    other.method = "stress";
    const std::string svg = scaling_svg({small, large, other});
    EXPECT_THAT(svg, HasSubstr("slab, pair, 2 threads</text>"));
    EXPECT_THAT(svg, HasSubstr("slab, stress, 2 threads</text>"));
    // One line of two points at one height, and three marks.
    const std::regex level("series v0\" d=\"M[0-9.]+ [0-9.]+h[0-9.]+\"");
    EXPECT_TRUE(std::regex_search(svg, level)) << svg;
    const std::regex mark("class=\"mark v[0-9]\"");
    EXPECT_EQ(std::distance(std::sregex_iterator(svg.begin(), svg.end(), mark), std::sregex_iterator()), 3);
}

TEST(Table, json_has_what_scripts_read) {
    const auto list = nlohmann::json::parse(table_json({sample_row(), sample_row()}));
    ASSERT_EQ(list.size(), 2U);
    const auto& row = list[0];
    EXPECT_EQ(row["scene"], "slab");
    EXPECT_EQ(row["particles"], 1000);
    EXPECT_EQ(row["iterations"], 4);
    EXPECT_EQ(row["threads"], 2);
    EXPECT_EQ(row["backend"], "cpu");
    EXPECT_DOUBLE_EQ(row["steps_per_second"], 500);
    EXPECT_DOUBLE_EQ(row["particle_iterations_per_second"], 2e6);
    EXPECT_DOUBLE_EQ(row["ns_per_particle_iteration"], 500);
    EXPECT_DOUBLE_EQ(row["real_time_factor"], 5);
    EXPECT_EQ(row["stages_ms"].size(), sim::stage_count);
    EXPECT_DOUBLE_EQ(row["stages_ms"]["solve_density"], 1);
    EXPECT_EQ(row["hash"], "0000000000000abc");
    EXPECT_EQ(row["relative_rate"], 0.125);
    EXPECT_TRUE(row["bytes_per_particle"].is_null());
}

}  // namespace
}  // namespace talus::bench
