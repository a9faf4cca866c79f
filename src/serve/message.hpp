#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "session/json_text.hpp"
#include "session/requests.hpp"
#include "session/role.hpp"

namespace talus::serve {

// The words of a session, which are those of its messages.
using session::Arguments;
using session::Bytes;
using session::may;
using session::parse_json;
using session::read_object;
using session::Role;
using session::role_name;
using session::text_at;
using session::tidy_name;
using session::to_text;

/// An HTTP request that has passed the checks of host, origin and token.
struct Request {
    std::string method;
    std::string path;      ///< decoded, without the query
    Arguments query;       ///< decoded
    Arguments parameters;  ///< the values of {name} in the route's pattern
    std::string body;
    std::string secret;  ///< header Talus-Person: what a page received on its WebSocket; empty: a program
    Role role = Role::nobody;
};

struct Response {
    int status = 200;
    std::string type = "application/json";
    Bytes body;
    std::string file_name;  ///< file name under which a browser saves the body; empty: displayed
    std::string allow;      ///< methods, for status 405
    bool document = false;  ///< a page with styles, pictures and scripts of its own, which reach nothing else
    std::function<void()> written = {};  ///< called on the server's thread once it is, or cannot be
};

/// Answers a request: once, from any thread.
using Respond = std::function<void(Response)>;

/// Takes the body of a request piece by piece, so that a large one never is in memory. What came of a body that does
/// not come to its end is discarded with the object.
class Intake {
  public:
    virtual ~Intake() = default;
    /// `then` is called once, from any thread: with nothing, and the next piece may come; or with a refusal.
    virtual void take(std::string piece, std::function<void(std::optional<Response>)> then) = 0;
    /// The body is whole.
    virtual void finish(const Respond& respond) = 0;
};

[[nodiscard]] Response json_response(int status, const nlohmann::json& content);
/// `{"error": sentence}`
[[nodiscard]] Response error_response(int status, const std::string& sentence);
[[nodiscard]] Response to_response(const session::Reply& reply);

}  // namespace talus::serve
