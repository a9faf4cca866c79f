#include "risk/risk_products.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/raster.hpp"
#include "geo/vector.hpp"
#include "products/csv.hpp"
#include "products/layer_definition.hpp"
#include "products/results_json.hpp"
#include "products/text_file.hpp"
#include "products/writers.hpp"
#include "report/vector_style.hpp"

namespace talus::risk {

namespace fs = std::filesystem;

namespace {

constexpr Ramp risk_ramp = {90, 0.06, 25, 0.17, 0.95, 0.38};
const std::vector<double> frequency_breaks = {1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3};
const std::vector<double> individual_breaks = {1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2};
constexpr double absent = std::numeric_limits<double>::quiet_NaN();

std::string suffix(std::size_t option) {
    return option == 0 ? "" : fmt::format("_option_{}", option);
}

void add_estimate(products::Csv& csv, const stats::Estimate& e, bool there) {
    for (const double v : {e.value, e.low, e.high}) csv.number(there ? v : absent);
}

/// The columns of an item's numbers in tables; `per`: "year" or "event".
std::string item_header(const std::string& per) {
    std::string text;
    for (const char* name : {"impacts", "loss", "deaths", "individual_risk"}) {
        for (const char* part : {"", "_low", "_high"}) text += fmt::format(",{}_per_{}{}", name, per, part);
    }
    return text;
}

void add_item(products::Csv& csv, const ItemRisk& item) {
    add_estimate(csv, item.impact, true);
    add_estimate(csv, item.loss, item.has_loss);
    add_estimate(csv, item.deaths, item.has_deaths);
    add_estimate(csv, item.individual, item.has_individual);
}

const char* kind_of(const ItemRisk& item, bool total) {
    return total ? "all" : item.road ? "road" : "building";
}

/// A row per option and item; `of`: the risks or the differences.
std::string items_csv(const StudyResult& result, const std::vector<Risk>& of, std::size_t first) {
    products::Csv csv("option,kind,name,exposure" + item_header(result.study->per_event ? "event" : "year"));
    for (std::size_t k = first; k < of.size(); ++k) {
        const auto row = [&](const ItemRisk& item, bool total) {
            csv.word(result.name_of(k)).word(kind_of(item, total)).word(item.name).word(item.exposure);
            add_item(csv, item);
            csv.end_row();
        };
        for (const ItemRisk& item : of[k].items) row(item, false);
        row(of[k].total, true);
    }
    return csv.text();
}

std::string fn_csv(const StudyResult& result) {
    products::Csv csv("option,deaths_at_least,events_per_year");
    for (std::size_t k = 0; k < result.risks.size(); ++k) {
        const std::vector<double>& f = result.risks[k].deaths_at_least;
        for (std::size_t n = 1; n < f.size(); ++n) {
            csv.word(result.name_of(k)).number(static_cast<double>(n)).number(f[n]);
            csv.end_row();
        }
    }
    return csv.text();
}

std::string options_csv(const StudyResult& result) {
    products::Csv csv("option,cost,life_years,interest_rate_per_year,upkeep_per_year,cost_per_year,currency" +
                      item_header(result.study->per_event ? "event" : "year"));
    for (std::size_t k = 1; k < result.risks.size(); ++k) {
        const params::OptionSpec& option = *result.option(k);
        csv.word(option.name).number(option.cost).number(option.life).number(option.interest_rate);
        csv.number(option.upkeep).number(cost_per_year(option)).word(result.scene().spec.risk.currency);
        add_item(csv, result.differences[k].total);
        csv.end_row();
    }
    return csv.text();
}

Status write_map(const StudyResult& result, const report::HazardMap& style, const Grid<float>& grid,
                 const fs::path& folder, bool shown, products::LayerDefinition& layers) {
    if (grid.values.empty()) return {};
    const std::string note = result.scene().spec.scene.reconstruction ? " (reconstruction)" : "";
    const geo::RasterBand band{&grid, style.description + note, style.unit};
    TALUS_TRY(write_cog((folder / (style.file + ".tif")).string(), band, result.scene().crs));
    const std::string qml = qgis_style(style, report::greatest(grid));
    layers.add_raster(style.title, style.file + ".tif", qml, shown);
    return products::write_text_file(folder / (style.file + ".qml"), qml);
}

/// The class of individual risk, and its colour.
struct RiskClass {
    double least;
    const char* text;
    report::Colour colour;
};
const std::vector<RiskClass>& risk_classes() {
    static const std::vector<RiskClass> classes = {{1e-4, "1e-4 or more", {178, 24, 43}},
                                                   {1e-5, "1e-5 to 1e-4", {239, 138, 98}},
                                                   {1e-6, "1e-6 to 1e-5", {253, 219, 150}},
                                                   {0, "below 1e-6", {217, 217, 217}}};
    return classes;
}

std::string class_of(const ItemRisk& item) {
    if (!item.has_individual) return "not exposed";
    for (const RiskClass& c : risk_classes()) {
        if (item.individual.value >= c.least) return c.text;
    }
    return risk_classes().back().text;
}

/// risk.gpkg: a layer of buildings and one of roads for each option.
Status write_vectors(const StudyResult& result, const fs::path& folder, products::LayerDefinition& layers) {
    const fs::path file = folder / "risk.gpkg";
    std::error_code error;
    fs::remove(file, error);  // layers are added to a file that is there
    std::vector<report::VectorClass> classes;
    const report::Colour edge{60, 60, 60};
    for (const RiskClass& c : risk_classes()) classes.push_back({c.text, c.text, {c.colour, edge}});
    classes.push_back({"not exposed", "not exposed", {{245, 245, 245}, edge}});
    std::vector<geo::Field> fields = {{"name", true}, {"exposure", true}, {"individual_risk_class", true}};
    for (const char* name : {"impacts", "loss", "deaths", "individual_risk"}) {
        fields.push_back({fmt::format("{}_per_{}", name, result.study->per_event ? "event" : "year")});
    }
    std::vector<geo::LayerStyle> styles;
    for (std::size_t k = 0; k < result.risks.size(); ++k) {
        std::vector<geo::OutputFeature> buildings, roads;
        const Exposures& exposures = result.study->exposures;
        for (std::size_t i = 0; i < result.risks[k].items.size(); ++i) {
            const ItemRisk& item = result.risks[k].items[i];
            const auto number = [](const stats::Estimate& e, bool there) {
                return there ? geo::Attribute(e.value) : geo::Attribute();
            };
            geo::OutputFeature feature;
            feature.values = {item.name,
                              item.exposure,
                              class_of(item),
                              item.impact.value,
                              number(item.loss, item.has_loss),
                              number(item.deaths, item.has_deaths),
                              number(item.individual, item.has_individual)};
            if (item.road) {
                feature.line = exposures.roads[i - exposures.buildings.size()].line;
                roads.push_back(std::move(feature));
            } else {
                feature.polygon = exposures.buildings[i].footprint;
                buildings.push_back(std::move(feature));
            }
        }
        const auto write = [&](const std::string& layer, const std::string& title,
                               const std::vector<geo::OutputFeature>& features, const std::string& style) -> Status {
            if (features.empty()) return {};
            TALUS_TRY(write_geopackage_layer(file.string(), layer, fields, features, result.scene().crs));
            layers.add_vector(title, "risk.gpkg", layer, style, k == 0);
            styles.push_back({layer, style});
            return {};
        };
        const std::string of = result.risks.size() > 1 ? ", " + result.name_of(k) : "";
        TALUS_TRY(write("buildings" + suffix(k), "Individual risk in buildings" + of, buildings,
                        report::qgis_vector_style("individual_risk_class", classes, "name")));
        report::VectorSymbol road;
        road.kind = report::VectorSymbol::Kind::line;
        road.line = {70, 70, 70};
        road.line_width = 1;
        TALUS_TRY(write("roads" + suffix(k), "Roads" + of, roads, report::qgis_vector_style(road, "name")));
    }
    return styles.empty() ? Status() : geo::write_geopackage_styles(file.string(), styles);
}

/// Removes what an earlier call wrote of options or maps that this one may not have.
void remove_earlier(const fs::path& folder) {
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
        const std::string stem = entry.path().stem().string(), extension = entry.path().extension().string();
        const bool map = stem.starts_with("individual_risk") || stem.starts_with("debris_frequency");
        const bool table = stem == "fn" || stem == "options" || stem == "differences";
        if ((map && (extension == ".tif" || extension == ".qml")) || (table && extension == ".csv")) {
            fs::remove(entry.path(), error);
        }
    }
}

}  // namespace

const params::OptionSpec* StudyResult::option(std::size_t index) const {
    const auto& all = scene().spec.options;
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const auto& o) { return o.name == study->options[index]; });
    return found == all.end() ? nullptr : &*found;
}

std::string StudyResult::name_of(std::size_t option) const {
    return study->options[option].empty() ? "As it is" : study->options[option];
}

Result<StudyResult> summarise(const Study& study) {
    StudyResult result;
    result.study = &study;
    for (const std::string& option : study.options) {
        TALUS_ASSIGN(OptionOutcome outcome, read_outcome(study, option));
        result.risks.push_back(evaluate(study.exposures, outcome.scenarios));
        result.outcomes.push_back(std::move(outcome));
        result.differences.push_back(
            result.outcomes.size() == 1
                ? Risk{}
                : difference(study.exposures, result.outcomes.back().scenarios, result.outcomes.front().scenarios));
    }
    return result;
}

report::HazardMap debris_style(const StudyResult& result, std::size_t option) {
    report::HazardMap style;
    style.file = "debris_frequency" + suffix(option);
    const double depth = result.scene().spec.outputs.arrival_depth;
    style.title = fmt::format("Debris deeper than {} m, events {}{}", depth, result.study->per(),
                              result.risks.size() > 1 ? ", " + result.name_of(option) : "");
    style.description = fmt::format("events {} with debris deeper than {} m", result.study->per(), depth);
    style.unit = result.study->per_event ? "" : "1/year";
    style.breaks = frequency_breaks;
    style.full_scale = frequency_breaks.back();
    style.ramp = {230, 0.05, 262, 0.14, 0.94, 0.28};
    return style;
}

report::HazardMap individual_style(const StudyResult& result, std::size_t option) {
    report::HazardMap style;
    style.file = "individual_risk" + suffix(option);
    style.title = fmt::format("Individual risk {}{}", result.study->per(),
                              result.risks.size() > 1 ? ", " + result.name_of(option) : "");
    style.description = fmt::format("probability of death {} of a person who is always there", result.study->per());
    style.unit = result.study->per_event ? "" : "1/year";
    style.breaks = individual_breaks;
    style.full_scale = individual_breaks.back();
    style.ramp = risk_ramp;
    return style;
}

Status write_study(const StudyResult& result, const fs::path& folder) {
    remove_earlier(folder);
    products::LayerDefinition layers(result.scene().spec.scene.title, result.scene().crs.wkt);
    TALUS_TRY(write_vectors(result, folder, layers));
    for (std::size_t k = 0; k < result.outcomes.size(); ++k) {
        const OptionOutcome& outcome = result.outcomes[k];
        TALUS_TRY(write_map(result, individual_style(result, k), outcome.individual, folder, k == 0, layers));
        TALUS_TRY(write_map(result, debris_style(result, k), outcome.debris, folder, false, layers));
    }
    if (const Grid<float>& reached = result.outcomes.front().debris; !reached.values.empty()) {
        std::vector<products::WriteJob> terrain;
        products::add_terrain(result.scene(), reached.geometry.extent(), folder, layers, terrain);
        for (const products::WriteJob& job : terrain) TALUS_TRY(job.write());
    }
    TALUS_TRY(layers.write(folder));
    TALUS_TRY(products::write_text_file(folder / "risk.csv", items_csv(result, result.risks, 0)));
    if (result.risks.front().total.has_deaths && !result.study->per_event) {
        TALUS_TRY(products::write_text_file(folder / "fn.csv", fn_csv(result)));
    }
    if (result.risks.size() > 1) {
        TALUS_TRY(products::write_text_file(folder / "differences.csv", items_csv(result, result.differences, 1)));
        TALUS_TRY(products::write_text_file(folder / "options.csv", options_csv(result)));
    }
    const nlohmann::ordered_json results = risk_results(result);
    TALUS_TRY(products::write_results(results, folder / "results.json"));
    TALUS_ASSIGN(const std::string page, risk_report(result, results));
    return products::write_text_file(folder / "report.html", page);
}

}  // namespace talus::risk
