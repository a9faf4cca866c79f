#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "ensemble/plan.hpp"
#include "ensemble/reduction.hpp"
#include "report/hazard_map.hpp"

namespace talus::ensemble {

/// A map of an ensemble in its folder.
struct FinishedMap {
    enum class Kind { probability, percentile, zones };
    Kind kind = Kind::probability;
    std::string of;           ///< the map of a single run that it counts: "peak_depth", "intensity"
    double level = 0;         ///< the threshold in that map's unit, or the percentile in %; NaN: neither
    std::string level_unit;   ///< of a threshold
    report::HazardMap style;  ///< name, title, unit, categories
    std::filesystem::path file;
};

/// The content of an ensemble's folder after evaluation.
struct FinishedEnsemble {
    std::string name;  ///< of the folder
    std::size_t complete = 0, failed = 0;
    std::vector<Factor> factors;
    std::string terrain_hash;  ///< checksum of the terrain that it was computed on; empty: unknown
    std::vector<FinishedMap> maps;
};

/// Reads the output of `talus ensemble`, without the maps' cells. Errors: no ensemble, not finished, runs that are
/// missing, nothing mapped.
[[nodiscard]] Result<FinishedEnsemble> read_finished_ensemble(const std::filesystem::path& folder);

}  // namespace talus::ensemble
