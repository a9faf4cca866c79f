#pragma once

namespace tbb {

class task_arena {
  public:
    explicit task_arena(int = 1) {}
    template <class Work>
    decltype(auto) execute(Work&& work) {
        return work();
    }
    [[nodiscard]] static int max_concurrency() { return 1; }
};

namespace this_task_arena {
inline int max_concurrency() {
    return 1;
}
inline int current_thread_index() {
    return 0;
}
}  // namespace this_task_arena

}  // namespace tbb
