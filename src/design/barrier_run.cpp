#include "design/barrier_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <exception>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/number_or_null.hpp"
#include "core/try.hpp"
#include "observe/barrier_line.hpp"
#include "products/checked_file.hpp"
#include "scene/load.hpp"
#include "terrain/barrier.hpp"

namespace talus::design {
namespace {

using Json = nlohmann::ordered_json;
constexpr products::CheckedFileKind run_file{"talus barrier 1 ", "record of a barrier"};

constexpr double wing_share = 0.5;  ///< of the line's length, beyond each of its ends

/// From the end of a line onwards in its direction, as far as the ground is known; fewer than two points: not at all.
std::vector<PlanPoint> wing(const terrain::Terrain& terrain, const PlanPoint& from, const PlanPoint& end,
                            double length) {
    const double d = std::hypot(end.x - from.x, end.y - from.y);
    const auto at = [&](double s) {
        return PlanPoint{end.x + s * (end.x - from.x) / d, end.y + s * (end.y - from.y) / d};
    };
    const double step = std::min(terrain.cell() / 2, length / 4);
    double known = 0;
    while (known + step <= length && !std::isnan(terrain.elevation_at(at(known + step)))) known += step;
    if (!(known > 0)) return {};
    return {end, at(known)};
}

Status check_releases(const scene::Scene& scene, const terrain::Building& barrier) {
    for (const terrain::Release& release : scene.releases) {
        const double area = scene::shared_area(release, barrier);
        if (!(area > 0)) continue;
        return Error{
            fmt::format("line of barrier \"{}\": stands on release \"{}\" with {:.3g} m2: the ground under it "
                        "fails; move the line",
                        barrier.name, release.name, area)};
    }
    return {};
}

using Number = std::pair<const char*, double BarrierRun::*>;
constexpr std::array<Number, 14> numbers = {{{"released_m3", &BarrierRun::released},
                                             {"over_m3", &BarrierRun::over},
                                             {"through_m3", &BarrierRun::through},
                                             {"around_m3", &BarrierRun::around},
                                             {"crossed_m3", &BarrierRun::crossed},
                                             {"first_over_s", &BarrierRun::first_over},
                                             {"retained_m3", &BarrierRun::retained},
                                             {"filling_m", &BarrierRun::filling},
                                             {"run_up_m", &BarrierRun::run_up},
                                             {"force_N", &BarrierRun::force},
                                             {"pressure_Pa", &BarrierRun::pressure},
                                             {"speed_mps", &BarrierRun::speed},
                                             {"depth_m", &BarrierRun::depth},
                                             {"peak_discharge_m3ps", &BarrierRun::peak_discharge}}};

}  // namespace

Status place_barrier(scene::Scene& scene, const std::string& barrier, const SiteLine& line, double height) {
    const auto found = std::find_if(scene.buildings.begin(), scene.buildings.end(), [&](const terrain::Building& b) {
        return b.barrier.has_value() && b.name == barrier;
    });
    if (found == scene.buildings.end()) return Error{fmt::format("there is no barrier \"{}\"", barrier)};
    const auto index = static_cast<std::size_t>(found - scene.buildings.begin());
    const std::size_t own = scene.buildings.size() - scene.barrier_sections.size();
    if (height > 0) {
        params::BarrierSpec shape = *found->barrier;
        shape.line = line.points;
        shape.height = height;
        shape.crest_elevation.reset();
        shape.resistance_force.reset();  // a design bears the load
        shape.resistance_pressure.reset();
        TALUS_ASSIGN(terrain::Building made, make_barrier(scene.terrain, barrier, shape));
        TALUS_TRY(check_releases(scene, made));
        *found = std::move(made);
    } else {
        scene.buildings.erase(found);
        scene.barrier_sections.erase(scene.barrier_sections.begin() + static_cast<std::ptrdiff_t>(index - own));
    }
    constexpr double interval = 1;  // s
    const std::vector<PlanPoint>& points = line.points;
    const double length = wing_share * terrain::length_of(points);
    std::vector<PlanPoint> left = wing(scene.terrain, points[1], points.front(), length);
    std::reverse(left.begin(), left.end());  // in the direction of the line
    const std::vector<PlanPoint> right = wing(scene.terrain, points[points.size() - 2], points.back(), length);
    scene.cross_sections.push_back({line_section, points, interval});
    if (left.size() == 2) scene.cross_sections.push_back({left_section, left, interval});
    if (right.size() == 2) scene.cross_sections.push_back({right_section, right, interval});
    return {};
}

BarrierRun barrier_run(const run::RunResult& result, const std::string& barrier, const SiteLine& line,
                       double arrival_depth) {
    const observe::Observation& o = result.observation;
    BarrierRun made;
    made.released = o.volume_released;
    for (const observe::DischargeRecord& section : o.cross_sections) {
        const std::string& name = section.section.name;
        if (name == line_section) {
            made.crossed += std::abs(section.passed);
            made.peak_discharge = std::abs(section.peak_discharge);
            made.discharge = section.rows;
        } else if (name == left_section || name == right_section) {
            made.crossed += std::abs(section.passed);
            made.around += std::abs(section.passed);
        }
    }
    const auto found = std::find_if(o.buildings.begin(), o.buildings.end(),
                                    [&](const auto& b) { return b.is_barrier && b.name == barrier; });
    if (found != o.buildings.end()) {
        made.crossed = made.peak_discharge = 0;
        made.discharge.clear();
        made.over = std::max(0.0, found->overtopped_volume);
        made.through = std::max(0.0, found->passed_volume);
        made.first_over = found->first_overtopping_time;
        made.retained = found->peak_retained_volume;
        made.filling = found->peak_filling_height;
        made.run_up = found->peak_depth;
        made.force = found->peak_force;
        made.pressure = found->peak_impact_pressure;
        made.history = found->history;
        return made;
    }
    made.around = 0;  // of a barrier that is not there
    const double length = terrain::length_of(line.points);
    const double step = o.maps.peak_depth.geometry.cell / 4;
    for (double s = 0; step > 0 && s <= length; s += step) {
        const PlanPoint p = observe::point_at(line.points, s);
        const auto depth = static_cast<double>(value_at(o.maps.peak_depth, p));
        if (!(depth >= arrival_depth)) continue;
        made.depth = std::max(made.depth, depth);
        const auto speed = static_cast<double>(value_at(o.maps.peak_speed, p));
        if (speed > made.speed) made.speed = speed;
    }
    return made;
}

Status write_barrier_run(const std::filesystem::path& file, const BarrierRun& run) {
    Json json;
    for (const auto& [key, member] : numbers) {
        json[key] = number_or_null<Json>(run.*member);
    }
    json["history"] = Json::array();
    for (const observe::StructureSample& s : run.history) {
        json["history"].push_back({s.time, s.force, s.impact_pressure, s.depth, s.overtopped_volume, s.passed_volume,
                                   s.retained_volume, s.filling_height});
    }
    json["discharge"] = Json::array();
    for (const observe::DischargeSample& s : run.discharge)
        json["discharge"].push_back({s.time, s.discharge, s.passed});
    return write_checked_file(file, run_file, json.dump());
}

Result<BarrierRun> read_barrier_run(const std::filesystem::path& file) {
    TALUS_ASSIGN(const std::string text, read_checked_file(file, run_file));
    try {
        const Json json = Json::parse(text);
        BarrierRun run;
        for (const auto& [key, member] : numbers) {
            run.*member = json.at(key).is_number() ? json.at(key).get<double>() : observe::never;
        }
        for (const Json& row : json.at("history")) {
            observe::StructureSample s;
            const std::array<double*, 8> values = {
                &s.time,          &s.force,           &s.impact_pressure, &s.depth, &s.overtopped_volume,
                &s.passed_volume, &s.retained_volume, &s.filling_height};
            for (std::size_t k = 0; k < values.size(); ++k)
                *values.at(k) = row.at(k).is_number() ? row.at(k).get<double>() : 0;
            run.history.push_back(s);
        }
        for (const Json& row : json.at("discharge")) {
            run.discharge.push_back({row.at(0).get<double>(), row.at(1).get<double>(), row.at(2).get<double>()});
        }
        return run;
    } catch (const std::exception&) {
        return Error{file.string() + ": is no record of a barrier"};
    }
}

}  // namespace talus::design
