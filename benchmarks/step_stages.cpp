// The stages that are compiled per instruction set, one after the other, on one thread: nearly all of a step's time.
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/measure.hpp"
#include "debris.hpp"
#include "sizes.hpp"

namespace talus::benchmarks {
namespace {

void run_stage(benchmark::State& run, params::InternalFriction method, std::size_t place) {
    Step step(debris_of(run.range(0)), method);
    step.run_until(place);
    step.remember();
    const Stage& stage = step.stages().after_neighbours[place];
    for (auto _ : run) {
        step.run(stage);
        run.PauseTiming();
        step.restore();
        run.ResumeTiming();
    }
    run.SetItemsProcessed(run.iterations() * step.count());
}

/// "stress/solve", "pair/apply", ...
bool register_stages() {
    const sim::Model& model = debris_of(smallest_size).model();
    for (const params::InternalFriction method : {params::InternalFriction::stress, params::InternalFriction::pair}) {
        sim::Model with_method = model;
        with_method.solver.internal_friction = method;
        const std::vector<Stage> stages = Stages(with_method).after_neighbours;
        for (std::size_t place = 0; place < stages.size(); ++place) {
            const std::string name = std::string(bench::method_name(method)) + "/" + stages[place].name;
            benchmark::RegisterBenchmark(name.c_str(), run_stage, method, place)->Apply(sizes);
        }
    }
    return true;
}

[[maybe_unused]] const bool registered = register_stages();

}  // namespace
}  // namespace talus::benchmarks
