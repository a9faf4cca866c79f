#include "serve/worker.hpp"

#include <pthread.h>
#include <utility>

namespace talus::serve {

Worker::Worker(const char* name) : thread_([this, name] { run(name); }) {}

Worker::~Worker() {
    {
        const std::lock_guard lock(mutex_);
        done_ = true;
    }
    wake_.notify_one();
    thread_.join();
}

void Worker::post(std::function<void()> task) {
    {
        const std::lock_guard lock(mutex_);
        tasks_.push_back(std::move(task));
    }
    wake_.notify_one();
}

void Worker::run(const char* name) {
    pthread_setname_np(pthread_self(), name);
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
