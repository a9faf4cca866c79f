#include <cmath>

#include <fmt/format.h>

#include "core/try.hpp"
#include "messages/messages.hpp"
#include "serve/access.hpp"
#include "serve/api.hpp"
#include "serve/sharing.hpp"
#include "session/json_text.hpp"
#include "twin/json_keys.hpp"

namespace talus::serve {
namespace {

constexpr std::size_t longest_pem = 200'000;

Result<ShareWanted> read_wanted(const std::string& body) {
    TALUS_ASSIGN(const auto wanted, read_object(body, {"address", "port", "name", "certificate", "key"}));
    ShareWanted share;
    TALUS_ASSIGN(const auto address, twin::read_text(wanted, "address", 100));
    TALUS_ASSIGN(const auto port, twin::read_number(wanted, "port", {0, 65535, true, true}, ""));
    if (port && *port != std::floor(*port)) {
        return Error{fmt::format("port = {}: must be a whole number", twin::shown(wanted["port"]))};
    }
    TALUS_ASSIGN(const auto name, twin::read_text(wanted, "name", 300));
    share.address = address.value_or("");
    share.port = static_cast<std::uint16_t>(port.value_or(0));
    share.name = name.value_or("");
    const auto pem = [&](const char* key, std::string& to) -> Status {
        const auto found = wanted.find(key);
        if (found == wanted.end() || found->is_null()) return {};
        if (!found->is_string() || found->get_ref<const std::string&>().size() > longest_pem) {
            return Error{fmt::format("{}: is a text in PEM of up to {} bytes", key, longest_pem)};
        }
        to = found->get<std::string>();  // its line breaks stay
        return {};
    };
    TALUS_TRY(pem("certificate", share.certificate));
    TALUS_TRY(pem("key", share.key));
    if (share.certificate.empty() != share.key.empty()) {
        return Error{"certificate and key: both are needed for TLS, none of them without"};
    }
    return share;
}

}  // namespace

void add_share_routes(Router& router, Sharing& sharing, Access& access) {
    const auto describe = [&sharing, &access] {
        std::optional<messages::SharedLink> shared;
        if (sharing.is_open()) {
            const std::string base = fmt::format("{}://{}/", sharing.encrypted() ? "https" : "http", sharing.host());
            shared = {.host = sharing.host(),
                      .encrypted = sharing.encrypted(),
                      .viewer_url = fmt::format("{}#token={}", base, access.tokens().viewer),
                      .controller_url = fmt::format("{}#token={}", base, access.tokens().controller)};
        }
        return json_response(200, messages::Share{.shared = shared, .addresses = shareable_addresses()});
    };
    router.add({"GET", "/api/share", Role::controller,
                [describe](const Request&, const Respond& respond) { respond(describe()); }});
    router.add({"POST", "/api/share", Role::controller,
                [describe, &sharing, &access](const Request& request, const Respond& respond) {
                    const auto wanted = read_wanted(request.body);
                    if (!wanted) return respond(error_response(400, wanted.error().message));
                    if (const Status opened = sharing.open(*wanted); !opened) {
                        return respond(error_response(409, opened.error().message));
                    }
                    access.share(sharing.host());
                    respond(describe());
                }});
    router.add({"DELETE", "/api/share", Role::controller,
                [describe, &sharing, &access](const Request&, const Respond& respond) {
                    sharing.close();
                    access.share("");
                    respond(describe());
                }});
}

}  // namespace talus::serve
