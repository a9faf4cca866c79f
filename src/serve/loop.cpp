#include "serve/loop.hpp"

#include <exception>
#include <pthread.h>
#include <utility>

#include "core/try.hpp"

namespace talus::serve {

Result<std::unique_ptr<Loop>> Loop::start(Executor& executor, std::shared_ptr<const scene::Scene> scene,
                                          twin::ScenarioOptions options, Watcher& watcher,
                                          std::function<void(std::string)> failed) {
    auto threads = std::make_unique<run::Threads>(scene->spec.solver.thread_count);
    TALUS_ASSIGN(auto first,
                 threads->execute([&] { return twin::Scenario::open(std::move(scene), std::move(options)); }));
    return std::unique_ptr<Loop>(new Loop(executor, std::move(threads), std::move(first), watcher, std::move(failed)));
}

Loop::Loop(Executor& executor, std::unique_ptr<run::Threads> threads, std::unique_ptr<twin::Scenario> first,
           Watcher& watcher, std::function<void(std::string)> failed)
    : threads_(std::move(threads)),
      scenarios_(std::move(first), watcher,
                 [this](session::Work work, std::function<void()> then) {
                     preparer_.post([this, work = std::move(work), then = std::move(then)] {
                         work(stop_);
                         post([then](Scenarios&) { then(); });
                     });
                 }),
      failed_(std::move(failed)),
      preparer_(executor, "preparer"),
      thread_([this] { run(); }) {}

Loop::~Loop() {
    stop_ = true;
    {
        const std::lock_guard lock(mutex_);
        done_ = true;
    }
    wake_.notify_one();
    thread_.join();
}

void Loop::post(Task task) {
    {
        const std::lock_guard lock(mutex_);
        tasks_.push_back(std::move(task));
    }
    wake_.notify_one();
}

void Loop::run() {
    pthread_setname_np(pthread_self(), "loop");  // shown by tools that list threads
    try {
        threads_->execute([this] { work_until_done(); });
    } catch (const std::exception& error) {
        failed_(std::string("the session ended unexpectedly: ") + error.what());
    }
}

void Loop::work_until_done() {
    std::deque<Task> now_due;
    std::unique_lock lock(mutex_);
    while (!done_) {
        now_due.swap(tasks_);
        lock.unlock();
        for (Task& task : now_due) task(scenarios_);
        now_due.clear();
        const auto next = scenarios_.work(&Clock::now);
        lock.lock();
        const auto called = [this] { return done_ || !tasks_.empty(); };
        if (!next) {
            wake_.wait(lock, called);
        } else if (*next > Clock::now()) {
            wake_.wait_until(lock, *next, called);
        }
    }
}

}  // namespace talus::serve
