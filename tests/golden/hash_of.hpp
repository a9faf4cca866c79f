#pragma once

#include <span>
#include <string>

#include "core/hash.hpp"
#include "observe/observation.hpp"

namespace talus::test {

/// Of what the observers measured: maps, structures, volumes. Motion has a hash of its own.
inline std::string hash_of(const observe::Observation& o) {
    StateHash hash;
    const auto add = [&](double value) { hash.add(&value, sizeof value); };
    for (const Grid<float>* map : {&o.maps.peak_depth, &o.maps.peak_speed, &o.maps.peak_pressure, &o.maps.arrival_time,
                                   &o.maps.deposit_depth, &o.erosion.depth}) {
        const GridGeometry& g = map->geometry;
        for (const double value : {g.x_min, g.y_min, g.cell}) add(value);
        hash.add(std::span<const float>(map->values));
    }
    for (const observe::BuildingImpact& b : o.buildings) {
        for (const double value :
             {b.first_hit_time, b.peak_force, b.peak_impact_pressure, b.peak_depth, b.peak_dynamic_pressure, b.impulse,
              b.failure_time, b.overtopped_volume, b.passed_volume, b.retained_volume, b.peak_filling_height}) {
            add(value);
        }
    }
    for (const observe::TimeSample& t : o.timeseries) {
        for (const double value : {t.time, t.volume_released, t.volume_entrained, t.front_chainage, t.volume_moving,
                                   t.volume_left, t.kinetic_energy, t.largest_speed}) {
            add(value);
        }
    }
    return to_hex(hash.value());
}

}  // namespace talus::test
