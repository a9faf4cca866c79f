#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/grid.hpp"
#include "core/hazard_maps.hpp"
#include "core/result.hpp"
#include "observe/observation.hpp"
#include "products/checked_file.hpp"
#include "run/run_result.hpp"
#include "run/verdict.hpp"
#include "scene/scene.hpp"

/// The record of a run in an ensemble: a file with a line that has the checksum of all that follows, a line of JSON
/// (which run of which plan, values, scalar results, buildings) and the peak maps as they are, so that it can be
/// evaluated again without a new run.
namespace talus::ensemble {

/// A scalar result of a run.
struct Measure {
    std::string key;   ///< "run_out_along_flow_m", "observation[0].front_velocity_mps"
    std::string name;  ///< "Run-out along the flow"
    std::string unit;  ///< "m"
};

/// The scalar results of every run of a scene, in a fixed order.
[[nodiscard]] std::vector<Measure> measures_of(const scene::Scene& scene);

/// The values of measures_of; NaN where a run gives none.
[[nodiscard]] std::vector<double> measure(const scene::Scene& scene, const run::RunResult& result);

struct RunRecord {
    std::size_t run = 0;              ///< index in the plan
    std::string fault;                ///< why there is no result; empty: complete
    std::string model;                ///< "particles", "depth_averaged"; empty: of an earlier version, or not loaded
    std::vector<std::string> values;  ///< of the factors
    std::vector<double> results;      ///< as measures_of
    std::vector<observe::BuildingImpact> buildings;
    double simulated_time = 0, wall_time = 0;  ///< s
    std::uint32_t particles = 0;
    run::RunVerdict verdict;  ///< without checks: failed, or of an earlier version
    std::string hash;         ///< of the state at the end
    GridGeometry geometry;    ///< of the maps; no cells: debris reached nothing

    [[nodiscard]] bool complete() const { return fault.empty(); }
};

/// The maps that a record holds, in the order of the file.
inline constexpr auto& recorded_maps = named_maps;

/// Of the complete runs.
[[nodiscard]] run::RunVerdict judge_together(const std::vector<RunRecord>& runs);

/// Writes under a temporary name first, so that a file with the final name is complete. `plan`: as plan_identity;
/// `maps` all have record.geometry.
[[nodiscard]] Status write_run_record(const std::filesystem::path& file, const std::string& plan,
                                      const RunRecord& record, const HazardMaps& maps);

using products::Verify;

/// Run `run` of the plan without its maps. Errors: missing, damaged, of another plan or run.
[[nodiscard]] Result<RunRecord> read_run_record(const std::filesystem::path& file, const std::string& plan,
                                                std::size_t run, Verify verify = Verify::bytes);

/// Rows [first, last) of one map of the record (index into recorded_maps), NaN where debris never came.
[[nodiscard]] Result<std::vector<float>> read_map_rows(const std::filesystem::path& file, const RunRecord& record,
                                                       std::size_t map, int first, int last);

}  // namespace talus::ensemble
