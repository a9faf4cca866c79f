#pragma once

#include "validate/kind.hpp"

/// All kinds of cases, one per file of this folder.
namespace talus::validate {

[[nodiscard]] Kind sliding_slab_kind();
[[nodiscard]] Kind growing_slab_kind();
[[nodiscard]] Kind granular_column_kind();
[[nodiscard]] Kind standing_heap_kind();
[[nodiscard]] Kind dam_break_kind();
[[nodiscard]] Kind spreading_cap_kind();
[[nodiscard]] Kind water_column_kind();
[[nodiscard]] Kind lake_at_rest_kind();
[[nodiscard]] Kind free_fall_kind();
[[nodiscard]] Kind run_up_kind();
[[nodiscard]] Kind wall_impact_kind();
[[nodiscard]] Kind net_stream_kind();
[[nodiscard]] Kind structure_impact_kind();
[[nodiscard]] Kind inflow_plane_kind();
[[nodiscard]] Kind shear_decay_kind();
[[nodiscard]] Kind sheet_flow_kind();
[[nodiscard]] Kind debris_flume_kind();
[[nodiscard]] Kind energy_line_kind();
[[nodiscard]] Kind profile_kind();
[[nodiscard]] Kind pore_pressure_kind();
[[nodiscard]] Kind rough_ground_kind();
[[nodiscard]] Kind scene_kind();

}  // namespace talus::validate
