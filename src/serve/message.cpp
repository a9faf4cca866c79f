#include "serve/message.hpp"

#include <array>

namespace talus::serve {

Response json_response(int status, const nlohmann::json& content) {
    Response response;
    response.status = status;
    response.body = std::make_shared<const std::string>(to_text(content));
    return response;
}

Response error_response(int status, const std::string& sentence) {
    return json_response(status, {{"error", sentence}});
}

Response to_response(const session::Reply& reply) {
    constexpr std::array statuses{200, 400, 404, 409};  // as Outcome has them
    Response response;
    response.status = statuses[static_cast<std::size_t>(reply.outcome)];
    if (reply.binary) response.type = "application/octet-stream";
    response.body = reply.body;
    return response;
}

}  // namespace talus::serve
