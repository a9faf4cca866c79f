#pragma once

#include <optional>

namespace talus::web_engine {

/// What the packed scene says of where it lies: there is no library of reference systems in a page.
void set_latitude(std::optional<double> degrees);

}  // namespace talus::web_engine
