#include "bench/measure.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include "core/try.hpp"
#include "run/run.hpp"
#include "sim/backend_choice.hpp"

namespace talus::bench {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Bytes that the program has allocated; 0 where the system does not report it.
double allocated_bytes() {
#if defined(__GLIBC__) && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 33)
    const struct mallinfo2 info = mallinfo2();
    return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
#else
    return 0;
#endif
}

/// The start with the task's solver. All requested steps are measured, even if debris comes to rest.
run::RunStart start_of(const Start& start, const Task& task) {
    run::RunStart changed = start;
    params::SolverSpec& solver = changed.model.solver;
    solver.internal_friction = task.method;
    solver.iteration_count = task.iterations;
    solver.thread_count = task.threads;
    solver.backend = task.backend;
    changed.endless = true;
    return changed;
}

/// Returns the iterations that the steps took.
Result<int> take_steps(run::Run& run, int steps, const std::atomic<bool>* stop_requested) {
    int iterations = 0;
    for (int i = 0; i < steps; ++i) {
        if (stop_requested && stop_requested->load()) return Error{"stopped by the user"};
        if (!run.advance()) return Error{run.stop_reason()};
        iterations += run.summary().iterations;
    }
    return iterations;
}

/// Times of the repeats, each with the calibration before and after it.
struct Repeats {
    std::vector<double> step_seconds, iterations, calibration_rate, relative_rate;
    std::array<std::vector<double>, sim::stage_count> stage_seconds;
};

Status run_repeats(run::Run& run, Row& row, Calibration& calibration, const std::atomic<bool>* stop_requested) {
    const sim::Simulation& simulation = run.simulation();
    Repeats repeats;
    const double start_time = simulation.summary().time;
    (void)calibration.measure();  // wakes the threads
    double rate_before = calibration.measure();
    for (int repeat = 0; repeat < row.repeats; ++repeat) {
        const sim::StageTimes before = simulation.stage_times();
        const Clock::time_point start = Clock::now();
        TALUS_ASSIGN(const int iterations, take_steps(run, row.steps, stop_requested));
        const double step_seconds = seconds_since(start) / row.steps;
        const double rate_after = calibration.measure();
        const double rate = (rate_before + rate_after) / 2;
        rate_before = rate_after;
        repeats.step_seconds.push_back(step_seconds);
        repeats.calibration_rate.push_back(rate);
        repeats.iterations.push_back(static_cast<double>(iterations) / row.steps);
        repeats.relative_rate.push_back(row.particles * repeats.iterations.back() / step_seconds / rate);
        for (std::size_t stage = 0; stage < sim::stage_count; ++stage) {
            const double spent = simulation.stage_times().seconds[stage] - before.seconds[stage];
            repeats.stage_seconds[stage].push_back(spent / row.steps);
        }
    }
    row.step_seconds = median(repeats.step_seconds);
    row.mean_iterations = median(repeats.iterations);
    row.calibration_rate = median(repeats.calibration_rate);
    row.relative_rate = median(repeats.relative_rate);
    for (std::size_t stage = 0; stage < sim::stage_count; ++stage) {
        row.stage_seconds[stage] = median(repeats.stage_seconds[stage]);
    }
    row.time_step = (simulation.summary().time - start_time) / (row.steps * row.repeats);
    return {};
}

Result<Row> measure_in_arena(const Start& start, const Task& task, Calibration& calibration,
                             const std::atomic<bool>* stop_requested) {
    Row row;
    row.scene = start.scene;
    row.method = method_name(task.method);
    row.particles = start.state.count;
    row.iterations = task.iterations;
    row.threads = task.threads;
    row.repeats = task.length.repeats;
    row.steps = task.length.steps.value_or(usual_steps(row.particles));
    row.warm_up = task.length.warm_up.value_or(usual_warm_up(row.particles));
    row.fixed_time_step = start.model.solver.time_step.has_value();

    const double bytes_before = allocated_bytes();
    run::Run run(start_of(start, task));
    const Result<int> warmed_up = take_steps(run, row.warm_up, stop_requested);
    const auto device_bytes = static_cast<double>(run.simulation().device_bytes());
    row.bytes_per_particle = (device_bytes > 0 ? device_bytes : std::max(0.0, allocated_bytes() - bytes_before)) /
                             std::max(1U, row.particles);
    const Status status = !warmed_up ? warmed_up.error() : run_repeats(run, row, calibration, stop_requested);
    if (!status) {
        return Error{fmt::format("scene {}, method {}, {} particles: {}", row.scene, row.method, row.particles,
                                 status.error().message)};
    }
    row.backend = sim::backend_name(run.simulation().backend());
    row.instruction_set = run.simulation().instruction_set();
    row.neighbours = run.simulation().mean_neighbours();
    row.hash = hash_state(run.state());
    return row;
}

}  // namespace

std::string_view method_name(params::InternalFriction method) {
    return method == params::InternalFriction::pair ? "pair" : "stress";
}

const std::vector<std::string>& method_names() {
    static const std::vector<std::string> names = {"stress", "pair"};
    return names;
}

params::InternalFriction method_of(std::string_view name) {
    return name == "pair" ? params::InternalFriction::pair : params::InternalFriction::stress;
}

int usual_steps(std::uint32_t particles) {
    return std::clamp(static_cast<int>(400000 / std::max(1U, particles)), 2, 10);
}

int usual_warm_up(std::uint32_t particles) {
    return std::clamp(static_cast<int>(300000 / std::max(1U, particles)), 3, 10);
}

Result<Row> measure(const Start& start, const Task& task, Calibration& calibration,
                    const std::atomic<bool>* stop_requested) {
    return run::Threads(task.threads).execute([&] {
        return measure_in_arena(start, task, calibration, stop_requested);
    });
}

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    const std::size_t middle = values.size() / 2;
    return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

}  // namespace talus::bench
