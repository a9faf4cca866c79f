#pragma once

#include <string>

namespace talus::serve {

/// The description of the API: openapi.json, with the keys of sections as the field table declares them. In it an
/// object with "x-section": "barrier" has the values of that section that can change during a run;
/// with "x-section-input" it takes them; "x-actions" does so for the sections of several actions.
[[nodiscard]] const std::string& openapi_document();

}  // namespace talus::serve
