#pragma once

#include <atomic>
#include <memory>

#include "serve/message.hpp"
#include "serve/worker.hpp"

namespace talus::serve {

struct OpenSession;

/// The open session as one page, made when it is asked for on a thread of its own, while the runs go on.
class TwinPage {
  public:
    explicit TwinPage(OpenSession& open) : open_(open) {}
    /// Ends its thread; requests that wait are not answered. Before the session is closed, which answers its questions.
    void close();
    /// Answers with the page. Errors: larger than largest_twin, closed.
    void file(const Respond& respond);

  private:
    OpenSession& open_;
    std::atomic<bool> stop_ = false;
    std::unique_ptr<Worker> writer_ = std::make_unique<Worker>("twin page", 5);
};

}  // namespace talus::serve
