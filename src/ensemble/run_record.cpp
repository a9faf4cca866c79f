#include "ensemble/run_record.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <exception>
#include <fstream>
#include <limits>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/number_or_null.hpp"
#include "core/try.hpp"
#include "ensemble/predict.hpp"
#include "observe/number_names.hpp"
#include "products/checked_file.hpp"
#include "report/hazard_map.hpp"

namespace talus::ensemble {
namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "records are written as the machine holds them");

constexpr products::CheckedFileKind record_file{"talus run 2 ", "record of a run"};

/// Of the maps that belong to a record; more than any file has if they cannot be.
std::uintmax_t map_bytes(const RunRecord& record) {
    const GridGeometry& g = record.geometry;
    if (g.columns < 0 || g.rows < 0) return std::numeric_limits<std::uintmax_t>::max();
    const auto cells = static_cast<std::uintmax_t>(g.columns) * static_cast<std::uintmax_t>(g.rows);
    return record.complete() ? recorded_maps.size() * cells * sizeof(float) : 0;
}

double number_or_never(const Json& json) {
    return json.is_number() ? json.get<double>() : observe::never;
}

Json numbers_json(const std::vector<double>& values) {
    Json list = Json::array();
    for (const double v : values) list.push_back(number_or_null<Json>(v));
    return list;
}

Json building_json(const observe::BuildingImpact& b) {
    return {b.name,
            b.hit,
            number_or_null<Json>(b.first_hit_time),
            number_or_null<Json>(b.peak_force),
            number_or_null<Json>(b.peak_impact_pressure),
            number_or_null<Json>(b.peak_depth),
            number_or_null<Json>(b.peak_dynamic_pressure),
            number_or_null<Json>(b.peak_speed)};
}

observe::BuildingImpact building_of(const Json& j) {
    observe::BuildingImpact b{j.at(0).get<std::string>(), j.at(1).get<bool>(),      number_or_never(j.at(2)),
                              number_or_never(j.at(3)),   number_or_never(j.at(4)), number_or_never(j.at(5)),
                              number_or_never(j.at(6))};
    // Records of earlier versions lack it.
    b.peak_speed = j.size() > 7 ? number_or_never(j.at(7)) : observe::never;
    return b;
}

Json header_json(const std::string& plan, const RunRecord& r) {
    Json buildings = Json::array();
    for (const observe::BuildingImpact& b : r.buildings) buildings.push_back(building_json(b));
    const GridGeometry& g = r.geometry;
    return {{"plan", plan},
            {"run", r.run},
            {"fault", r.fault},
            {"model", r.model},
            {"values", r.values},
            {"results", numbers_json(r.results)},
            {"buildings", buildings},
            {"simulated_time_s", r.simulated_time},
            {"wall_time_s", r.wall_time},
            {"particles", r.particles},
            {"checks", verdict_json(r.verdict)["checks"]},
            {"hash", r.hash},
            {"map", {g.x_min, g.y_min, g.cell, g.columns, g.rows}}};
}

RunRecord record_of(const Json& j) {
    RunRecord r;
    r.run = j.at("run").get<std::size_t>();
    r.fault = j.at("fault").get<std::string>();
    r.model = j.value("model", "");
    r.values = j.at("values").get<std::vector<std::string>>();
    for (const Json& v : j.at("results")) r.results.push_back(number_or_never(v));
    for (const Json& b : j.at("buildings")) r.buildings.push_back(building_of(b));
    r.simulated_time = j.at("simulated_time_s").get<double>();
    r.wall_time = j.at("wall_time_s").get<double>();
    r.particles = j.at("particles").get<std::uint32_t>();
    r.verdict = run::verdict_of(j.value("checks", Json::array()));
    r.hash = j.at("hash").get<std::string>();
    const Json& map = j.at("map");
    r.geometry = {map.at(0).get<double>(), map.at(1).get<double>(), map.at(2).get<double>(), map.at(3).get<int>(),
                  map.at(4).get<int>()};
    return r;
}

/// Ground that debris reached, m2.
double reached_area(const HazardMaps& maps) {
    std::size_t cells = 0;
    for (const float v : maps.peak_depth.values) cells += std::isnan(v) ? 0 : 1;
    const double cell = maps.peak_depth.geometry.cell;
    return static_cast<double>(cells) * cell * cell;
}

}  // namespace

run::RunVerdict judge_together(const std::vector<RunRecord>& runs) {
    std::vector<run::RunVerdict> verdicts;
    for (const RunRecord& run : runs) {
        if (run.complete()) verdicts.push_back(run.verdict);
    }
    return run::judge_together(verdicts);
}

std::vector<Measure> measures_of(const scene::Scene& scene) {
    std::vector<Measure> list;
    list.reserve(observe::run_out_numbers.size() + 5);
    for (const observe::NamedNumber& number : observe::run_out_numbers) {
        list.push_back({std::string(number.key), number.title, number.unit});
    }
    list.insert(list.end(), {{"reached_area_m2", "Area reached", "m2"},
                             {"largest_depth_m", observe::peak_numbers[0].map.title, "m"},
                             {"largest_speed_mps", observe::peak_numbers[1].map.title, "m/s"},
                             {"duration_s", "Time until the run ended", "s"}});
    if (!scene.buildings.empty()) list.push_back({"buildings_hit", "Buildings hit", ""});
    for (const ObservedValue& o : observed_values(scene)) list.push_back({o.key, o.name, o.unit});
    return list;
}

std::vector<double> measure(const scene::Scene& scene, const run::RunResult& result) {
    const observe::Observation& o = result.observation;
    std::vector<double> values;
    values.reserve(observe::run_out_numbers.size() + 5);
    for (const observe::NamedNumber& number : observe::run_out_numbers) values.push_back(number.value(o));
    values.insert(values.end(), {reached_area(o.maps), report::greatest(o.maps.peak_depth),
                                 report::greatest(o.maps.peak_speed), result.simulated_time});
    if (!scene.buildings.empty()) {
        values.push_back(static_cast<double>(hits_among(o.buildings, false).hit));
    }
    for (const double predicted : predicted_values(scene, o)) values.push_back(predicted);
    return values;
}

Status write_run_record(const std::filesystem::path& file, const std::string& plan, const RunRecord& record,
                        const HazardMaps& maps) {
    std::string text = header_json(plan, record).dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
    for (const NamedMap& map : recorded_maps) {
        const std::vector<float>& values = (maps.*map.grid).values;
        if (values.size() != record.geometry.size()) continue;  // a run that failed has none
        const std::size_t at = text.size();
        text.resize(at + values.size() * sizeof(float));
        std::memcpy(text.data() + at, values.data(), values.size() * sizeof(float));
    }
    return write_checked_file(file, record_file, text);
}

Result<RunRecord> read_run_record(const std::filesystem::path& file, const std::string& plan, std::size_t run,
                                  Verify verify) {
    TALUS_ASSIGN(auto in, open_checked_file(file, record_file, verify));
    std::string header;
    std::getline(in, header);
    try {
        const Json json = Json::parse(header);
        if (json.at("plan") != plan) return Error{file.string() + ": is a run of another plan"};
        RunRecord record = record_of(json);
        if (record.run != run) return Error{fmt::format("{}: is run {}, not run {}", file.string(), record.run, run)};
        if (in.good() &&
            std::filesystem::file_size(file) - static_cast<std::uintmax_t>(in.tellg()) == map_bytes(record))
            return record;
        return Error{file.string() + ": is no record of a run"};
    } catch (const std::exception&) {  // another program has written it, checksum and all
        return Error{file.string() + ": is no record of a run"};
    }
}

Result<std::vector<float>> read_map_rows(const std::filesystem::path& file, const RunRecord& record, std::size_t map,
                                         int first, int last) {
    std::ifstream in(file, std::ios::binary);
    std::string line;
    const std::size_t columns = static_cast<std::size_t>(record.geometry.columns);
    std::vector<float> rows(columns * static_cast<std::size_t>(std::max(0, last - first)));
    if (rows.empty()) return rows;
    if (in && std::getline(in, line) && std::getline(in, line)) {
        const std::size_t cells = map * record.geometry.size() + columns * static_cast<std::size_t>(first);
        in.seekg(static_cast<std::streamoff>(cells * sizeof(float)), std::ios::cur);
        in.read(reinterpret_cast<char*>(rows.data()), static_cast<std::streamsize>(rows.size() * sizeof(float)));
    }
    if (!in) return Error{file.string() + ": cannot be read"};
    return rows;
}

}  // namespace talus::ensemble
