#include "serve/worker.hpp"

#include <pthread.h>
#include <sys/resource.h>
#include <utility>

namespace talus::serve {

Worker::~Worker() {
    {
        const std::lock_guard lock(mutex_);
        done_ = true;
    }
    wake_.notify_one();
    if (thread_.joinable()) thread_.join();
}

void Worker::post(std::function<void()> task) {
    {
        const std::lock_guard lock(mutex_);
        tasks_.push_back(std::move(task));
        if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
    }
    wake_.notify_one();
}

void Worker::run() {
    pthread_setname_np(pthread_self(), name_);
    if (niceness_ > 0) setpriority(PRIO_PROCESS, 0, niceness_);  // of this thread
    std::unique_lock lock(mutex_);
    while (true) {
        wake_.wait(lock, [this] { return done_ || !tasks_.empty(); });
        if (done_) return;
        std::function<void()> task = std::move(tasks_.front());
        tasks_.pop_front();
        lock.unlock();
        task();
        task = nullptr;  // releases its data while others can post
        lock.lock();
    }
}

}  // namespace talus::serve
