#include "serve/access.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "core/lower_case.hpp"

namespace talus::serve {
namespace {

constexpr std::size_t shortest_token = 16, longest_token = 128;

bool has_port(std::string_view name) {
    const std::size_t colon = name.rfind(':');
    if (colon == std::string_view::npos) return false;
    const bool bare_ip6 = name.find(':') != colon && name.front() != '[';
    const bool inside_brackets = name.front() == '[' && name.find(']') > colon;
    return !bare_ip6 && !inside_brackets;
}

}  // namespace

Status check_tokens(const Tokens& tokens) {
    for (const std::string* token : {&tokens.controller, &tokens.viewer, &tokens.trigger}) {
        if (token == &tokens.trigger && token->empty()) continue;
        const bool plain = std::all_of(token->begin(), token->end(), [](unsigned char c) {
            return std::isalnum(c) || c == '_' || c == '-' || c == '.' || c == '~';
        });
        if (token->size() < shortest_token || token->size() > longest_token || !plain) {
            return Error{fmt::format("a token of {} characters; a token has {} to {} of A-Z a-z 0-9 _ - . ~",
                                     token->size(), shortest_token, longest_token)};
        }
    }
    if (tokens.controller == tokens.viewer) return Error{"the tokens of controllers and viewers are the same"};
    if (tokens.trigger == tokens.controller || tokens.trigger == tokens.viewer) {
        return Error{"the token of triggers is also that of controllers or viewers"};
    }
    return {};
}

Access::Access(Tokens tokens, const std::string& bound, std::uint16_t port, const std::vector<std::string>& allowed)
    : tokens_(std::move(tokens)) {
    const auto add = [&](const std::string& name) {
        const bool ip6 = name.find(':') != std::string::npos && name.front() != '[' && !has_port(name);
        const std::string host = lower_case(ip6 ? "[" + name + "]" : name);
        if (has_port(host)) {
            hosts_.push_back(host);
            return;
        }
        hosts_.push_back(fmt::format("{}:{}", host, port));
        if (port == 80) hosts_.push_back(host);
    };
    for (const char* name : {"127.0.0.1", "localhost", "[::1]"}) add(name);
    if (!bound.empty()) add(bound);
    for (const std::string& name : allowed) {
        if (name.empty()) continue;
        add(name);
        // A reverse proxy listens on a port that browsers omit.
        if (!has_port(name)) hosts_.push_back(lower_case(name));
    }
}

bool Access::host_allowed(std::string_view host) const {
    const std::string lower = lower_case(host);
    if (lower == shared_ && !shared_.empty()) return true;
    return std::find(hosts_.begin(), hosts_.end(), lower) != hosts_.end();
}

void Access::share(const std::string& host) {
    shared_ = lower_case(host);
}

bool Access::origin_allowed(std::string_view origin, std::string_view host) const {
    const std::string from = lower_case(origin), own = lower_case(host);
    return from == "http://" + own || from == "https://" + own;
}

Role Access::role_of(std::string_view token) const {
    const bool controller = same_secret(token, tokens_.controller);
    const bool viewer = same_secret(token, tokens_.viewer);
    const bool trigger = same_secret(token, tokens_.trigger);
    return controller ? Role::controller : viewer ? Role::viewer : trigger ? Role::trigger : Role::nobody;
}

}  // namespace talus::serve
