#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "core/result.hpp"

namespace talus::serve {

/// Where alarms are posted. The whole address is a secret: whoever has it may post there.
struct WebhookTarget {
    bool tls = false;
    std::string host, port, path;
    std::string authorization;  ///< value of that header; empty: none

    /// "hooks.example.org:443": what logs and the page may say.
    [[nodiscard]] std::string shown() const { return host + ":" + port; }
};

/// The text of a file: an address such as https://host/path, and on a second line, if there is one, the value of the
/// header Authorization. Errors do not repeat the text.
[[nodiscard]] Result<WebhookTarget> read_webhook(const std::string& text);

/// Posts JSON and waits for the answer, `limit` at most for connecting and again for the rest. A certificate must be
/// valid for the host. `stop` is asked ten times a second. Errors: no connection, no answer in time, a status other
/// than 2xx; they name host and port.
[[nodiscard]] Status post_webhook(const WebhookTarget& target, const std::string& body, std::chrono::milliseconds limit,
                                  const std::function<bool()>& stop);

}  // namespace talus::serve
