#include "serve/executor.hpp"

#include <pthread.h>
#include <sys/resource.h>
#include <utility>

namespace talus::serve {

/// Every group has its first thread now: a thread has the niceness of the one that starts it, and a task of lower
/// priority may be the first to post to a group.
Executor::Executor() {
    group(Priority::prompt).name = "prompt";
    group(Priority::background).name = "background";
    group(Priority::background).niceness = 5;
    group(Priority::idle).name = "idle";
    group(Priority::idle).niceness = 10;
    for (Group& each : groups_) {
        const std::lock_guard lock(each.mutex);
        each.add_thread();
    }
}

Executor::~Executor() {
    for (Group& each : groups_) {
        {
            const std::lock_guard lock(each.mutex);
            each.done = true;
        }
        each.wake.notify_all();
        for (std::thread& thread : each.threads) thread.join();
    }
}

/// Under the lock.
void Executor::Group::add_thread() {
    threads.emplace_back([this] { run(); });
    ++free;
}

void Executor::Group::run() {
    if (niceness > 0) setpriority(PRIO_PROCESS, 0, niceness);  // of this thread
    pthread_setname_np(pthread_self(), name);
    std::unique_lock lock(mutex);
    while (true) {
        wake.wait(lock, [this] { return done || !ready.empty(); });
        if (ready.empty()) return;
        Lane& lane = *ready.front();
        ready.pop_front();
        std::function<void()> task = std::move(lane.tasks_.front());
        lane.tasks_.pop_front();
        lane.running_ = true;
        if (--free == 0) add_thread();
        lock.unlock();
        pthread_setname_np(pthread_self(), lane.name_);
        task();
        task = nullptr;  // releases its data while others can post
        pthread_setname_np(pthread_self(), name);
        lock.lock();
        ++free;
        lane.running_ = false;
        // The last look at the lane: its owner may wait to end it.
        if (!lane.closed_ && !lane.tasks_.empty()) ready.push_back(&lane);
        task_ended.notify_all();
    }
}

void Lane::post(std::function<void()> task) {
    const std::lock_guard lock(group_.mutex);
    if (closed_) return;
    tasks_.push_back(std::move(task));
    if (running_ || tasks_.size() > 1) return;  // its turn comes
    group_.ready.push_back(this);
    group_.wake.notify_one();
}

void Lane::close() {
    std::deque<std::function<void()>> discarded;  // they end without the lock: they may post elsewhere
    std::unique_lock lock(group_.mutex);
    closed_ = true;
    std::erase(group_.ready, this);
    group_.task_ended.wait(lock, [this] { return !running_; });
    discarded.swap(tasks_);
}

}  // namespace talus::serve
