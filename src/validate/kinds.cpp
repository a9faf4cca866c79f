#include "validate/kinds/kinds.hpp"

#include <array>

namespace talus::validate {

std::span<const Kind> kinds() {
    static const std::array all = {
        sliding_slab_kind(),  growing_slab_kind(), granular_column_kind(),  standing_heap_kind(), dam_break_kind(),
        spreading_cap_kind(), water_column_kind(), lake_at_rest_kind(),     free_fall_kind(),     run_up_kind(),
        wall_impact_kind(),   net_stream_kind(),   structure_impact_kind(), inflow_plane_kind(),  shear_decay_kind(),
        sheet_flow_kind(),    debris_flume_kind(), energy_line_kind(),      profile_kind(),       rough_ground_kind(),
        pore_pressure_kind(), scene_kind()};
    return all;
}

const Quantity* Kind::find(std::string_view quantity) const {
    for (const Quantity& q : quantities) {
        if (q.name == quantity) return &q;
    }
    return nullptr;
}

}  // namespace talus::validate
