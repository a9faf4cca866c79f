#include "serve/message.hpp"

#include "serve/json_text.hpp"

namespace talus::serve {

const char* role_name(Role role) {
    switch (role) {
        case Role::viewer:
            return "viewer";
        case Role::controller:
            return "controller";
        case Role::trigger:
            return "trigger";
        case Role::nobody:
            break;
    }
    return "nobody";
}

Response json_response(int status, const nlohmann::json& content) {
    Response response;
    response.status = status;
    response.body = std::make_shared<const std::string>(to_text(content));
    return response;
}

Response error_response(int status, const std::string& sentence) {
    return json_response(status, {{"error", sentence}});
}

}  // namespace talus::serve
