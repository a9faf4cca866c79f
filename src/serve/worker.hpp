#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace talus::serve {

/// A thread for work that must hold up neither the steps nor the connections. Tasks run one after the other, in order.
class Worker {
  public:
    /// `name`: as tools that watch threads show it, 15 characters at most.
    explicit Worker(const char* name);
    /// Ends after the task that runs; those that wait are dropped.
    ~Worker();
    Worker(const Worker&) = delete;
    Worker& operator=(const Worker&) = delete;

    void post(std::function<void()> task);

  private:
    void run(const char* name);

    std::mutex mutex_;
    std::condition_variable wake_;
    std::deque<std::function<void()>> tasks_;
    bool done_ = false;
    std::thread thread_;
};

}  // namespace talus::serve
