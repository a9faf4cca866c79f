#include "serve/answer_headers.hpp"

#include <fmt/format.h>

namespace talus::serve {

namespace http = boost::beast::http;

void set_headers(AnswerHead& message, const Site::File& file, bool packed, const std::string& host,
                 const std::string& tile_origins) {
    message.result(http::status::ok);
    message.set(http::field::content_type, file.type);
    if (packed) message.set(http::field::content_encoding, "gzip");
    message.set(http::field::vary, "Accept-Encoding");
    message.set(http::field::cache_control, file.for_ever ? "public, max-age=31536000, immutable" : "no-cache");
    // Not every browser takes 'self' to mean the WebSocket too. The host is in the list.
    message.set(
        "Content-Security-Policy",
        fmt::format(
            "default-src 'self'; script-src 'self'; style-src 'self'; connect-src 'self' ws://{0} wss://{0}; "
            "img-src 'self' blob: data:{1}; worker-src 'self' blob:; media-src 'self' blob:; object-src 'none'; "
            "base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
            host, tile_origins));
    message.set("Cross-Origin-Opener-Policy", "same-origin");
}

void set_headers(AnswerHead& message, const Response& response) {
    message.result(static_cast<unsigned>(response.status));
    message.set(http::field::content_type, response.type);
    message.set(http::field::cache_control, "no-store");
    // As a page of its own it has an origin of its own: it has no part in this one's.
    message.set("Content-Security-Policy",
                response.document
                    ? "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src "
                      "data:; font-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; "
                      "sandbox allow-scripts"
                    : "default-src 'none'; frame-ancestors 'none'; sandbox");
    if (response.status == 401) message.set(http::field::www_authenticate, "Bearer");
    if (!response.allow.empty()) message.set(http::field::allow, response.allow);
    if (!response.file_name.empty()) {
        message.set(http::field::content_disposition, fmt::format("attachment; filename=\"{}\"", response.file_name));
    }
}

void set_common_headers(AnswerHead& message) {
    message.set("X-Content-Type-Options", "nosniff");
    message.set("Referrer-Policy", "no-referrer");
    message.set("Cross-Origin-Resource-Policy", "same-origin");
}

}  // namespace talus::serve
