// The hooks of talus.h: the only state of the library outside a simulation.
#include "hooks.hpp"

#include <atomic>
#include <mutex>

#include <fmt/format.h>

#include "call.hpp"
#include "core/try.hpp"

namespace talus::embed {
namespace {

struct Hooks {
    std::mutex mutex;
    talus_log log{};
    Memory memory;
    std::atomic<bool> has_log = false;
};

/// Never destroyed: a simulation may be closed at the end of the program.
Hooks& hooks() {
    static auto* const hooks = new Hooks;
    return *hooks;
}

}  // namespace

void tell(int level, const std::string& sentence) {
    if (!hooks().has_log) return;
    talus_log log{};
    {
        const std::scoped_lock lock(hooks().mutex);
        log = hooks().log;
    }
    if (log.write != nullptr && level >= log.least_level) log.write(log.user, level, sentence.c_str());
}

Memory present_memory() {
    const std::scoped_lock lock(hooks().mutex);
    return hooks().memory;
}

}  // namespace talus::embed

extern "C" {

int talus_set_log(const talus_log* log, talus_error* error) {
    using namespace talus;
    using namespace talus::embed;
    return guarded(error, [&]() -> Status {
        if (log != nullptr) {
            TALUS_TRY(check_size(log, "log"));
            TALUS_TRY(need(reinterpret_cast<const void*>(log->write), "log.write"));
            if (log->least_level < TALUS_LOG_INFO || log->least_level > TALUS_LOG_ERROR) {
                return Error{fmt::format("log.least_level = {}: must be TALUS_LOG_INFO, {}, to TALUS_LOG_ERROR, {}",
                                         log->least_level, int{TALUS_LOG_INFO}, int{TALUS_LOG_ERROR})};
            }
        }
        const std::scoped_lock lock(hooks().mutex);
        hooks().log = log != nullptr ? *log : talus_log{};
        hooks().has_log = log != nullptr;
        return {};
    });
}

int talus_set_allocator(const talus_allocator* allocator, talus_error* error) {
    using namespace talus;
    using namespace talus::embed;
    return guarded(error, [&]() -> Status {
        Memory memory;
        if (allocator != nullptr) {
            TALUS_TRY(check_size(allocator, "allocator"));
            TALUS_TRY(need(reinterpret_cast<const void*>(allocator->allocate), "allocator.allocate"));
            TALUS_TRY(need(reinterpret_cast<const void*>(allocator->release), "allocator.release"));
            memory = {allocator->allocate, allocator->release, allocator->user};
        }
        const std::scoped_lock lock(hooks().mutex);
        hooks().memory = memory;
        return {};
    });
}

}  // extern "C"
