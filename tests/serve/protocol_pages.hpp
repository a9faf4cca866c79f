#pragma once

#include <string>

#include "core/result.hpp"
#include "serve/protocol.hpp"

/// What is committed of the description of the messages besides itself: the page's types, the program's, and tables
/// for people.
namespace talus::test {

/// The module web/src/protocol/GROUP.ts.
[[nodiscard]] std::string protocol_typescript(const serve::Protocol& all, const std::string& group);

/// web/src/protocol/maps.ts: the page's part of the table of maps.
[[nodiscard]] std::string maps_typescript();

/// src/messages/messages.hpp and messages.cpp: the messages that the server sends.
[[nodiscard]] std::string protocol_header(const serve::Protocol& all);
[[nodiscard]] std::string protocol_writers(const serve::Protocol& all);

/// The page, with what stands between `<!-- protocol.json: WHAT -->` and `<!-- end -->` made again. WHAT is "routes
/// GROUP", "types GROUP" or "union NAME". Error: there is no such thing, or no end.
[[nodiscard]] Result<std::string> with_protocol_tables(const serve::Protocol& all, const std::string& page);

}  // namespace talus::test
