#pragma once

#include <optional>
#include <string>

namespace talus::publish {

/// The solver for browsers, compiled to WebAssembly.
struct Engine {
    std::string script;  ///< talus_engine.js
    std::string wasm;    ///< talus_engine.wasm
};

/// That of this program, or else that of share/talus/web_engine beside its folder. Empty: there is none.
[[nodiscard]] std::optional<Engine> find_engine();

}  // namespace talus::publish
