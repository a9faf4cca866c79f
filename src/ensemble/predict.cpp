#include "ensemble/predict.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace talus::ensemble {
namespace {

constexpr double gravity = 9.81;                                 // m/s2
constexpr double superelevation_share = 0.25, time_share = 0.2;  // usual uncertainty over the value

std::string label(const std::string& name, const std::string& otherwise) {
    return name.empty() ? otherwise : otherwise + " (" + name + ")";
}

bool in_any(const std::vector<Polygon>& polygons, const PlanPoint& p) {
    return std::any_of(polygons.begin(), polygons.end(), [&](const Polygon& polygon) { return contains(polygon, p); });
}

}  // namespace

double predict_debris_speed(const observe::Observation& run, double chainage) {
    return front_at(run, chainage).particle_speed;
}

double predict_arrival_time(const observe::Observation& run, double chainage) {
    return front_at(run, chainage).arrival_time;
}

double predict_front_chainage(const observe::Observation& run) {
    return run.run_out.front_chainage;
}

double predict_run_up(const observe::Observation& run, const terrain::Terrain& terrain, const PlanPoint& place,
                      double search_radius) {
    const Grid<float>& depth = run.maps.peak_depth;
    const double here = value_at(depth, place);
    if (here > 0) return here;
    const double mark = terrain.elevation_at(place);
    double highest = observe::never;
    const GridGeometry& g = depth.geometry;
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            const PlanPoint p = g.centre(column, row);
            const double d = depth.at(column, row);
            if (!(d > 0) || std::hypot(p.x - place.x, p.y - place.y) > search_radius) continue;
            const double surface = terrain.elevation_at(p) + d;
            if (!(surface <= highest)) highest = surface;
        }
    }
    if (std::isnan(highest)) return observe::never;
    return std::min(0.0, highest - mark);  // debris uphill that did not reach the place counts as just below it
}

double predict_deposit_depth(const observe::Observation& run, const PlanPoint& place) {
    const double depth = value_at(run.maps.deposit_depth, place);
    return depth > 0 ? depth : 0;
}

double predict_building_pressure(const observe::Observation& run, const std::string& building) {
    for (const observe::BuildingImpact& impact : run.buildings) {
        if (impact.name == building) return impact.hit ? impact.peak_impact_pressure : 0;
    }
    return observe::never;
}

double predict_outline_overlap(const Grid<float>& map, const std::vector<Polygon>& outline, double depth) {
    const GridGeometry& g = map.geometry;
    double outlined = 0;
    for (const Polygon& polygon : outline) outlined += plan_area(polygon);
    double both = 0, covered = 0;
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            if (!(map.at(column, row) > depth)) continue;
            covered += g.cell * g.cell;
            if (in_any(outline, g.centre(column, row))) both += g.cell * g.cell;
        }
    }
    const double either = outlined + covered - both;  // the outline may reach beyond the map
    return either > 0 ? std::clamp(both / either, 0.0, 1.0) : 0;
}

double predict_elevation_agreement(const observe::Observation& run, const Grid<float>& observed,
                                   const std::vector<terrain::Release>& releases, double detection_limit) {
    const auto known = [](float value) { return std::isnan(value) ? 0.0 : static_cast<double>(value); };
    const auto detected = [&](double change) { return std::abs(change) < detection_limit ? 0.0 : change; };
    const GridGeometry& g = observed.geometry;
    double apart = 0, together = 0;
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            if (std::isnan(observed.at(column, row))) continue;  // not surveyed
            const PlanPoint p = g.centre(column, row);
            const bool released = std::any_of(releases.begin(), releases.end(), [&](const terrain::Release& release) {
                return release.thickness_at(p) > 0;
            });
            if (released) continue;
            const double was = detected(observed.at(column, row));
            const double is =
                detected(known(value_at(run.maps.deposit_depth, p)) - known(value_at(run.erosion.depth, p)));
            apart += std::abs(is - was);
            together += std::abs(is) + std::abs(was);
        }
    }
    return together > 0 ? 1 - apart / together : 0;
}

double superelevation_velocity(const params::SuperelevationSpec& m) {
    return std::sqrt(gravity * m.bend_radius * m.level_difference / (m.correction_factor * m.width));
}

std::vector<ObservedValue> observed_values(const scene::Scene& scene) {
    const params::SceneSpec& spec = scene.spec;
    std::vector<ObservedValue> all;
    const auto add = [&](const char* section, std::size_t i, const std::string& quantity, std::string name,
                         const char* unit, double value, double uncertainty) {
        all.push_back({fmt::format("{}[{}].{}", section, i, quantity), std::move(name), unit, value, uncertainty,
                       ObservedValue::Kind::equal, 0});
    };
    for (std::size_t i = 0; i < spec.observations.size(); ++i) {
        const params::ObservationSpec& o = spec.observations[i];
        add("observation", i, fmt::format("{}_mps", o.key()), fmt::format("{} at {:.6g} m", o.quantity(), o.chainage),
            "m/s", o.value(), o.standard_deviation());
    }
    for (std::size_t i = 0; i < spec.superelevations.size(); ++i) {
        const params::SuperelevationSpec& o = spec.superelevations[i];
        const double velocity = superelevation_velocity(o);
        add("superelevation", i, "debris_speed_mps", fmt::format("Speed in the bend at {:.6g} m", o.chainage), "m/s",
            velocity, o.uncertainty.value_or(superelevation_share * velocity));
    }
    for (std::size_t i = 0; i < spec.arrivals.size(); ++i) {
        const params::ArrivalSpec& o = spec.arrivals[i];
        add("arrival", i, "time_s", fmt::format("Arrival at {:.6g} m", o.chainage), "s", o.time,
            o.uncertainty.value_or(time_share * o.time));
        all.back().unreached = std::max(spec.solver.end_time, o.time + 5 * all.back().uncertainty);
    }
    for (std::size_t i = 0; i < spec.run_ups.size(); ++i) {
        const params::RunUpSpec& o = spec.run_ups[i];
        add("run_up", i, "height_m", label(o.name, fmt::format("Run-up mark {}", i + 1)), "m", o.height, o.uncertainty);
        all.back().unreached = -run_up_radius;
        all.back().least = -std::numeric_limits<double>::infinity();
    }
    for (std::size_t i = 0; i < spec.deposit_depths.size(); ++i) {
        const params::DepositDepthSpec& o = spec.deposit_depths[i];
        add("deposit_depth", i, "depth_m", label(o.name, fmt::format("Deposit depth {}", i + 1)), "m", o.depth,
            o.uncertainty);
    }
    for (std::size_t i = 0; i < spec.damages.size(); ++i) {
        const params::DamageSpec& o = spec.damages[i];
        add("damage", i, "pressure_Pa", fmt::format("Pressure on {} ({})", o.building, o.damaged ? "damaged" : "not"),
            "Pa", o.pressure, o.uncertainty);
        all.back().kind = o.damaged ? ObservedValue::Kind::at_least : ObservedValue::Kind::below;
    }
    for (std::size_t i = 0; i < spec.observed_run_outs.size(); ++i) {
        const params::ObservedRunOutSpec& o = spec.observed_run_outs[i];
        add("observed_run_out", i, "chainage_m", label(o.name, "Front to chainage"), "m", o.chainage, o.uncertainty);
    }
    for (std::size_t i = 0; i < spec.deposit_outlines.size(); ++i) {
        const params::OutlineSpec& o = spec.deposit_outlines[i];
        add("deposit_outline", i, "overlap", label(o.name, fmt::format("Overlap with deposit outline {}", i + 1)), "",
            1, o.uncertainty);
        all.back().most = 1;
    }
    for (std::size_t i = 0; i < spec.affected_areas.size(); ++i) {
        const params::OutlineSpec& o = spec.affected_areas[i];
        add("affected_area", i, "overlap", label(o.name, fmt::format("Overlap with affected area {}", i + 1)), "", 1,
            o.uncertainty);
        all.back().most = 1;
    }
    for (std::size_t i = 0; i < spec.elevation_changes.size(); ++i) {
        const params::ElevationChangeSpec& o = spec.elevation_changes[i];
        add("elevation_change", i, "agreement", label(o.name, fmt::format("Agreement with elevation change {}", i + 1)),
            "", 1, o.uncertainty);
        all.back().most = 1;
    }
    return all;
}

std::vector<double> predicted_values(const scene::Scene& scene, const observe::Observation& run) {
    const params::SceneSpec& spec = scene.spec;
    std::vector<double> all;
    for (const auto& o : spec.observations) all.push_back(computed_for(o, run));
    for (const auto& o : spec.superelevations) all.push_back(predict_debris_speed(run, o.chainage));
    for (const auto& o : spec.arrivals) all.push_back(predict_arrival_time(run, o.chainage));
    for (const auto& o : spec.run_ups) all.push_back(predict_run_up(run, scene.terrain, {o.x, o.y}));
    for (const auto& o : spec.deposit_depths) all.push_back(predict_deposit_depth(run, {o.x, o.y}));
    for (const auto& o : spec.damages) all.push_back(predict_building_pressure(run, o.building));
    for (std::size_t i = 0; i < spec.observed_run_outs.size(); ++i) all.push_back(predict_front_chainage(run));
    for (std::size_t i = 0; i < spec.deposit_outlines.size(); ++i) {
        all.push_back(
            predict_outline_overlap(run.maps.deposit_depth, scene.deposit_outlines[i], spec.deposit_outlines[i].depth));
    }
    for (std::size_t i = 0; i < spec.affected_areas.size(); ++i) {
        all.push_back(
            predict_outline_overlap(run.maps.peak_depth, scene.affected_areas[i], spec.affected_areas[i].depth));
    }
    for (std::size_t i = 0; i < spec.elevation_changes.size(); ++i) {
        all.push_back(predict_elevation_agreement(run, scene.elevation_changes[i], scene.releases,
                                                  spec.elevation_changes[i].detection_limit));
    }
    return all;
}

double deviation_of(const ObservedValue& observed, double predicted) {
    const double deviation = (predicted - observed.value) / observed.uncertainty;
    if (observed.kind == ObservedValue::Kind::at_least) return std::min(0.0, deviation);
    if (observed.kind == ObservedValue::Kind::below) return std::max(0.0, deviation);
    return deviation;
}

}  // namespace talus::ensemble
