#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "serve/message.hpp"
#include "session/secret.hpp"

namespace talus::serve {

using session::random_token;
using session::same_secret;

struct Tokens {
    std::string controller, viewer;
    std::string trigger{};  ///< empty: there is none
};

/// Error if a chosen token is too short, has other characters than A-Z a-z 0-9 _ - . ~, or two are the same.
[[nodiscard]] Status check_tokens(const Tokens& tokens);

/// Access control of the server. Host names are checked against a list: an origin equal to the host proves nothing, as
/// any name can be made to resolve to this machine.
class Access {
  public:
    /// `bound`: the address that the server listens on; `allowed`: further names, each with or without a port.
    Access(Tokens tokens, const std::string& bound, std::uint16_t port, const std::vector<std::string>& allowed);

    /// `host`: the header as received.
    [[nodiscard]] bool host_allowed(std::string_view host) const;
    /// Whether a page of `origin` may send requests to `host`: only the server's own pages may.
    [[nodiscard]] bool origin_allowed(std::string_view origin, std::string_view host) const;
    /// Takes as long for a wrong token as for a right one.
    [[nodiscard]] Role role_of(std::string_view token) const;
    /// Allows a further host, with its port, in place of the one allowed so before; empty: none.
    void share(const std::string& host);
    [[nodiscard]] const Tokens& tokens() const { return tokens_; }

  private:
    Tokens tokens_;
    std::vector<std::string> hosts_;  // lower case
    std::string shared_;              // as well; empty: none
};

}  // namespace talus::serve
