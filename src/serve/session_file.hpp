#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "serve/open_session.hpp"
#include "serve/overlay.hpp"
#include "serve/tile_addresses.hpp"
#include "twin/journal.hpp"

namespace talus::serve {

/// A scenario of a saved session: the journal determines its result.
struct SavedScenario {
    int index = 0;  ///< 0 for "A", ...
    std::string title;
    twin::Journal journal;
};

/// A saved session: the scenarios of one scene.
struct SessionFile {
    std::string name, title;
    std::vector<SavedScenario> scenarios;  ///< the first is A
    std::vector<Overlay> overlays;
    std::vector<TileAddress> tiles;  ///< that people added
};

/// As JSON, from the thread that owns the scenarios. `title`: of the scene; `laid`: as Overlays::saved.
[[nodiscard]] nlohmann::json write_session(Scenarios& all, const std::string& name, const std::string& title,
                                           const nlohmann::json& laid);

/// Errors name scenario, key and value; scenarios of several scenes; no scenario A.
[[nodiscard]] Result<SessionFile> read_session(const std::string& text);

/// Computes the scenarios again, with their recordings. `say` is told the name of each and its share done; false stops.
/// `notes`: results that differ from those saved, inputs that have changed. Errors: as twin::replay.
[[nodiscard]] Result<std::vector<OpeningScenario>> replay_session(
    const SessionFile& file, const std::shared_ptr<const scene::Scene>& scene,
    const std::function<bool(const std::string& what, double share)>& say, std::vector<std::string>& notes);

}  // namespace talus::serve
