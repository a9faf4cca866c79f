#pragma once

#include <optional>
#include <vector>

#include "design/design.hpp"
#include "ensemble/run_record.hpp"

/// The ensembles of a design, each in a folder.
namespace talus::design {

/// That of a line with a barrier of some height; 0: without any.
[[nodiscard]] Part make_part(const Design& design, std::size_t line, double height);
/// The runs of `numbers` again with particles. Errors: as load_scene and PlannedRuns::make.
[[nodiscard]] Result<Part> particle_part(const Design& design, std::size_t line, double height,
                                         const std::vector<std::size_t>& numbers);

struct PartRuns {
    std::vector<std::optional<BarrierRun>> runs;  ///< none: it failed
    std::vector<ensemble::RunRecord> records;
};
/// All runs of a part, which are there. Errors: a record or what was kept beside it cannot be read.
[[nodiscard]] Result<PartRuns> read_part(const Part& part);

}  // namespace talus::design
