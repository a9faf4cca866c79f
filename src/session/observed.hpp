#pragma once

#include "session/requests.hpp"

namespace talus::session {

/// Field observations beside what the run so far predicts for them.
[[nodiscard]] Rest observed(Scenarios& all, int index, const Arguments& arguments);

}  // namespace talus::session
