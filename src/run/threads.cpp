#include "run/threads.hpp"

#include <algorithm>
#include <thread>

namespace talus::run {
namespace {

int processor_threads() {
    return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

}  // namespace

Threads::Threads(int wanted) : count_(wanted > 0 ? wanted : processor_threads()), arena_(count_) {
    if (count_ <= processor_threads()) return;
    limit_.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count_));
}

}  // namespace talus::run
