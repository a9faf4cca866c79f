#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "geo/overlay.hpp"
#include "messages/messages.hpp"
#include "serve/message.hpp"

namespace talus::serve {

/// A layer that people have laid over the terrain: see geo/overlay.hpp. It is the session's, not a scenario's.
struct Overlay {
    std::string id;  ///< "overlay-1"; given by the session
    std::string name, by;
    bool picture = false;
    bool visible = true;
    double opacity = 1;
    std::string colour;  ///< "#rrggbb", of what the file gives no style
    std::size_t features = 0, outside = 0;
    bool styled = false;
    bool has_range = false;
    double low = 0, high = 0;
    std::string note;
    std::string type;  ///< of the data: "application/json", "image/png", "image/webp"
    Bytes data;
};

/// What a session may hold.
struct OverlayQuota {
    std::size_t count = 20, bytes = 24'000'000;  ///< of all data together, as they are sent
    std::uint64_t upload = std::uint64_t{512} << 20;
    geo::OverlayLimits layer{};
};

/// As the page is told, without the data.
[[nodiscard]] messages::Overlay message_of(const Overlay& overlay);

/// With the data, for a saved session.
[[nodiscard]] messages::SavedOverlay saved_of(const Overlay& overlay);
/// Of a saved session, which may come from anybody. Errors name the entry and what is wrong.
[[nodiscard]] Result<std::vector<Overlay>> read_saved_overlays(const nlohmann::json& written,
                                                               const OverlayQuota& quota = {});

}  // namespace talus::serve
