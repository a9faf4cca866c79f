#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace talus::serve {

/// A thread for work that must delay neither the steps nor the connections, begun with its first task. Tasks run one
/// after the other, in order.
class Worker {
  public:
    /// `name`: shown by tools that list threads, 15 characters at most. `niceness`: of this thread and those that its
    /// tasks start, above that of the program; with 5 it has a third, with 10 a tenth of the live run's share where
    /// cores are short.
    explicit Worker(const char* name, int niceness = 0) : name_(name), niceness_(niceness) {}
    /// Ends after the current task; waiting ones are discarded.
    ~Worker();
    Worker(const Worker&) = delete;
    Worker& operator=(const Worker&) = delete;

    void post(std::function<void()> task);

  private:
    void run();

    const char* const name_;
    const int niceness_;
    std::mutex mutex_;
    std::condition_variable wake_;
    std::deque<std::function<void()>> tasks_;
    bool done_ = false;
    std::thread thread_;
};

}  // namespace talus::serve
