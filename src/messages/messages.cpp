// Made from src/messages/protocol.json: edit that; docs/protocol.md tells how this is made again.
// clang-format off
#include "messages/messages.hpp"

#include <cmath>
#include <utility>

namespace talus::messages {
namespace {

using nlohmann::json;

struct Written {
    static json of(double number) { return std::isfinite(number) ? json(number) : json(); }
    static json of(const Integer& whole) { return whole.value; }
    template <class Value>
    static json of(const Value& value) {
        return value;
    }
    template <class Value>
    static json of(const std::optional<Value>& value) {
        return value ? of(*value) : json();
    }
    template <class Value>
    static json of(const std::vector<Value>& values) {
        json list = json::array();
        for (const Value& value : values) list.push_back(of(value));
        return list;
    }
    template <class Value>
    static json of(const std::map<std::string, Value>& values) {
        json object = json::object();
        for (const auto& [key, value] : values) object[key] = of(value);
        return object;
    }
};

template <class Value>
void put(json& to, const char* key, const Value& value) {
    to[key] = Written::of(value);
}

template <class Value>
void put_if_there(json& to, const char* key, const std::optional<Value>& value) {
    if (value) put(to, key, *value);
}

}  // namespace

std::optional<std::string> if_any(std::string text) {
    return text.empty() ? std::nullopt : std::optional(std::move(text));
}

void to_json(json& to, const Person& from) {
    to = json::object();
    put(to, "id", from.id);
    put(to, "name", from.name);
    put(to, "role", from.role);
    put(to, "colour", from.colour);
    put(to, "mark", from.mark);
}

void to_json(json& to, const ControlRequest& from) {
    to = json::object();
    put(to, "id", from.id);
    put(to, "name", from.name);
}

void to_json(json& to, const Session::You& from) {
    to = json::object();
    put(to, "role", from.role);
}

void to_json(json& to, const Session::Links& from) {
    to = json::object();
    put_if_there(to, "viewer", from.viewer);
    put_if_there(to, "controller", from.controller);
}

void to_json(json& to, const Session& from) {
    to = json::object();
    put(to, "protocol", from.protocol);
    put(to, "id", from.id);
    put(to, "program", from.program);
    put(to, "title", from.title);
    put(to, "you", from.you);
    put(to, "scenarios", from.scenarios);
    put(to, "people", from.people);
    put(to, "controller", from.controller);
    put(to, "request", from.request);
    put(to, "links", from.links);
}

void to_json(json& to, const SharedLink& from) {
    to = json::object();
    put(to, "host", from.host);
    put(to, "encrypted", from.encrypted);
    put(to, "viewer_url", from.viewer_url);
    put(to, "controller_url", from.controller_url);
}

void to_json(json& to, const Share& from) {
    to = json::object();
    put(to, "shared", from.shared);
    put(to, "addresses", from.addresses);
}

void to_json(json& to, const MapGrid& from) {
    to = json::object();
    put(to, "x_min_m", from.x_min_m);
    put(to, "y_min_m", from.y_min_m);
    put(to, "cell_m", from.cell_m);
    put(to, "columns", from.columns);
    put(to, "rows", from.rows);
}

void to_json(json& to, const FlowPath& from) {
    to = json::object();
    put(to, "points", from.points);
    put(to, "chainage_m", from.chainage_m);
    put(to, "corridor_width_m", from.corridor_width_m);
    put(to, "traced", from.traced);
}

void to_json(json& to, const TableKey& from) {
    to = json::object();
    put(to, "key", from.key);
    put(to, "label", from.label);
    put(to, "unit", from.unit);
    put(to, "is", from.is);
    put(to, "required", from.required);
    put(to, "default", from.default_);
    put(to, "absent", from.absent);
    put(to, "allowed", from.allowed);
    put(to, "help", from.help);
}

void to_json(json& to, const TableSection& from) {
    to = json::object();
    put(to, "section", from.section);
    put(to, "kind", from.kind);
    put(to, "help", from.help);
    put(to, "keys", from.keys);
    put(to, "one_of", from.one_of);
}

void to_json(json& to, const GaugePlace& from) {
    to = json::object();
    put(to, "name", from.name);
    put(to, "x_m", from.x_m);
    put(to, "y_m", from.y_m);
    put(to, "chainage_m", from.chainage_m);
}

void to_json(json& to, const SectionPlace& from) {
    to = json::object();
    put(to, "name", from.name);
    put(to, "line", from.line);
}

void to_json(json& to, const ParameterRange& from) {
    to = json::object();
    put(to, "low", from.low);
    put(to, "high", from.high);
    put(to, "low_included", from.low_included);
    put(to, "high_included", from.high_included);
}

void to_json(json& to, const Parameter& from) {
    to = json::object();
    put(to, "key", from.key);
    put(to, "label", from.label);
    put(to, "unit", from.unit);
    put(to, "default", from.default_);
    put(to, "value", from.value);
    put(to, "range", from.range);
    put(to, "help", from.help);
    put(to, "used_by_depth_averaged", from.used_by_depth_averaged);
}

void to_json(json& to, const Category& from) {
    to = json::object();
    put(to, "name", from.name);
    put(to, "colour", from.colour);
}

void to_json(json& to, const IntensityClass& from) {
    to = from.category;
    put(to, "criterion", from.criterion);
}

void to_json(json& to, const IntensityGuideline& from) {
    to = json::object();
    put(to, "guideline", from.guideline);
    put(to, "classes", from.classes);
    put(to, "rule", from.rule);
    put(to, "source", from.source);
}

void to_json(json& to, const SceneInfo& from) {
    to = json::object();
    put(to, "title", from.title);
    put(to, "description", from.description);
    put(to, "reconstruction", from.reconstruction);
    put(to, "assumptions", from.assumptions);
    put(to, "sources", from.sources);
    put(to, "crs", from.crs);
    put(to, "crs_name", from.crs_name);
    put(to, "vertical_unit", from.vertical_unit);
    put(to, "latitude_deg", from.latitude_deg);
    put(to, "origin", from.origin);
    put(to, "extent_m", from.extent_m);
    put(to, "elevation_m", from.elevation_m);
    put(to, "map", from.map);
    put(to, "orthophoto", from.orthophoto);
    put(to, "particle_spacing_m", from.particle_spacing_m);
    put(to, "end_time_s", from.end_time_s);
    put(to, "gravity_mps2", from.gravity_mps2);
    put(to, "flow_path", from.flow_path);
    put(to, "table_sections", from.table_sections);
    put(to, "gauges", from.gauges);
    put(to, "cross_sections", from.cross_sections);
    put(to, "parameters", from.parameters);
    put(to, "settings", from.settings);
    put(to, "intensity", from.intensity);
}

void to_json(json& to, const Overlay& from) {
    to = json::object();
    put(to, "id", from.id);
    put(to, "name", from.name);
    put(to, "kind", from.kind);
    put(to, "by", from.by);
    put(to, "visible", from.visible);
    put(to, "opacity", from.opacity);
    put(to, "colour", from.colour);
    put(to, "features", from.features);
    put(to, "outside", from.outside);
    put(to, "styled", from.styled);
    put(to, "low", from.low);
    put(to, "high", from.high);
    put(to, "note", from.note);
    put(to, "bytes", from.bytes);
}

void to_json(json& to, const TileAddress& from) {
    to = json::object();
    put(to, "id", from.id);
    put(to, "address", from.address);
    put(to, "by", from.by);
}

void to_json(json& to, const Overlays& from) {
    to = json::object();
    put(to, "overlays", from.overlays);
    put(to, "removed", from.removed);
    put(to, "tiles", from.tiles);
    put(to, "bytes_left", from.bytes_left);
}

void to_json(json& to, const Done& from) {
    to = json::object();
    put(to, "done", from.done);
    put(to, "created", from.created);
}

void to_json(json& to, const Tiles& from) {
    to = json::object();
    put(to, "addresses", from.addresses);
    put(to, "steps", from.steps);
    put(to, "degrees", from.degrees);
}

void to_json(json& to, const EnsembleFactor& from) {
    to = json::object();
    put(to, "key", from.key);
    put(to, "distribution", from.distribution);
}

void to_json(json& to, const EnsembleMap& from) {
    to = json::object();
    put(to, "name", from.name);
    put(to, "title", from.title);
    put(to, "unit", from.unit);
    put(to, "kind", from.kind);
    put(to, "of", from.of);
    put(to, "description", from.description);
    put(to, "threshold", from.threshold);
    put(to, "threshold_unit", from.threshold_unit);
    put(to, "percentile", from.percentile);
    put(to, "categories", from.categories);
    put(to, "greatest", from.greatest);
}

void to_json(json& to, const Ensemble& from) {
    to = json::object();
    put(to, "id", from.id);
    put(to, "name", from.name);
    put(to, "runs", from.runs);
    put(to, "failed", from.failed);
    put(to, "factors", from.factors);
    put(to, "same_terrain", from.same_terrain);
    put(to, "maps", from.maps);
}

void to_json(json& to, const Ensembles& from) {
    to = json::object();
    put(to, "ensembles", from.ensembles);
}

void to_json(json& to, const CalibratedObservation& from) {
    to = json::object();
    put(to, "name", from.name);
    put(to, "unit", from.unit);
    put(to, "observed", from.observed);
    put(to, "uncertainty", from.uncertainty);
    put(to, "is", from.is);
    put(to, "best", from.best);
    put(to, "deviation", from.deviation);
}

void to_json(json& to, const CalibratedParameter& from) {
    to = json::object();
    put(to, "key", from.key);
    put(to, "label", from.label);
    put(to, "unit", from.unit);
    put(to, "low", from.low);
    put(to, "high", from.high);
}

void to_json(json& to, const CalibrationRun& from) {
    to = json::object();
    put(to, "values", from.values);
    put(to, "phase", from.phase);
    put(to, "misfit", from.misfit);
}

void to_json(json& to, const MisfitMap& from) {
    to = json::object();
    put(to, "columns", from.columns);
    put(to, "rows", from.rows);
    put(to, "misfit", from.misfit);
}

void to_json(json& to, const BestRun& from) {
    to = json::object();
    put(to, "run", from.run);
    put(to, "values", from.values);
    put(to, "misfit", from.misfit);
}

void to_json(json& to, const FoundParameter& from) {
    to = json::object();
    put(to, "key", from.key);
    put(to, "best", from.best);
    put(to, "median", from.median);
    put(to, "low_95", from.low_95);
    put(to, "high_95", from.high_95);
    put(to, "share_of_prior_width", from.share_of_prior_width);
}

void to_json(json& to, const CalibrationResult& from) {
    to = json::object();
    put(to, "settled", from.settled);
    put(to, "checks_within_95", from.checks_within_95);
    put(to, "parameters", from.parameters);
    put(to, "warnings", from.warnings);
}

void to_json(json& to, const CalibrationStatus& from) {
    to = json::object();
    put(to, "state", from.state);
    put(to, "why_not", from.why_not);
    put(to, "by", from.by);
    put(to, "message", from.message);
    put(to, "observations", from.observations);
    put(to, "parameters", from.parameters);
    put(to, "phase", from.phase);
    put(to, "runs_at_most", from.runs_at_most);
    put(to, "runs_failed", from.runs_failed);
    put(to, "fast_runs", from.fast_runs);
    put(to, "fast_runs_at_most", from.fast_runs_at_most);
    put(to, "wall_remaining_s", from.wall_remaining_s);
    put(to, "runs", from.runs);
    put(to, "map", from.map);
    put(to, "best", from.best);
    put(to, "result", from.result);
}

void to_json(json& to, const Listening& from) {
    to = json::object();
    put(to, "http", from.http);
    put(to, "mqtt", from.mqtt);
}

void to_json(json& to, const Trigger& from) {
    to = json::object();
    put(to, "name", from.name);
    put(to, "limits", from.limits);
}

void to_json(json& to, const GaugeValue& from) {
    to = json::object();
    put(to, "discharge_m3ps", from.discharge_m3ps);
    put(to, "received_at", from.received_at);
}

void to_json(json& to, const TriggeredRun& from) {
    to = json::object();
    put(to, "scenario", from.scenario);
    put(to, "trigger", from.trigger);
    put(to, "source", from.source);
    put(to, "received_at", from.received_at);
    put(to, "reason", from.reason);
    put(to, "values", from.values);
    put(to, "reading", from.reading);
}

void to_json(json& to, const RaisedAlarm& from) {
    to = json::object();
    put(to, "scenario", from.scenario);
    put(to, "alarm", from.alarm);
    put(to, "sentence", from.sentence);
    put(to, "message", from.message);
    put(to, "time_s", from.time_s);
    put(to, "expected_s", from.expected_s);
    put(to, "step", from.step);
    put(to, "hash", from.hash);
    put(to, "raised_at", from.raised_at);
    put(to, "delivery", from.delivery);
}

void to_json(json& to, const AlertNote& from) {
    to = json::object();
    put(to, "at", from.at);
    put(to, "sentence", from.sentence);
}

void to_json(json& to, const Alerts& from) {
    to = json::object();
    put(to, "listening", from.listening);
    put(to, "triggers", from.triggers);
    put(to, "runs", from.runs);
    put(to, "alarms", from.alarms);
    put(to, "notes", from.notes);
}

void to_json(json& to, const TriggerAnswer& from) {
    to = json::object();
    put(to, "done", from.done);
    put(to, "scenario", from.scenario);
    put(to, "started", from.started);
}

void to_json(json& to, const NewScenario& from) {
    to = json::object();
    put(to, "done", from.done);
    put(to, "created", from.created);
    put(to, "object", from.object);
}

void to_json(json& to, const RecordingExtent& from) {
    to = json::object();
    put(to, "first_s", from.first_s);
    put(to, "last_s", from.last_s);
    put(to, "frames", from.frames);
    put(to, "bytes", from.bytes);
}

void to_json(json& to, const RunState& from) {
    to = json::object();
    put(to, "status", from.status);
    put(to, "message", from.message);
    put(to, "time_s", from.time_s);
    put(to, "end_time_s", from.end_time_s);
    put(to, "expected_end_s", from.expected_end_s);
    put(to, "wall_remaining_s", from.wall_remaining_s);
    put(to, "step", from.step);
    put(to, "particles", from.particles);
    put(to, "volume_released_m3", from.volume_released_m3);
    put(to, "volume_entrained_m3", from.volume_entrained_m3);
    put(to, "pore_pressure", from.pore_pressure);
    put(to, "volume_held_m3", from.volume_held_m3);
    put(to, "volume_moving_m3", from.volume_moving_m3);
    put(to, "volume_deposited_m3", from.volume_deposited_m3);
    put(to, "volume_left_m3", from.volume_left_m3);
    put(to, "front_chainage_m", from.front_chainage_m);
    put(to, "front_velocity_mps", from.front_velocity_mps);
    put(to, "largest_speed_mps", from.largest_speed_mps);
    put(to, "peak_speed_mps", from.peak_speed_mps);
    put(to, "mean_compression", from.mean_compression);
    put(to, "max_compression", from.max_compression);
    put(to, "overcompressed_share", from.overcompressed_share);
    put(to, "too_compressed", from.too_compressed);
    put(to, "verdict", from.verdict);
    put(to, "recording", from.recording);
    put_if_there(to, "hash", from.hash);
}

void to_json(json& to, const Preparation& from) {
    to = json::object();
    put(to, "what", from.what);
    put(to, "share", from.share);
}

void to_json(json& to, const State& from) {
    to = from.run_state;
    put(to, "scenario", from.scenario);
    put(to, "speed_factor", from.speed_factor);
    put(to, "real_time_factor", from.real_time_factor);
    put(to, "steps_per_second", from.steps_per_second);
    put(to, "preparing", from.preparing);
}

void to_json(json& to, const ChangeOnTheWay& from) {
    to = json::object();
    put(to, "time_s", from.time_s);
    put(to, "by", from.by);
    put(to, "sentence", from.sentence);
}

void to_json(json& to, const Recording& from) {
    to = json::object();
    put(to, "times_s", from.times_s);
    put(to, "bytes", from.bytes);
}

void to_json(json& to, const Figures& from) {
    to = json::object();
    put(to, "figures", from.figures);
}

void to_json(json& to, const DepthAveragedFront& from) {
    to = json::object();
    put(to, "chainage_m", from.chainage_m);
    put(to, "arrival_time_s", from.arrival_time_s);
    put(to, "front_velocity_mps", from.front_velocity_mps);
}

void to_json(json& to, const DepthAveragedResult& from) {
    to = json::object();
    put(to, "end_s", from.end_s);
    put(to, "complete", from.complete);
    put(to, "stop_reason", from.stop_reason);
    put(to, "verdict", from.verdict);
    put(to, "wall_time_s", from.wall_time_s);
    put(to, "processor_time_s", from.processor_time_s);
    put(to, "grid_cell_m", from.grid_cell_m);
    put(to, "hash", from.hash);
    put(to, "notes", from.notes);
    put(to, "front", from.front);
}

void to_json(json& to, const DepthAveragedStatus& from) {
    to = json::object();
    put(to, "scenario", from.scenario);
    put(to, "state", from.state);
    put(to, "message", from.message);
    put(to, "share", from.share);
    put(to, "result", from.result);
}

void to_json(json& to, const DepthAveragedRow& from) {
    to = json::object();
    put(to, "key", from.key);
    put(to, "name", from.name);
    put(to, "unit", from.unit);
    put(to, "decimals", from.decimals);
    put(to, "particles", from.particles);
    put(to, "depth_averaged_by_then", from.depth_averaged_by_then);
    put(to, "depth_averaged", from.depth_averaged);
    put(to, "observed", from.observed);
}

void to_json(json& to, const AffectedArea& from) {
    to = json::object();
    put(to, "both_m2", from.both_m2);
    put(to, "particles_only_m2", from.particles_only_m2);
    put(to, "depth_averaged_only_m2", from.depth_averaged_only_m2);
    put(to, "intersection_over_union", from.intersection_over_union);
}

void to_json(json& to, const DepthAveragedComparison& from) {
    to = json::object();
    put(to, "time_s", from.time_s);
    put(to, "over", from.over);
    put(to, "rows", from.rows);
    put(to, "least_depth_m", from.least_depth_m);
    put(to, "area", from.area);
    put(to, "differs", from.differs);
}

void to_json(json& to, const FrontSeries& from) {
    to = json::object();
    put(to, "chainage_m", from.chainage_m);
    put(to, "arrival_time_s", from.arrival_time_s);
    put(to, "front_velocity_mps", from.front_velocity_mps);
    put(to, "particle_speed_mps", from.particle_speed_mps);
}

void to_json(json& to, const GaugeSeries& from) {
    to = json::object();
    put(to, "time_s", from.time_s);
    put(to, "depth_m", from.depth_m);
}

void to_json(json& to, const Series& from) {
    to = json::object();
    put(to, "time", from.time);
    put(to, "front", from.front);
    put(to, "gauges", from.gauges);
}

void to_json(json& to, const Impact& from) {
    to = json::object();
    put(to, "id", from.id);
    put(to, "name", from.name);
    put(to, "hit", from.hit);
    put(to, "first_hit_s", from.first_hit_s);
    put(to, "peak_force_kN", from.peak_force_kN);
    put(to, "peak_impact_pressure_kPa", from.peak_impact_pressure_kPa);
    put(to, "peak_depth_m", from.peak_depth_m);
    put(to, "peak_speed_mps", from.peak_speed_mps);
    put(to, "peak_dynamic_pressure_kPa", from.peak_dynamic_pressure_kPa);
    put(to, "impulse_kNs", from.impulse_kNs);
    put(to, "failed_s", from.failed_s);
    put(to, "intensity", from.intensity);
}

void to_json(json& to, const BarrierImpact& from) {
    to = from.impact;
    put(to, "overtopped_m3", from.overtopped_m3);
    put(to, "first_overtopped_s", from.first_overtopped_s);
    put(to, "passed_m3", from.passed_m3);
    put(to, "retained_m3", from.retained_m3);
    put(to, "peak_filling_height_m", from.peak_filling_height_m);
}

void to_json(json& to, const RemovedImpact& from) {
    to = from.impact;
    put(to, "kind", from.kind);
    put(to, "removed_s", from.removed_s);
    put_if_there(to, "overtopped_m3", from.overtopped_m3);
    put_if_there(to, "first_overtopped_s", from.first_overtopped_s);
    put_if_there(to, "passed_m3", from.passed_m3);
    put_if_there(to, "retained_m3", from.retained_m3);
    put_if_there(to, "peak_filling_height_m", from.peak_filling_height_m);
}

void to_json(json& to, const Impacts& from) {
    to = json::object();
    put(to, "buildings", from.buildings);
    put(to, "barriers", from.barriers);
    put(to, "removed", from.removed);
}

void to_json(json& to, const ObservedRow& from) {
    to = json::object();
    put(to, "id", from.id);
    put(to, "name", from.name);
    put(to, "unit", from.unit);
    put(to, "observed", from.observed);
    put(to, "uncertainty", from.uncertainty);
    put(to, "is", from.is);
    put(to, "computed", from.computed);
    put(to, "deviation", from.deviation);
}

void to_json(json& to, const Observed& from) {
    to = json::object();
    put(to, "time_s", from.time_s);
    put(to, "rows", from.rows);
}

void to_json(json& to, const GaugeReading& from) {
    to = json::object();
    put(to, "name", from.name);
    put(to, "arrival_s", from.arrival_s);
    put(to, "depth_m", from.depth_m);
    put(to, "speed_mps", from.speed_mps);
    put(to, "peak_depth_m", from.peak_depth_m);
    put(to, "peak_speed_mps", from.peak_speed_mps);
}

void to_json(json& to, const SectionReading& from) {
    to = json::object();
    put(to, "name", from.name);
    put(to, "discharge_m3ps", from.discharge_m3ps);
    put(to, "peak_discharge_m3ps", from.peak_discharge_m3ps);
    put(to, "passed_m3", from.passed_m3);
}

void to_json(json& to, const GaugeReadings& from) {
    to = json::object();
    put(to, "gauges", from.gauges);
    put(to, "cross_sections", from.cross_sections);
}

void to_json(json& to, const ProbeSeries& from) {
    to = json::object();
    put(to, "time_s", from.time_s);
    put(to, "depth_m", from.depth_m);
    put(to, "speed_mps", from.speed_mps);
    put(to, "pressure_kPa", from.pressure_kPa);
    put(to, "pore_pressure_ratio", from.pore_pressure_ratio);
}

void to_json(json& to, const ExportFile& from) {
    to = json::object();
    put(to, "name", from.name);
    put(to, "bytes", from.bytes);
    put(to, "what", from.what);
}

void to_json(json& to, const ExportFiles& from) {
    to = json::object();
    put(to, "files", from.files);
}

void to_json(json& to, const FlowFormatOffer& from) {
    to = json::object();
    put(to, "name", from.name);
    put(to, "what", from.what);
    put(to, "files", from.files);
    put(to, "frames", from.frames);
    put(to, "bytes", from.bytes);
    put(to, "refused", from.refused);
}

void to_json(json& to, const FlowOffer& from) {
    to = json::object();
    put(to, "scenario", from.scenario);
    put(to, "from_s", from.from_s);
    put(to, "to_s", from.to_s);
    put(to, "frames", from.frames);
    put(to, "interval_s", from.interval_s);
    put(to, "shortest_interval_s", from.shortest_interval_s);
    put(to, "formats", from.formats);
}

void to_json(json& to, const FlowFile& from) {
    to = json::object();
    put(to, "name", from.name);
    put(to, "bytes", from.bytes);
}

void to_json(json& to, const FlowExport& from) {
    to = json::object();
    put(to, "state", from.state);
    put(to, "scenario", from.scenario);
    put(to, "share", from.share);
    put(to, "message", from.message);
    put(to, "files", from.files);
}

void to_json(json& to, const NoStartPage& from) {
    to = json::object();
    put(to, "available", from.available);
}

void to_json(json& to, const UploadLimits& from) {
    to = json::object();
    put(to, "bytes", from.bytes);
    put(to, "files", from.files);
    put(to, "cells", from.cells);
}

void to_json(json& to, const KnownScene& from) {
    to = json::object();
    put(to, "id", from.id);
    put(to, "title", from.title);
    put(to, "kind", from.kind);
    put(to, "file", from.file);
    put(to, "opened_at", from.opened_at);
    put(to, "missing", from.missing);
}

void to_json(json& to, const SavedSession& from) {
    to = json::object();
    put(to, "id", from.id);
    put(to, "name", from.name);
    put(to, "title", from.title);
    put(to, "saved_at", from.saved_at);
    put(to, "scenarios", from.scenarios);
}

void to_json(json& to, const Job& from) {
    to = json::object();
    put(to, "id", from.id);
    put(to, "kind", from.kind);
    put(to, "state", from.state);
    put(to, "title", from.title);
    put(to, "message", from.message);
    put(to, "begun_at", from.begun_at);
    put(to, "ended_at", from.ended_at);
    put(to, "done", from.done);
    put(to, "failed", from.failed);
    put(to, "count", from.count);
    put(to, "wall_remaining_s", from.wall_remaining_s);
    put(to, "command", from.command);
    put(to, "folder", from.folder);
    put(to, "report", from.report);
}

void to_json(json& to, const StartPage::Open& from) {
    to = json::object();
    put(to, "title", from.title);
}

void to_json(json& to, const StartPage& from) {
    to = json::object();
    put(to, "available", from.available);
    put(to, "open", from.open);
    put(to, "opening", from.opening);
    put(to, "error", from.error);
    put(to, "count", from.count);
    put(to, "notes", from.notes);
    put(to, "program", from.program);
    put(to, "role", from.role);
    put_if_there(to, "folder", from.folder);
    put_if_there(to, "uploads", from.uploads);
    put_if_there(to, "scenes", from.scenes);
    put_if_there(to, "sessions", from.sessions);
    put_if_there(to, "jobs", from.jobs);
}

void to_json(json& to, const DraftFile& from) {
    to = json::object();
    put(to, "name", from.name);
    put(to, "bytes", from.bytes);
    put(to, "kind", from.kind);
}

void to_json(json& to, const MendingOfTerrain& from) {
    to = json::object();
    put(to, "epsg", from.epsg);
    put(to, "local", from.local);
    put(to, "metric", from.metric);
    put(to, "metres_per_unit", from.metres_per_unit);
    put(to, "nodata", from.nodata);
}

void to_json(json& to, const DraftTerrain& from) {
    to = json::object();
    put(to, "problem", from.problem);
    put(to, "columns", from.columns);
    put(to, "rows", from.rows);
    put(to, "crs", from.crs);
    put(to, "metric_crs", from.metric_crs);
    put(to, "value_unit", from.value_unit);
    put(to, "height_unit_m", from.height_unit_m);
    put_if_there(to, "cell_m", from.cell_m);
    put_if_there(to, "nodata_share", from.nodata_share);
    put_if_there(to, "elevation_m", from.elevation_m);
    put(to, "mending", from.mending);
}

void to_json(json& to, const Draft& from) {
    to = json::object();
    put(to, "files", from.files);
    put(to, "terrain", from.terrain);
    put(to, "bytes_left", from.bytes_left);
}

void to_json(json& to, const Checked& from) {
    to = json::object();
    put(to, "summary", from.summary);
    put(to, "notes", from.notes);
    put(to, "created", from.created);
}

void to_json(json& to, const JobLimits& from) {
    to = json::object();
    put(to, "runs", from.runs);
    put(to, "ensemble_factors", from.ensemble_factors);
    put(to, "calibration_factors", from.calibration_factors);
}

void to_json(json& to, const JobForm& from) {
    to = json::object();
    put(to, "title", from.title);
    put(to, "parameters", from.parameters);
    put(to, "observations", from.observations);
    put(to, "events", from.events);
    put(to, "options", from.options);
    put(to, "barriers", from.barriers);
    put(to, "limits", from.limits);
}

void to_json(json& to, const JobEstimate& from) {
    to = json::object();
    put(to, "run_s", from.run_s);
    put(to, "particles", from.particles);
    put(to, "memory_bytes", from.memory_bytes);
    put(to, "cores", from.cores);
}

void to_json(json& to, const ValidationCase& from) {
    to = json::object();
    put(to, "name", from.name);
    put(to, "title", from.title);
    put(to, "quick", from.quick);
}

void to_json(json& to, const ValidationCases& from) {
    to = json::object();
    put(to, "cases", from.cases);
}

void to_json(json& to, const SavedScenario& from) {
    to = json::object();
    put(to, "name", from.name);
    put(to, "title", from.title);
    put(to, "journal", from.journal);
}

void to_json(json& to, const SavedOverlay& from) {
    to = from.overlay;
    put(to, "type", from.type);
    put(to, "data", from.data);
}

void to_json(json& to, const SavedTiles& from) {
    to = json::object();
    put(to, "address", from.address);
    put(to, "by", from.by);
}

void to_json(json& to, const SessionFile& from) {
    to = json::object();
    put(to, "talus_session", from.talus_session);
    put(to, "name", from.name);
    put(to, "title", from.title);
    put(to, "saved_at", from.saved_at);
    put(to, "scenarios", from.scenarios);
    put_if_there(to, "overlays", from.overlays);
    put_if_there(to, "tiles", from.tiles);
}

void to_json(json& to, const Refusal& from) {
    to = json::object();
    put(to, "error", from.error);
}

void to_json(json& to, const You& from) {
    to = json::object();
    put(to, "id", from.id);
    put(to, "name", from.name);
    put(to, "role", from.role);
    put(to, "colour", from.colour);
    put(to, "secret", from.secret);
}

void to_json(json& to, const HelloMessage& from) {
    to = {{"type", "hello"}};
    put(to, "protocol", from.protocol);
    put(to, "you", from.you);
    put(to, "session", from.session);
}

void to_json(json& to, const PeopleMessage& from) {
    to = {{"type", "people"}};
    put(to, "people", from.people);
    put(to, "controller", from.controller);
    put(to, "request", from.request);
}

void to_json(json& to, const ScenariosMessage& from) {
    to = {{"type", "scenarios"}};
    put(to, "scenarios", from.scenarios);
}

void to_json(json& to, const EndedMessage&) {
    to = {{"type", "ended"}};
}

void to_json(json& to, const DoneMessage& from) {
    to = {{"type", "done"}};
    put(to, "scenario", from.scenario);
    put(to, "by", from.by);
    put(to, "done", from.done);
}

}  // namespace talus::messages
