#pragma once

#include <string>

namespace talus::serve {

/// The OpenAPI 3.1 document of the description (protocol.hpp), with the keys of sections of the scene file as the field
/// table declares them. Messages of the WebSocket are among its schemas.
[[nodiscard]] const std::string& openapi_document();

}  // namespace talus::serve
