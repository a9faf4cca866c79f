// The functions of talus.h that keep a state in memory and go on from it.
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "call.hpp"
#include "core/try.hpp"
#include "handle.hpp"
#include "talus.h"

/// A simulation that nobody advances.
struct talus_snapshot {
    std::unique_ptr<talus::twin::Scenario> scenario;
    std::optional<talus::embed::Before> before;
};

namespace {

using talus::Error;
using talus::Status;
using talus::embed::Changing;
using talus::embed::guarded;
using talus::embed::need;

}  // namespace

extern "C" {

int talus_fork(const talus_simulation* simulation, talus_simulation** fork, talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_TRY(need(simulation, "simulation"));
        TALUS_TRY(need(static_cast<void*>(fork), "fork"));
        auto made = std::make_unique<talus_simulation>();
        made->scenario = simulation->scenario->fork();
        made->can_be_saved = simulation->can_be_saved;
        made->before = simulation->before;
        *fork = made.release();
        return {};
    });
}

int talus_take_snapshot(const talus_simulation* simulation, talus_snapshot** snapshot, talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_TRY(need(simulation, "simulation"));
        TALUS_TRY(need(static_cast<void*>(snapshot), "snapshot"));
        auto made = std::make_unique<talus_snapshot>();
        made->scenario = simulation->scenario->fork();
        made->before = simulation->before;
        *snapshot = made.release();
        return {};
    });
}

int talus_restore(talus_simulation* simulation, const talus_snapshot* snapshot, talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_TRY(Changing::check(simulation));
        TALUS_TRY(need(snapshot, "snapshot"));
        if (&snapshot->scenario->scene() != &simulation->scenario->scene()) {
            return Error{"snapshot: must be of this simulation, or of one that it was forked from or into"};
        }
        auto restored = snapshot->scenario->fork();
        const Changing changing(*simulation);
        simulation->before.reset();
        if (snapshot->before) simulation->before.emplace(*snapshot->before);
        simulation->scenario = std::move(restored);
        talus::embed::tell(TALUS_LOG_INFO, fmt::format("back to t = {:.4g} s", simulation->scenario->time()));
        return {};
    });
}

void talus_drop_snapshot(talus_snapshot* snapshot) {
    delete snapshot;  // NOLINT(cppcoreguidelines-owning-memory): C owns it
}

}  // extern "C"
