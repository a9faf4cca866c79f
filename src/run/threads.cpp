#include "run/threads.hpp"

#include <algorithm>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

namespace talus::run {
namespace {

int processor_threads() {
    return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

/// Arenas that no work uses at present.
struct Idle {
    std::mutex mutex;
    std::map<int, std::vector<std::unique_ptr<tbb::task_arena>>> by_count;
};

/// Never destroyed: what is destroyed at the end of the program may still use threads.
Idle& idle() {
    static auto* const arenas = new Idle;
    return *arenas;
}

}  // namespace

Threads::Threads(int wanted) : count_(wanted > 0 ? wanted : processor_threads()), arena_(arena_of(count_)) {
    if (count_ <= processor_threads()) return;
    limit_.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count_));
}

Threads::Arena Threads::arena_of(int count) {
    const std::lock_guard lock(idle().mutex);
    auto& arenas = idle().by_count[count];
    if (arenas.empty()) return Arena(new tbb::task_arena(count));
    Arena arena(arenas.back().release());
    arenas.pop_back();
    return arena;
}

void Threads::Keep::operator()(tbb::task_arena* arena) const {
    const std::lock_guard lock(idle().mutex);
    idle().by_count[arena->max_concurrency()].emplace_back(arena);
}

}  // namespace talus::run
