#pragma once

#include <array>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace talus::serve {

class Lane;

/// The share of its thread where cores are short: that of the live run, a third of it, or a tenth.
enum class Priority { prompt, background, idle };

/// The threads of a program for work that must delay neither the steps nor the connections. They are shared by lanes,
/// to which the work is posted, and must outlive them. Each priority has a group of threads, since they cannot change
/// their niceness back.
///
/// Any lane may be busy for minutes or wait for another one, which nobody knows beforehand. So a thread that takes a
/// lane first sees to it that another one is free: a group has at most one thread more than lanes that were busy at the
/// same time, and no lane ever waits for another's work.
class Executor {
  public:
    Executor();
    ~Executor();
    Executor(const Executor&) = delete;
    Executor& operator=(const Executor&) = delete;

  private:
    friend class Lane;
    struct Group {
        const char* name = nullptr;
        int niceness = 0;  // above that of the program
        std::mutex mutex;  // guards the following, and what the group's lanes hold
        std::condition_variable wake, task_ended;
        std::deque<Lane*> ready;  // each has a task that waits, and none that runs
        std::size_t free = 0;     // threads that will look at `ready` next
        bool done = false;
        std::vector<std::thread> threads;

        void add_thread();
        void run();
    };
    [[nodiscard]] Group& group(Priority priority) { return groups_[static_cast<std::size_t>(priority)]; }

    std::array<Group, 3> groups_;
};

/// Tasks that run one after the other, in order, on threads of an executor. Functions may be called from any thread.
class Lane {
  public:
    /// `name`: of the thread while a task runs, shown by tools that list threads; 15 characters at most. Threads that
    /// tasks start have the priority, too.
    Lane(Executor& executor, const char* name, Priority priority = Priority::prompt)
        : group_(executor.group(priority)), name_(name) {}
    ~Lane() { close(); }
    Lane(const Lane&) = delete;
    Lane& operator=(const Lane&) = delete;

    void post(std::function<void()> task);
    /// Waits for the current task, which cannot call this; waiting ones are discarded, as those posted from now on.
    void close();

  private:
    friend struct Executor::Group;
    Executor::Group& group_;
    const char* const name_;
    // Guarded by the group's mutex.
    std::deque<std::function<void()>> tasks_;
    bool running_ = false, closed_ = false;
};

}  // namespace talus::serve
