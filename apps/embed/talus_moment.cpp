// The debris at an exact time: talus_get_debris_at().
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <fmt/format.h>

#include "names.hpp"

namespace {

using talus::LocalPoint;
using talus::embed::Before;

/// The step before the present state, if it is kept.
const Before* step_before(const talus_simulation& simulation) {
    const auto& before = simulation.before;
    return before && before->step + 1 == simulation.scenario->step() ? &*before : nullptr;
}

Status check_time(const talus_simulation& simulation, double time) {
    const Scenario& scenario = *simulation.scenario;
    const double now = scenario.time();
    const bool over = scenario.phase() != talus::run::RunPhase::ready;
    if (time == now || (over && time > now)) return {};
    const Before* before = step_before(simulation);
    if (before != nullptr && time >= before->time && time < now) return {};
    return Error{fmt::format("time = {}: must be {}{}{} (s); talus_advance() to it first", time,
                             before != nullptr ? fmt::format("{} to ", before->time) : "", now,
                             over ? " or later" : "")};
}

/// `time` is before the present, and not before the step.
Answers::Moment moment_of(const talus::sim::State& state, const Before& before, double time) {
    const auto share = static_cast<float>((time - before.time) / (state.time - before.time));
    const auto back = static_cast<float>(state.time - time);
    Answers::Moment moment;
    for (auto* values : {&moment.x, &moment.y, &moment.z, &moment.velocity_x, &moment.velocity_y, &moment.velocity_z}) {
        values->resize(state.count);
    }
    for (std::uint32_t i = 0; i < state.count; ++i) {
        LocalPoint p = state.position.at(i), v = state.velocity.at(i);
        const std::uint32_t id = state.id[i];
        if (id < before.of_id.size() && before.of_id[id].present) {
            const Before::Particle& was = before.of_id[id];
            p = was.position + share * (p - was.position);
            v = was.velocity + share * (v - was.velocity);
        } else {
            p = p - back * v;
        }
        moment.x[i] = p.x;
        moment.y[i] = p.y;
        moment.z[i] = p.z;
        moment.velocity_x[i] = v.x;
        moment.velocity_y[i] = v.y;
        moment.velocity_z[i] = v.z;
    }
    return moment;
}

}  // namespace

extern "C" {

int talus_get_debris_at(const talus_simulation* simulation, double time, talus_debris* debris, talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_TRY(need(simulation, "simulation"));
        TALUS_TRY(check_size(debris, "debris"));
        if (!std::isfinite(time)) return Error{fmt::format("time = {}: must be a finite number", time)};
        TALUS_TRY(check_time(*simulation, time));
        const talus::sim::State& state = simulation->scenario->run().state();
        if (time >= state.time) {
            give<talus_debris>({0, state.count, state.position.x.data(), state.position.y.data(),
                                state.position.z.data(), state.velocity.x.data(), state.velocity.y.data(),
                                state.velocity.z.data(), state.id.data(), state.held.data()},
                               debris);
            return {};
        }
        auto& moments = simulation->answers.moments;
        auto found = moments.find(time);
        if (found == moments.end()) {
            found = moments.emplace(time, moment_of(state, *step_before(*simulation), time)).first;
        }
        const Answers::Moment& at = found->second;
        give<talus_debris>({0, state.count, at.x.data(), at.y.data(), at.z.data(), at.velocity_x.data(),
                            at.velocity_y.data(), at.velocity_z.data(), state.id.data(), state.held.data()},
                           debris);
        return {};
    });
}

}  // extern "C"
