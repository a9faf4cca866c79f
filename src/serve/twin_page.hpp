#pragma once

#include <atomic>

#include "serve/executor.hpp"
#include "serve/message.hpp"

namespace talus::serve {

struct OpenSession;

/// The open session as one page, made when it is asked for, while the runs go on.
class TwinPage {
  public:
    explicit TwinPage(OpenSession& open);
    /// Ends its lane; requests that wait are not answered. Before the session is closed, which answers its questions.
    void close();
    /// Answers with the page. Errors: larger than largest_twin, closed.
    void file(const Respond& respond);

  private:
    OpenSession& open_;
    std::atomic<bool> stop_ = false;
    Lane writer_;
};

}  // namespace talus::serve
