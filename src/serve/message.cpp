#include "serve/message.hpp"

#include "messages/messages.hpp"

namespace talus::serve {

Response json_response(int status, const nlohmann::json& content) {
    Response response;
    response.status = status;
    response.body = std::make_shared<const std::string>(to_text(content));
    return response;
}

Response error_response(int status, const std::string& sentence) {
    return json_response(status, messages::Refusal{.error = sentence});
}

Response to_response(const session::Reply& reply) {
    Response response;
    response.status = session::status_of(reply.outcome);
    if (reply.binary) response.type = "application/octet-stream";
    response.body = reply.body;
    return response;
}

}  // namespace talus::serve
