#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "ensemble/finished_ensemble.hpp"
#include "messages/messages.hpp"
#include "scene/scene.hpp"
#include "serve/message.hpp"

namespace talus::serve {

/// The maps of finished ensembles of this scene, shown in addition to those of the live run. They are read once, so
/// that a faulty folder is reported at the start, and no other file can be requested.
class Ensembles {
  public:
    Ensembles() = default;

    /// Errors, each naming folder or file: no ensemble, not finished, another CRS, off the scene's terrain, damaged.
    [[nodiscard]] static Result<Ensembles> read(const std::vector<std::filesystem::path>& folders,
                                                const scene::Scene& scene);

    /// As `GET /api/ensembles`.
    [[nodiscard]] messages::Ensembles describe() const;
    /// A grid message, in the unit that describe() gives. nullptr: no such map.
    [[nodiscard]] Bytes map(const std::string& ensemble, const std::string& name) const;

  private:
    struct Map {
        ensemble::FinishedMap about;
        Bytes grid;
        double greatest = 0;  // 0: debris reached no cell by that measure
    };
    struct Ensemble {
        ensemble::FinishedEnsemble about;
        std::vector<Map> maps;
        bool same_terrain = true;
    };
    [[nodiscard]] static Result<Ensemble> read_one(const std::filesystem::path& folder, const scene::Scene& scene);

    std::vector<Ensemble> ensembles_;
};

}  // namespace talus::serve
