// Made from src/messages/protocol.json: edit that; docs/protocol.md tells how this is made again.
// clang-format off
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include <nlohmann/json.hpp>

/// The messages that are sent, a struct each whose JSON to_json() makes; docs/protocol.md says what they mean. What is
/// std::optional is null where it is empty; with {} behind it, absent. A number that is not finite is null.
namespace talus::messages {

/// A whole number, of any of the types that are.
struct Integer {
    template <class Whole>
        requires std::is_integral_v<Whole>
    Integer(Whole whole) : value(static_cast<std::int64_t>(whole)) {}
    std::int64_t value;
};

/// Nothing where it is empty.
[[nodiscard]] std::optional<std::string> if_any(std::string text);

struct Person {
    std::string id;
    std::string name;
    std::string role;
    std::string colour;
    std::optional<std::array<double, 3>> mark;
};
void to_json(nlohmann::json& to, const Person& from);

struct ControlRequest {
    std::string id;
    std::string name;
};
void to_json(nlohmann::json& to, const ControlRequest& from);

struct Session {
    struct You {
        std::string role;
    };
    struct Links {
        std::optional<std::string> viewer{};
        std::optional<std::string> controller{};
    };
    Integer protocol;
    std::string id;
    std::string program;
    std::string title;
    You you;
    std::vector<std::string> scenarios;
    std::vector<Person> people;
    std::optional<std::string> controller;
    std::optional<ControlRequest> request;
    Links links;
};
void to_json(nlohmann::json& to, const Session::You& from);
void to_json(nlohmann::json& to, const Session::Links& from);
void to_json(nlohmann::json& to, const Session& from);

struct SharedLink {
    std::string host;
    bool encrypted;
    std::string viewer_url;
    std::string controller_url;
};
void to_json(nlohmann::json& to, const SharedLink& from);

struct Share {
    std::optional<SharedLink> shared;
    std::vector<std::string> addresses;
};
void to_json(nlohmann::json& to, const Share& from);

struct MapGrid {
    double x_min_m;
    double y_min_m;
    double cell_m;
    Integer columns;
    Integer rows;
};
void to_json(nlohmann::json& to, const MapGrid& from);

struct FlowPath {
    std::vector<std::array<double, 3>> points;
    std::vector<double> chainage_m;
    double corridor_width_m;
    bool traced;
};
void to_json(nlohmann::json& to, const FlowPath& from);

struct TableKey {
    std::string key;
    std::string label;
    std::string unit;
    std::string is;
    bool required;
    nlohmann::json default_;
    std::string absent;
    std::string allowed;
    std::string help;
};
void to_json(nlohmann::json& to, const TableKey& from);

struct TableSection {
    std::string section;
    std::string kind;
    std::string help;
    std::vector<TableKey> keys;
    std::vector<std::vector<std::string>> one_of;
};
void to_json(nlohmann::json& to, const TableSection& from);

struct GaugePlace {
    std::string name;
    double x_m;
    double y_m;
    std::optional<double> chainage_m;
};
void to_json(nlohmann::json& to, const GaugePlace& from);

struct SectionPlace {
    std::string name;
    std::vector<std::array<double, 2>> line;
};
void to_json(nlohmann::json& to, const SectionPlace& from);

struct ParameterRange {
    std::optional<double> low;
    std::optional<double> high;
    bool low_included;
    bool high_included;
};
void to_json(nlohmann::json& to, const ParameterRange& from);

struct Parameter {
    std::string key;
    std::string label;
    std::string unit;
    std::optional<double> default_;
    std::optional<double> value;
    ParameterRange range;
    std::string help;
    bool used_by_depth_averaged;
};
void to_json(nlohmann::json& to, const Parameter& from);

struct Category {
    std::string name;
    std::string colour;
};
void to_json(nlohmann::json& to, const Category& from);

struct IntensityClass {
    Category category;
    std::string criterion;
};
void to_json(nlohmann::json& to, const IntensityClass& from);

struct IntensityGuideline {
    std::string guideline;
    std::vector<IntensityClass> classes;
    std::string rule;
    std::string source;
};
void to_json(nlohmann::json& to, const IntensityGuideline& from);

struct SceneInfo {
    std::string title;
    std::string description;
    bool reconstruction;
    std::vector<std::string> assumptions;
    std::vector<std::string> sources;
    std::string crs;
    std::string crs_name;
    std::string vertical_unit;
    std::optional<double> latitude_deg;
    std::array<double, 3> origin;
    std::array<double, 4> extent_m;
    std::array<double, 2> elevation_m;
    MapGrid map;
    bool orthophoto;
    double particle_spacing_m;
    double end_time_s;
    double gravity_mps2;
    std::optional<FlowPath> flow_path;
    std::vector<TableSection> table_sections;
    std::vector<GaugePlace> gauges;
    std::vector<SectionPlace> cross_sections;
    std::vector<Parameter> parameters;
    std::map<std::string, std::string> settings;
    IntensityGuideline intensity;
};
void to_json(nlohmann::json& to, const SceneInfo& from);

struct Overlay {
    std::string id;
    std::string name;
    std::string kind;
    std::string by;
    bool visible;
    double opacity;
    std::string colour;
    Integer features;
    Integer outside;
    bool styled;
    std::optional<double> low;
    std::optional<double> high;
    std::string note;
    Integer bytes;
};
void to_json(nlohmann::json& to, const Overlay& from);

struct TileAddress {
    std::string id;
    std::string address;
    std::string by;
};
void to_json(nlohmann::json& to, const TileAddress& from);

struct Overlays {
    std::vector<Overlay> overlays;
    std::optional<std::string> removed;
    std::vector<TileAddress> tiles;
    Integer bytes_left;
};
void to_json(nlohmann::json& to, const Overlays& from);

struct Done {
    std::string done;
    std::optional<std::string> created;
};
void to_json(nlohmann::json& to, const Done& from);

struct Tiles {
    std::vector<std::string> addresses;
    Integer steps;
    std::vector<double> degrees;
};
void to_json(nlohmann::json& to, const Tiles& from);

struct EnsembleFactor {
    std::string key;
    std::string distribution;
};
void to_json(nlohmann::json& to, const EnsembleFactor& from);

struct EnsembleMap {
    std::string name;
    std::string title;
    std::string unit;
    std::string kind;
    std::string of;
    std::string description;
    std::optional<double> threshold;
    std::optional<std::string> threshold_unit;
    std::optional<double> percentile;
    std::vector<Category> categories;
    std::optional<double> greatest;
};
void to_json(nlohmann::json& to, const EnsembleMap& from);

struct Ensemble {
    std::string id;
    std::string name;
    Integer runs;
    Integer failed;
    std::vector<EnsembleFactor> factors;
    bool same_terrain;
    std::vector<EnsembleMap> maps;
};
void to_json(nlohmann::json& to, const Ensemble& from);

struct Ensembles {
    std::vector<Ensemble> ensembles;
};
void to_json(nlohmann::json& to, const Ensembles& from);

struct CalibratedObservation {
    std::string name;
    std::string unit;
    double observed;
    double uncertainty;
    std::string is;
    std::optional<double> best;
    std::optional<double> deviation;
};
void to_json(nlohmann::json& to, const CalibratedObservation& from);

struct CalibratedParameter {
    std::string key;
    std::string label;
    std::string unit;
    double low;
    double high;
};
void to_json(nlohmann::json& to, const CalibratedParameter& from);

struct CalibrationRun {
    std::vector<double> values;
    std::string phase;
    std::optional<double> misfit;
};
void to_json(nlohmann::json& to, const CalibrationRun& from);

struct MisfitMap {
    Integer columns;
    Integer rows;
    std::vector<double> misfit;
};
void to_json(nlohmann::json& to, const MisfitMap& from);

struct BestRun {
    Integer run;
    std::vector<double> values;
    double misfit;
};
void to_json(nlohmann::json& to, const BestRun& from);

struct FoundParameter {
    std::string key;
    double best;
    double median;
    double low_95;
    double high_95;
    double share_of_prior_width;
};
void to_json(nlohmann::json& to, const FoundParameter& from);

struct CalibrationResult {
    bool settled;
    std::optional<double> checks_within_95;
    std::vector<FoundParameter> parameters;
    std::vector<std::string> warnings;
};
void to_json(nlohmann::json& to, const CalibrationResult& from);

struct CalibrationStatus {
    std::string state;
    std::optional<std::string> why_not;
    std::optional<std::string> by;
    std::string message;
    std::vector<CalibratedObservation> observations;
    std::vector<CalibratedParameter> parameters;
    std::optional<std::string> phase;
    Integer runs_at_most;
    Integer runs_failed;
    std::vector<CalibrationRun> fast_runs;
    Integer fast_runs_at_most;
    std::optional<double> wall_remaining_s;
    std::vector<CalibrationRun> runs;
    std::optional<MisfitMap> map;
    std::optional<BestRun> best;
    std::optional<CalibrationResult> result;
};
void to_json(nlohmann::json& to, const CalibrationStatus& from);

struct Listening {
    bool http;
    std::optional<std::string> mqtt;
};
void to_json(nlohmann::json& to, const Listening& from);

struct Trigger {
    std::string name;
    nlohmann::json limits;
};
void to_json(nlohmann::json& to, const Trigger& from);

struct GaugeValue {
    double discharge_m3ps;
    std::string received_at;
};
void to_json(nlohmann::json& to, const GaugeValue& from);

struct TriggeredRun {
    std::string scenario;
    std::string trigger;
    std::string source;
    std::string received_at;
    std::string reason;
    nlohmann::json values;
    std::optional<GaugeValue> reading;
};
void to_json(nlohmann::json& to, const TriggeredRun& from);

struct RaisedAlarm {
    std::string scenario;
    std::string alarm;
    std::string sentence;
    std::string message;
    double time_s;
    std::optional<double> expected_s;
    Integer step;
    std::string hash;
    std::optional<std::string> raised_at;
    std::string delivery;
};
void to_json(nlohmann::json& to, const RaisedAlarm& from);

struct AlertNote {
    std::string at;
    std::string sentence;
};
void to_json(nlohmann::json& to, const AlertNote& from);

struct Alerts {
    Listening listening;
    std::vector<Trigger> triggers;
    std::vector<TriggeredRun> runs;
    std::vector<RaisedAlarm> alarms;
    std::vector<AlertNote> notes;
};
void to_json(nlohmann::json& to, const Alerts& from);

struct TriggerAnswer {
    std::string done;
    std::optional<std::string> scenario;
    bool started;
};
void to_json(nlohmann::json& to, const TriggerAnswer& from);

struct NewScenario {
    std::string done;
    std::string created;
    std::optional<std::string> object;
};
void to_json(nlohmann::json& to, const NewScenario& from);

struct RecordingExtent {
    std::optional<double> first_s;
    std::optional<double> last_s;
    Integer frames;
    Integer bytes;
};
void to_json(nlohmann::json& to, const RecordingExtent& from);

struct RunState {
    std::string status;
    std::string message;
    double time_s;
    double end_time_s;
    std::optional<double> expected_end_s;
    std::optional<double> wall_remaining_s;
    Integer step;
    Integer particles;
    double volume_released_m3;
    double volume_entrained_m3;
    bool pore_pressure;
    double volume_held_m3;
    double volume_moving_m3;
    double volume_deposited_m3;
    double volume_left_m3;
    std::optional<double> front_chainage_m;
    std::optional<double> front_velocity_mps;
    std::optional<double> largest_speed_mps;
    std::optional<double> peak_speed_mps;
    std::optional<double> mean_compression;
    std::optional<double> max_compression;
    std::optional<double> overcompressed_share;
    std::optional<bool> too_compressed;
    nlohmann::json verdict;
    RecordingExtent recording;
    std::optional<std::string> hash{};
};
void to_json(nlohmann::json& to, const RunState& from);

struct Preparation {
    std::string what;
    double share;
};
void to_json(nlohmann::json& to, const Preparation& from);

struct State {
    RunState run_state;
    std::string scenario;
    std::optional<double> speed_factor;
    double real_time_factor;
    double steps_per_second;
    std::optional<Preparation> preparing;
};
void to_json(nlohmann::json& to, const State& from);

struct ChangeOnTheWay {
    double time_s;
    std::string by;
    std::string sentence;
};
void to_json(nlohmann::json& to, const ChangeOnTheWay& from);

struct Recording {
    std::vector<double> times_s;
    Integer bytes;
};
void to_json(nlohmann::json& to, const Recording& from);

struct Figures {
    std::vector<nlohmann::json> figures;
};
void to_json(nlohmann::json& to, const Figures& from);

struct DepthAveragedFront {
    std::vector<double> chainage_m;
    std::vector<double> arrival_time_s;
    std::vector<double> front_velocity_mps;
};
void to_json(nlohmann::json& to, const DepthAveragedFront& from);

struct DepthAveragedResult {
    double end_s;
    bool complete;
    std::string stop_reason;
    nlohmann::json verdict;
    double wall_time_s;
    double processor_time_s;
    double grid_cell_m;
    std::string hash;
    std::vector<std::string> notes;
    DepthAveragedFront front;
};
void to_json(nlohmann::json& to, const DepthAveragedResult& from);

struct DepthAveragedStatus {
    std::string scenario;
    std::string state;
    std::string message;
    std::optional<double> share;
    std::optional<DepthAveragedResult> result;
};
void to_json(nlohmann::json& to, const DepthAveragedStatus& from);

struct DepthAveragedRow {
    std::string key;
    std::string name;
    std::string unit;
    Integer decimals;
    std::optional<double> particles;
    std::optional<double> depth_averaged_by_then;
    std::optional<double> depth_averaged;
    std::optional<double> observed;
};
void to_json(nlohmann::json& to, const DepthAveragedRow& from);

struct AffectedArea {
    double both_m2;
    double particles_only_m2;
    double depth_averaged_only_m2;
    std::optional<double> intersection_over_union;
};
void to_json(nlohmann::json& to, const AffectedArea& from);

struct DepthAveragedComparison {
    double time_s;
    bool over;
    std::vector<DepthAveragedRow> rows;
    double least_depth_m;
    AffectedArea area;
    std::vector<std::string> differs;
};
void to_json(nlohmann::json& to, const DepthAveragedComparison& from);

struct FrontSeries {
    std::vector<double> chainage_m;
    std::vector<double> arrival_time_s;
    std::vector<double> front_velocity_mps;
    std::vector<double> particle_speed_mps;
};
void to_json(nlohmann::json& to, const FrontSeries& from);

struct GaugeSeries {
    std::vector<double> time_s;
    std::vector<std::vector<double>> depth_m;
};
void to_json(nlohmann::json& to, const GaugeSeries& from);

struct Series {
    std::map<std::string, std::vector<double>> time;
    FrontSeries front;
    GaugeSeries gauges;
};
void to_json(nlohmann::json& to, const Series& from);

struct Impact {
    std::string id;
    std::string name;
    bool hit;
    std::optional<double> first_hit_s;
    std::optional<double> peak_force_kN;
    std::optional<double> peak_impact_pressure_kPa;
    std::optional<double> peak_depth_m;
    std::optional<double> peak_speed_mps;
    std::optional<double> peak_dynamic_pressure_kPa;
    double impulse_kNs;
    std::optional<double> failed_s;
    std::optional<std::string> intensity;
};
void to_json(nlohmann::json& to, const Impact& from);

struct BarrierImpact {
    Impact impact;
    double overtopped_m3;
    std::optional<double> first_overtopped_s;
    double passed_m3;
    double retained_m3;
    double peak_filling_height_m;
};
void to_json(nlohmann::json& to, const BarrierImpact& from);

struct RemovedImpact {
    Impact impact;
    std::string kind;
    double removed_s;
    std::optional<double> overtopped_m3{};
    std::optional<std::optional<double>> first_overtopped_s{};
    std::optional<double> passed_m3{};
    std::optional<double> retained_m3{};
    std::optional<double> peak_filling_height_m{};
};
void to_json(nlohmann::json& to, const RemovedImpact& from);

struct Impacts {
    std::vector<Impact> buildings;
    std::vector<BarrierImpact> barriers;
    std::vector<RemovedImpact> removed;
};
void to_json(nlohmann::json& to, const Impacts& from);

struct ObservedRow {
    std::optional<std::string> id;
    std::string name;
    std::string unit;
    double observed;
    double uncertainty;
    std::string is;
    std::optional<double> computed;
    std::optional<double> deviation;
};
void to_json(nlohmann::json& to, const ObservedRow& from);

struct Observed {
    double time_s;
    std::vector<ObservedRow> rows;
};
void to_json(nlohmann::json& to, const Observed& from);

struct GaugeReading {
    std::string name;
    std::optional<double> arrival_s;
    double depth_m;
    double speed_mps;
    double peak_depth_m;
    double peak_speed_mps;
};
void to_json(nlohmann::json& to, const GaugeReading& from);

struct SectionReading {
    std::string name;
    double discharge_m3ps;
    double peak_discharge_m3ps;
    double passed_m3;
};
void to_json(nlohmann::json& to, const SectionReading& from);

struct GaugeReadings {
    std::vector<GaugeReading> gauges;
    std::vector<SectionReading> cross_sections;
};
void to_json(nlohmann::json& to, const GaugeReadings& from);

struct ProbeSeries {
    std::vector<double> time_s;
    std::vector<double> depth_m;
    std::vector<double> speed_mps;
    std::vector<double> pressure_kPa;
    std::vector<double> pore_pressure_ratio;
};
void to_json(nlohmann::json& to, const ProbeSeries& from);

struct ExportFile {
    std::string name;
    std::optional<Integer> bytes;
    std::string what;
};
void to_json(nlohmann::json& to, const ExportFile& from);

struct ExportFiles {
    std::vector<ExportFile> files;
};
void to_json(nlohmann::json& to, const ExportFiles& from);

struct FlowFormatOffer {
    std::string name;
    std::string what;
    std::vector<std::string> files;
    Integer frames;
    Integer bytes;
    std::optional<std::string> refused;
};
void to_json(nlohmann::json& to, const FlowFormatOffer& from);

struct FlowOffer {
    std::string scenario;
    double from_s;
    double to_s;
    Integer frames;
    double interval_s;
    double shortest_interval_s;
    std::vector<FlowFormatOffer> formats;
};
void to_json(nlohmann::json& to, const FlowOffer& from);

struct FlowFile {
    std::string name;
    Integer bytes;
};
void to_json(nlohmann::json& to, const FlowFile& from);

struct FlowExport {
    std::string state;
    std::optional<std::string> scenario;
    std::optional<double> share;
    std::string message;
    std::vector<FlowFile> files;
};
void to_json(nlohmann::json& to, const FlowExport& from);

struct NoStartPage {
    bool available;
};
void to_json(nlohmann::json& to, const NoStartPage& from);

struct UploadLimits {
    Integer bytes;
    Integer files;
    double cells;
};
void to_json(nlohmann::json& to, const UploadLimits& from);

struct KnownScene {
    std::string id;
    std::string title;
    std::string kind;
    std::optional<std::string> file;
    std::optional<std::string> opened_at;
    bool missing;
};
void to_json(nlohmann::json& to, const KnownScene& from);

struct SavedSession {
    std::string id;
    std::string name;
    std::string title;
    std::string saved_at;
    Integer scenarios;
};
void to_json(nlohmann::json& to, const SavedSession& from);

struct Job {
    std::string id;
    std::string kind;
    std::string state;
    std::string title;
    std::string message;
    std::string begun_at;
    std::optional<std::string> ended_at;
    Integer done;
    Integer failed;
    Integer count;
    std::optional<double> wall_remaining_s;
    std::string command;
    std::string folder;
    std::optional<std::string> report;
};
void to_json(nlohmann::json& to, const Job& from);

struct StartPage {
    struct Open {
        std::string title;
    };
    bool available;
    std::optional<Open> open;
    std::optional<Preparation> opening;
    std::optional<std::string> error;
    Integer count;
    std::vector<std::string> notes;
    std::string program;
    std::string role;
    std::optional<std::string> folder{};
    std::optional<UploadLimits> uploads{};
    std::optional<std::vector<KnownScene>> scenes{};
    std::optional<std::vector<SavedSession>> sessions{};
    std::optional<std::optional<std::vector<Job>>> jobs{};
};
void to_json(nlohmann::json& to, const StartPage::Open& from);
void to_json(nlohmann::json& to, const StartPage& from);

struct DraftFile {
    std::string name;
    Integer bytes;
    std::string kind;
};
void to_json(nlohmann::json& to, const DraftFile& from);

struct MendingOfTerrain {
    std::optional<Integer> epsg;
    bool local;
    bool metric;
    std::optional<double> metres_per_unit;
    std::optional<double> nodata;
};
void to_json(nlohmann::json& to, const MendingOfTerrain& from);

struct DraftTerrain {
    std::optional<std::string> problem;
    Integer columns;
    Integer rows;
    std::string crs;
    std::string metric_crs;
    std::string value_unit;
    double height_unit_m;
    std::optional<double> cell_m{};
    std::optional<double> nodata_share{};
    std::optional<std::optional<std::array<double, 2>>> elevation_m{};
    MendingOfTerrain mending;
};
void to_json(nlohmann::json& to, const DraftTerrain& from);

struct Draft {
    std::map<std::string, DraftFile> files;
    std::optional<DraftTerrain> terrain;
    Integer bytes_left;
};
void to_json(nlohmann::json& to, const Draft& from);

struct Checked {
    std::string summary;
    std::vector<std::string> notes;
    std::optional<std::string> created;
};
void to_json(nlohmann::json& to, const Checked& from);

struct JobLimits {
    Integer runs;
    Integer ensemble_factors;
    Integer calibration_factors;
};
void to_json(nlohmann::json& to, const JobLimits& from);

struct JobForm {
    std::string title;
    std::vector<Parameter> parameters;
    std::vector<std::string> observations;
    std::vector<std::string> events;
    std::vector<std::string> options;
    std::vector<std::string> barriers;
    JobLimits limits;
};
void to_json(nlohmann::json& to, const JobForm& from);

struct JobEstimate {
    std::optional<double> run_s;
    Integer particles;
    Integer memory_bytes;
    Integer cores;
};
void to_json(nlohmann::json& to, const JobEstimate& from);

struct ValidationCase {
    std::string name;
    std::string title;
    bool quick;
};
void to_json(nlohmann::json& to, const ValidationCase& from);

struct ValidationCases {
    std::vector<ValidationCase> cases;
};
void to_json(nlohmann::json& to, const ValidationCases& from);

struct SavedScenario {
    std::string name;
    std::string title;
    nlohmann::json journal;
};
void to_json(nlohmann::json& to, const SavedScenario& from);

struct SavedOverlay {
    Overlay overlay;
    std::string type;
    std::string data;
};
void to_json(nlohmann::json& to, const SavedOverlay& from);

struct SavedTiles {
    std::string address;
    std::string by;
};
void to_json(nlohmann::json& to, const SavedTiles& from);

struct SessionFile {
    Integer talus_session;
    std::string name;
    std::string title;
    std::string saved_at;
    std::vector<SavedScenario> scenarios;
    std::optional<std::vector<SavedOverlay>> overlays{};
    std::optional<std::vector<SavedTiles>> tiles{};
};
void to_json(nlohmann::json& to, const SessionFile& from);

struct Refusal {
    std::string error;
};
void to_json(nlohmann::json& to, const Refusal& from);

struct You {
    std::string id;
    std::string name;
    std::string role;
    std::string colour;
    std::string secret;
};
void to_json(nlohmann::json& to, const You& from);

struct HelloMessage {
    Integer protocol;
    You you;
    Session session;
};
void to_json(nlohmann::json& to, const HelloMessage& from);

struct PeopleMessage {
    std::vector<Person> people;
    std::optional<std::string> controller;
    std::optional<ControlRequest> request;
};
void to_json(nlohmann::json& to, const PeopleMessage& from);

struct ScenariosMessage {
    std::vector<std::string> scenarios;
};
void to_json(nlohmann::json& to, const ScenariosMessage& from);

struct EndedMessage {
};
void to_json(nlohmann::json& to, const EndedMessage& from);

struct DoneMessage {
    std::string scenario;
    std::string by;
    std::string done;
};
void to_json(nlohmann::json& to, const DoneMessage& from);

}  // namespace talus::messages
