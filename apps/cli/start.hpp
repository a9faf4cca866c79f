#pragma once

namespace talus::cli {

/// Whether a person at a desktop has started the program: a terminal and a display are there.
[[nodiscard]] bool at_a_desktop();

/// `talus` without arguments: the start page in the browser.
int start_page();

}  // namespace talus::cli
