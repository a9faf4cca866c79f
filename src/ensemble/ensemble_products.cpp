#include "ensemble/ensemble_products.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <system_error>

#include <fmt/format.h>

#include "core/number_or_null.hpp"
#include "core/try.hpp"
#include "ensemble/ensemble_tables.hpp"
#include "geo/raster.hpp"
#include "geo/raster_outline.hpp"
#include "geo/vector.hpp"
#include "products/layer_definition.hpp"
#include "products/results_json.hpp"
#include "products/text_file.hpp"
#include "products/writers.hpp"
#include "report/vector_style.hpp"

namespace talus::ensemble {

namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

constexpr Ramp probability_ramp = {300, 0.05, 262, 0.13, 0.94, 0.26};

/// Names shared by all maps of one quantity, and those of a threshold.
struct QuantityWords {
    const char* file;
    const char* name;
    const char* unit;       ///< of thresholds
    const char* file_unit;  ///< the same in a file's name
};
constexpr std::array<QuantityWords, 3> threshold_words = {{
    {"depth", "peak depth", "m", "m"},
    {"speed", "peak speed", "m/s", "mps"},
    {"pressure", "peak dynamic pressure", "kPa", "kPa"},
}};

/// null where particles alone were run.
Json two_models_json(const EnsembleResult& result) {
    if (!result.two_models) return {};
    const TwoModels& both = *result.two_models;
    const auto list = [](const std::vector<TwoModelMean>& means) {
        Json rows = Json::array();
        for (const TwoModelMean& m : means) {
            rows.push_back({{"result", m.key},
                            {"name", m.name},
                            {"particles", {{"mean", m.mean.plain}, {"standard_error", m.mean.plain_error}}},
                            {"both", {{"mean", m.mean.mean}, {"standard_error", m.mean.error}}},
                            {"depth_averaged", m.fast_mean},
                            {"factor", m.mean.factor}});
        }
        return rows;
    };
    return {{"pairs", both.pairs},
            {"fast_complete", both.fast_complete},
            {"fast_failed", both.fast_failed},
            {"results", list(both.results)},
            {"buildings", list(both.buildings)}};
}

/// Removes maps of thresholds that are no longer evaluated.
void remove_old_maps(const fs::path& folder, const std::set<std::string>& wanted) {
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
        const fs::path& file = entry.path();
        const std::string stem = file.stem().string();
        const bool ours = (stem.starts_with("probability_") || stem == "hazard_zones") &&
                          (file.extension() == ".tif" || file.extension() == ".qml" || file.extension() == ".gpkg");
        if (ours && wanted.count(stem) == 0) fs::remove(file, error);
    }
}

Status write_one(const EnsembleResult& result, const report::HazardMap& style, const Grid<float>& si,
                 const fs::path& folder, products::LayerDefinition& layers) {
    if (si.values.empty()) return {};  // no run came anywhere
    const Grid<float> grid = report::in_unit(si, style.factor);
    const std::string note = result.scene->spec.scene.reconstruction ? " (reconstruction)" : "";
    // In legends the unit follows: "share of runs ..., in" %.
    std::string what = style.description;
    if (what.ends_with(", in")) what.resize(what.size() - 4);
    const geo::RasterBand band{&grid, fmt::format("{}; {} runs{}", what, result.reduction.complete, note), style.unit};
    const std::string stem = (folder / style.file).string();
    TALUS_TRY(write_cog(stem + ".tif", band, result.scene->crs));
    const std::string qml = qgis_style(style, report::greatest(grid));
    layers.add_raster(style.title, style.file + ".tif", qml, style.file.starts_with("probability_depth"));
    return products::write_text_file(stem + ".qml", qml);
}

/// hazard_zones.gpkg: a feature per zone that occurs, in the zone's colour.
Status write_zone_polygons(const EnsembleResult& result, const fs::path& folder, products::LayerDefinition& layers) {
    const fs::path file = folder / "hazard_zones.gpkg";
    std::error_code error;
    fs::remove(file, error);  // layers are added to a file that is there
    std::vector<geo::OutputFeature> features;
    TALUS_ASSIGN(auto classes, geo::class_outlines(result.zones, result.matrix->zones.size()));
    for (geo::ClassOutline& zone : classes) {
        features.push_back({std::move(zone.polygons),
                            {},
                            {static_cast<double>(zone.number), result.matrix->zones[zone.number - 1].name,
                             result.matrix->name, *result.runs->plan().return_period, zone.area}});
    }
    TALUS_TRY(write_geopackage_layer(file.string(), "hazard_zones",
                                     {{"zone"}, {"name", true}, {"matrix", true}, {"return_period_years"}, {"area_m2"}},
                                     features, result.scene->crs));
    std::vector<report::VectorClass> drawn;
    for (const report::Category& zone : result.matrix->zones) {
        drawn.push_back({zone.name, zone.name, {zone.colour, zone.colour, 170, 0.1}});
    }
    const std::string style = report::qgis_vector_style("name", drawn);
    layers.add_vector("Hazard zones, polygons", "hazard_zones.gpkg", "hazard_zones", style, false);
    return geo::write_geopackage_styles(file.string(), {{"hazard_zones", style}});
}

/// buildings.gpkg: the footprints with the columns of buildings.csv, coloured by the probability of a hit.
Status write_building_polygons(const EnsembleResult& result, const fs::path& folder,
                               products::LayerDefinition& layers) {
    const fs::path file = folder / "buildings.gpkg";
    std::error_code error;
    fs::remove(file, error);  // layers are added to a file that is there
    if (result.reduction.buildings.empty()) return {};
    const report::Colour outline{60, 60, 60};
    const report::Classes odds = report::fixed_classes({1, 5, 20, 50, 80}, 100, probability_ramp);
    const auto class_text = [&](std::size_t k) {
        return k + 1 < odds.breaks.size() ? fmt::format("{} to {} %", odds.breaks[k], odds.breaks[k + 1])
                                          : fmt::format("{} % and more", odds.breaks[k]);
    };
    const std::string rare = fmt::format("below {} %", odds.breaks.front());
    std::vector<report::VectorClass> classes;
    for (std::size_t k = 0; k < odds.breaks.size(); ++k) {
        classes.push_back({class_text(k), class_text(k), {odds.colours[k], outline}});
    }
    classes.push_back({rare, rare, {{217, 217, 217}, outline}});

    std::vector<geo::Field> fields = {{"name", true}, {"probability_class", true}};
    for (const std::string& name : building_columns(result)) fields.push_back({name});
    std::vector<geo::OutputFeature> features;
    for (std::size_t k = 0; k < result.reduction.buildings.size() && k < result.scene->buildings.size(); ++k) {
        const BuildingOdds& b = result.reduction.buildings[k];
        const int in = odds.of(100 * b.hit);
        std::vector<geo::Attribute> values = {b.name, in < 0 ? rare : class_text(static_cast<std::size_t>(in))};
        for (const double number : building_numbers(b)) values.emplace_back(number);
        features.push_back({result.scene->buildings[k].footprint, {}, std::move(values)});
    }
    TALUS_TRY(write_geopackage_layer(file.string(), "buildings", fields, features, result.scene->crs));
    const std::string style = report::qgis_vector_style("probability_class", classes, "name");
    layers.add_vector("Buildings, probability of a hit", "buildings.gpkg", "buildings", style, true);
    return geo::write_geopackage_styles(file.string(), {{"buildings", style}});
}

Status write_maps(const EnsembleResult& result, const fs::path& folder, products::LayerDefinition& layers) {
    std::set<std::string> written;
    for (const EnsembleMap& map : result.reduction.maps) {
        const report::HazardMap style = style_of(map);
        written.insert(style.file);
        TALUS_TRY(write_one(result, style, map.grid, folder, layers));
    }
    for (std::size_t k = 0; k < result.reduction.intensity.size(); ++k) {
        const report::HazardMap style =
            intensity_odds_style(result.guideline->classes[k], k + 1 == result.guideline->classes.size());
        written.insert(style.file);
        TALUS_TRY(write_one(result, style, result.reduction.intensity[k], folder, layers));
    }
    if (result.matrix != nullptr) {
        const report::HazardMap style = zone_style(*result.matrix);
        written.insert(style.file);
        TALUS_TRY(write_one(result, style, result.zones, folder, layers));
        TALUS_TRY(write_zone_polygons(result, folder, layers));
    }
    remove_old_maps(folder, written);
    return {};
}

/// `what`: "medium intensity or higher".
report::HazardMap probability_style(std::string file, const std::string& what) {
    report::HazardMap style;
    style.file = std::move(file);
    style.title = "Probability of " + what;
    style.description = fmt::format("share of runs with {}, in", what);
    style.unit = "%";
    style.factor = 100;
    style.breaks = {1, 5, 10, 25, 50, 75, 90, 95};
    style.full_scale = 100;
    style.ramp = probability_ramp;
    return style;
}

}  // namespace

std::vector<double> EnsembleResult::values_of(std::size_t measure) const {
    std::vector<double> values;
    for (const RunRecord& run : reduction.runs) {
        if (run.complete() && measure < run.results.size() && std::isfinite(run.results[measure])) {
            values.push_back(run.results[measure]);
        }
    }
    return values;
}

EnsembleResult summarise(const scene::Scene& scene, const PlannedRuns& runs, Reduction reduction) {
    EnsembleResult result;
    result.scene = &scene;
    result.runs = &runs;
    result.reduction = std::move(reduction);
    result.measures = measures_of(scene);
    const params::GuidelineChoice guideline = scene.spec.outputs.intensity_guideline;
    result.guideline = &report::intensity_guideline(guideline);
    if (const auto& years = runs.plan().return_period) {
        result.matrix = hazard_matrix(guideline);
        if (result.matrix != nullptr) result.zones = hazard_zones(*result.matrix, result.reduction.intensity, *years);
    }
    for (std::size_t m = 0; m < result.measures.size(); ++m) {
        std::vector<double> values(runs.count(), observe::never);
        for (const RunRecord& run : result.reduction.runs) {
            if (run.complete() && m < run.results.size()) values[run.run] = run.results[m];
        }
        result.sensitivity.push_back(sensitivity_of(runs.plan().design, runs.points(), values));
    }
    return result;
}

report::HazardMap style_of(const EnsembleMap& map) {
    if (map.kind == EnsembleMap::Kind::percentile) {
        report::HazardMap style = report::hazard_maps().at(map.map);
        style.grid = nullptr;
        style.file += fmt::format("_p{:02.0f}", map.level);
        style.title += fmt::format(", {:.0f}th percentile", map.level);
        style.description = fmt::format("{}: {:.0f}th percentile", style.description, map.level);
        return style;
    }
    const QuantityWords& words = threshold_words.at(map.map);
    return probability_style(fmt::format("probability_{}_{}{}", words.file, map.level, words.file_unit),
                             fmt::format("{} over {} {}", words.name, map.level, words.unit));
}

report::HazardMap intensity_odds_style(const report::IntensityClass& intensity, bool most_severe) {
    return probability_style("probability_intensity_" + intensity.name,
                             fmt::format("{} intensity{}", intensity.name, most_severe ? "" : " or higher"));
}

Json effect_json(stats::SensitivityKind kind, const std::string& factor, const stats::FactorEffect& e) {
    const auto interval = [](const stats::Estimate& v) { return Json{v.value, v.low, v.high}; };
    Json json = {{"factor", factor}};
    if (kind == stats::SensitivityKind::variance) {
        json["first_order"] = interval(e.first);
        json["total"] = interval(e.total);
    } else if (kind == stats::SensitivityKind::screening) {
        json["mean_absolute_effect"] = e.mean_size;
        json["mean_effect"] = e.mean;
        json["standard_deviation"] = e.deviation;
    } else {
        json["rank_correlation"] = e.correlation;
    }
    return json;
}

Json statistics_json(const EnsembleResult& result) {
    const Reduction& r = result.reduction;
    const std::vector<Factor>& factors = result.runs->plan().factors;
    Json failed = Json::array(), measures = Json::array(), buildings = Json::array();
    for (const RunRecord& run : r.runs) {
        if (!run.complete()) failed.push_back({{"run", run.run}, {"values", run.values}, {"fault", run.fault}});
    }
    for (std::size_t m = 0; m < result.measures.size(); ++m) {
        std::vector<double> values = result.values_of(m);
        Json entry = {{"result", result.measures[m].key}, {"runs", values.size()}};
        for (const double p : table_percentiles)
            entry[fmt::format("p{:02.0f}", p)] = number_or_null<Json>(percentile(values, p));
        entry["sensitivity"] = Json::array();
        const stats::Sensitivity& s = result.sensitivity[m];
        for (std::size_t k = 0; k < s.effects.size(); ++k)
            entry["sensitivity"].push_back(effect_json(s.kind, factors[k].key, s.effects[k]));
        measures.push_back(entry);
    }
    for (const BuildingOdds& b : r.buildings) {
        buildings.push_back({{"name", b.name},
                             {"probability_hit", b.hit},
                             {"probability_above_threshold", b.over_pressure},
                             {"peak_impact_pressure_p50_kPa", b.median_pressure / 1e3},
                             {"peak_impact_pressure_p95_kPa", b.high_pressure / 1e3},
                             {"first_hit_p50_s", number_or_null<Json>(b.median_hit)}});
    }
    const Thresholds& t = result.runs->plan().thresholds;
    return {
        {"runs", result.runs->count()},
        {"complete", r.complete},
        {"failed", failed},
        {"verdict", verdict_json(judge_together(r.runs))},
        {"missing", r.missing},
        {"thresholds", {{"depth_m", t.depth}, {"speed_mps", t.speed}, {"pressure_kPa", t.pressure}}},
        {"return_period_years", result.runs->plan().return_period ? Json(*result.runs->plan().return_period) : Json()},
        {"intensity_guideline", result.guideline->name},
        {"results", measures},
        {"buildings", buildings},
        {"two_models", two_models_json(result)}};
}

Status write_ensemble(const EnsembleResult& result, const fs::path& folder) {
    products::LayerDefinition layers(result.scene->spec.scene.title, result.scene->crs.wkt);
    TALUS_TRY(write_building_polygons(result, folder, layers));
    TALUS_TRY(write_maps(result, folder, layers));
    const auto& maps = result.reduction.maps;
    const auto reached =
        std::find_if(maps.begin(), maps.end(), [](const EnsembleMap& map) { return !map.grid.values.empty(); });
    if (reached != maps.end()) {
        std::vector<products::WriteJob> terrain;
        products::add_terrain(*result.scene, reached->grid.geometry.extent(), folder, layers, terrain);
        for (const products::WriteJob& job : terrain) TALUS_TRY(job.write());
    }
    TALUS_TRY(layers.write(folder));
    TALUS_TRY(write_ensemble_tables(result, folder));
    const Json results = ensemble_results(result);
    TALUS_TRY(products::write_results(results, folder / "results.json"));
    TALUS_ASSIGN(const std::string report, ensemble_report(result, results));
    TALUS_TRY(products::write_text_file(folder / "report.html", report));
    return products::write_text_file(folder / "statistics.json", statistics_json(result).dump(2) + "\n");
}

}  // namespace talus::ensemble
