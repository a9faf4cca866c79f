#pragma once

#include <boost/beast/core/span.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/span_body.hpp>
#include <string>

#include "serve/message.hpp"
#include "serve/site.hpp"

/// What a browser is told about an answer, and what it may do with it.
namespace talus::serve {

using AnswerHead = boost::beast::http::response<boost::beast::http::span_body<const char>>;

/// Of a file of the page. `packed`: it is sent as gzip; `host`: of the request, one of those allowed; `tile_origins`:
/// further origins of images.
void set_headers(AnswerHead& message, const Site::File& file, bool packed, const std::string& host,
                 const std::string& tile_origins);

void set_headers(AnswerHead& message, const Response& response);

/// Of every answer.
void set_common_headers(AnswerHead& message);

}  // namespace talus::serve
