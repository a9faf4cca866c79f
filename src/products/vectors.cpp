#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/try.hpp"
#include "geo/raster_outline.hpp"
#include "geo/vector.hpp"
#include "products/writers.hpp"
#include "report/intensity.hpp"
#include "report/vector_style.hpp"

namespace talus::products {

namespace {

/// The tables of a GeoPackage, and which of them have features.
class Tables {
  public:
    Tables(std::string file, const geo::Crs& crs) : file_(std::move(file)), crs_(crs) {}

    [[nodiscard]] Status write(const std::string& table, const std::vector<geo::Field>& fields,
                               const std::vector<geo::OutputFeature>& features) {
        if (!features.empty()) filled_.insert(table);
        return write_geopackage_layer(file_, table, fields, features, crs_);
    }
    [[nodiscard]] const std::string& file() const { return file_; }
    [[nodiscard]] bool has_features(const std::string& table) const { return filled_.count(table) != 0; }

  private:
    std::string file_;
    const geo::Crs& crs_;
    std::set<std::string> filled_;
};

Status write_buildings(const scene::Scene& scene, const observe::Observation& observation, Tables& tables) {
    std::vector<geo::Field> fields;
    for (const auto& [name, value] : building_row(scene, {}, nullptr)) {
        fields.push_back({name, std::holds_alternative<std::string>(value)});
    }
    std::vector<geo::OutputFeature> features;
    for (std::size_t i = 0; i < scene.buildings.size() && i < observation.buildings.size(); ++i) {
        features.push_back({scene.buildings[i].footprint, {}, {}});
        for (auto& [name, value] : building_row(scene, observation.buildings[i], &scene.buildings[i])) {
            features.back().values.push_back(std::move(value));
        }
    }
    return tables.write("buildings", fields, features);
}

/// A polygon per patch; `volume_m3` is that of the whole release.
Status write_releases(const scene::Scene& scene, Tables& tables) {
    std::vector<geo::OutputFeature> features;
    for (const terrain::Release& release : scene.releases) {
        for (const terrain::ReleasePatch& patch : release.patches) {
            // Where a raster gives the thickness there is no single value.
            const double thickness = release.thickness_raster ? observe::never : patch.thickness;
            features.push_back(
                {{patch.polygon}, {}, {release.name, release.spec.start_time, thickness, release.volume}});
        }
    }
    return tables.write("release", {{"name", true}, {"start_time_s"}, {"thickness_m"}, {"release_volume_m3"}},
                        features);
}

/// The front sample nearest to a chainage; null beyond the front.
const observe::FrontSample* front_near(const std::vector<observe::FrontSample>& front, double chainage, double reach) {
    const auto after = std::lower_bound(front.begin(), front.end(), chainage,
                                        [](const observe::FrontSample& f, double c) { return f.chainage < c; });
    const observe::FrontSample* best = nullptr;
    for (const auto it : {after, after == front.begin() ? after : after - 1}) {
        if (it == front.end() || std::abs(it->chainage - chainage) > reach) continue;
        if (best == nullptr || std::abs(it->chainage - chainage) < std::abs(best->chainage - chainage)) best = &*it;
    }
    return best;
}

/// A short line across the path every 10 m, with the values of the front there.
std::vector<geo::OutputFeature> chainage_marks(const scene::Scene& scene, const observe::Observation& observation) {
    constexpr double spacing = 10, half_width = 3, half_span = 1;  // m
    const terrain::FlowPath& path = scene.flow_path;
    std::vector<geo::OutputFeature> features;
    for (int k = 0; k * spacing <= path.length(); ++k) {
        const double chainage = k * spacing;
        const PlanPoint middle = path.point_at(chainage);
        const PlanPoint before = path.point_at(chainage - half_span), after = path.point_at(chainage + half_span);
        const double span = std::hypot(after.x - before.x, after.y - before.y);
        if (!(span > 0)) continue;
        const double across_x = -(after.y - before.y) / span * half_width;
        const double across_y = (after.x - before.x) / span * half_width;
        const observe::FrontSample* front =
            front_near(observation.front, chainage, 0.51 * scene.spec.outputs.chainage_interval);
        features.push_back({{},
                            {{middle.x - across_x, middle.y - across_y}, {middle.x + across_x, middle.y + across_y}},
                            {chainage, front != nullptr ? front->arrival_time : observe::never,
                             front != nullptr ? front->front_velocity : observe::never}});
    }
    return features;
}

/// The cells of every intensity class that occurs, a feature per class.
Status write_intensity(const scene::Scene& scene, const observe::Observation& observation, Tables& tables) {
    const report::IntensityGuideline& guideline = report::intensity_guideline(scene.spec.outputs.intensity_guideline);
    const Grid<float> map = intensity_map(guideline, observation.maps);
    std::vector<geo::OutputFeature> features;
    TALUS_ASSIGN(auto outlines, geo::class_outlines(map, guideline.classes.size()));
    for (geo::ClassOutline& outline : outlines) {
        const report::IntensityClass& c = guideline.classes[outline.number - 1];
        features.push_back({std::move(outline.polygons),
                            {},
                            {static_cast<double>(outline.number), c.name, c.criterion, guideline.name, outline.area}});
    }
    return tables.write(
        "intensity", {{"class"}, {"intensity", true}, {"criterion", true}, {"guideline", true}, {"area_m2"}}, features);
}

/// One feature: where a map is at least `level`, m.
Status write_outline(const Grid<float>& map, double level, const char* layer, Tables& tables) {
    Grid<float> inside = map;
    for (float& value : inside.values) value = value >= static_cast<float>(level) ? 1 : 0;
    std::vector<geo::OutputFeature> features;
    TALUS_ASSIGN(auto outlines, geo::class_outlines(inside, 1));
    for (geo::ClassOutline& outline : outlines) {
        features.push_back({std::move(outline.polygons), {}, {level, outline.area}});
    }
    return tables.write(layer, {{"above_m"}, {"area_m2"}}, features);
}

/// A point per gauge.
Status write_gauges(const observe::Observation& observation, Tables& tables) {
    std::vector<geo::OutputFeature> features;
    for (const observe::GaugeRecord& g : observation.gauges) {
        features.push_back({{},
                            {g.gauge.at},
                            {g.gauge.name, g.gauge.chainage, g.arrival_time, g.peak_depth, g.peak_depth_time,
                             g.peak_speed, g.peak_speed_time}});
    }
    return tables.write("gauges",
                        {{"name", true},
                         {"chainage_m"},
                         {"first_arrival_time_s"},
                         {"peak_depth_m"},
                         {"peak_depth_time_s"},
                         {"peak_speed_mps"},
                         {"peak_speed_time_s"}},
                        features);
}

/// A line per cross-section.
Status write_cross_sections(const observe::Observation& observation, Tables& tables) {
    std::vector<geo::OutputFeature> features;
    for (const observe::DischargeRecord& r : observation.cross_sections) {
        features.push_back({{}, r.section.line, {r.section.name, r.peak_discharge, r.peak_time, r.passed}});
    }
    return tables.write("cross_sections",
                        {{"name", true}, {"peak_discharge_m3ps"}, {"peak_discharge_time_s"}, {"passed_m3"}}, features);
}

Status write_zoom(const run::ZoomRecord& zoom, Tables& tables) {
    return tables.write("zoom", {{"around", true}, {"volume_in_m3"}, {"particle_spacing_m"}},
                        {{{zoom.area}, {}, {zoom.around, zoom.brought_volume, zoom.particle_spacing}}});
}

struct DrawnLayer {
    const char *table, *title;
    bool shown;  ///< where all are opened at once
    std::string style;
};

/// How QGIS draws the layers, those on top first.
std::vector<DrawnLayer> drawn_layers(const scene::Scene& scene, const run::RunResult& result) {
    using report::Colour;
    using report::qgis_vector_style;
    using report::VectorClass;
    using report::VectorSymbol;
    using Kind = VectorSymbol::Kind;
    const Colour dark{60, 60, 60}, red{179, 32, 43}, blue{20, 80, 140}, brown{122, 84, 48};
    std::vector<VectorClass> buildings, intensities;
    for (const report::IntensityClass& c :
         report::intensity_guideline(scene.spec.outputs.intensity_guideline).classes) {
        intensities.push_back({c.name, c.name, VectorSymbol{c.colour, c.colour, 170, 0.1}});
        buildings.push_back({c.name, "intensity " + c.name, VectorSymbol{c.colour, dark}});
    }
    buildings.push_back({"", "no intensity class", VectorSymbol{{217, 217, 217}, dark}});
    std::vector<DrawnLayer> layers;
    if (!result.observation.gauges.empty()) {
        const VectorSymbol gauge{blue, {255, 255, 255}, 255, 0.3, Kind::point};
        layers.push_back({"gauges", "Gauges", true, qgis_vector_style(gauge, "name")});
    }
    if (!result.observation.cross_sections.empty()) {
        const VectorSymbol section{{}, red, 255, 0.6, Kind::line};
        layers.push_back({"cross_sections", "Cross-sections", true, qgis_vector_style(section, "name")});
    }
    if (result.zoom) {
        const VectorSymbol boundary{red, red, 0, 0.5};
        layers.push_back({"zoom", "Boundary of the zoom", true, qgis_vector_style(boundary)});
    }
    if (!scene.flow_path.empty()) {
        const VectorSymbol mark{{}, dark, 255, 0.2, Kind::line}, path{{}, blue, 255, 0.5, Kind::line};
        layers.push_back({"chainage", "Chainage, m", false, qgis_vector_style(mark, "chainage_m")});
        layers.push_back({"flow_path", "Flow path", true, qgis_vector_style(path)});
    }
    layers.insert(layers.end(),
                  {{"buildings", "Buildings", true, qgis_vector_style("intensity", buildings, "name")},
                   {"release", "Release", true, qgis_vector_style(VectorSymbol{red, red, 40, 0.5})},
                   {"deposit", "Deposit", false, qgis_vector_style(VectorSymbol{brown, brown, 60, 0.4})},
                   {"inundation", "Inundation", true, qgis_vector_style(VectorSymbol{blue, blue, 0, 0.5})},
                   {"intensity", "Intensity zones", false, qgis_vector_style("intensity", intensities)}});
    return layers;
}

}  // namespace

Status write_vectors(const scene::Scene& scene, const run::RunResult& result, const std::filesystem::path& folder,
                     LayerDefinition& layers, std::vector<std::string>* missing) {
    Tables tables((folder / "results.gpkg").string(), scene.crs);
    const observe::Observation& observation = result.observation;
    TALUS_TRY(write_buildings(scene, observation, tables));
    TALUS_TRY(write_releases(scene, tables));
    TALUS_TRY(write_intensity(scene, observation, tables));
    const double least = scene.spec.outputs.arrival_depth;
    TALUS_TRY(write_outline(observation.maps.peak_depth, least, "inundation", tables));
    TALUS_TRY(write_outline(observation.maps.deposit_depth, least, "deposit", tables));
    if (!observation.gauges.empty()) TALUS_TRY(write_gauges(observation, tables));
    if (!observation.cross_sections.empty()) TALUS_TRY(write_cross_sections(observation, tables));
    if (result.zoom) TALUS_TRY(write_zoom(*result.zoom, tables));
    if (!scene.flow_path.empty()) {
        const geo::OutputFeature line{
            {}, scene.flow_path.points(), {scene.flow_path.length(), std::string(origin_text(scene.flow_path_origin))}};
        TALUS_TRY(tables.write("flow_path", {{"length_m"}, {"origin", true}}, {line}));
        TALUS_TRY(tables.write("chainage", {{"chainage_m"}, {"first_arrival_time_s"}, {"front_velocity_mps"}},
                               chainage_marks(scene, observation)));
    }
    std::vector<WrittenLayer> contours;
    if (Status drawn = write_contours(scene, result, tables.file(), contours); !drawn) {
        if (missing == nullptr) return drawn;
        missing->push_back(drawn.error().message);
    }
    std::vector<geo::LayerStyle> styles;
    for (const WrittenLayer& layer : contours) {
        styles.push_back({layer.table, layer.style});
        layers.add_vector(layer.title, "results.gpkg", layer.table, layer.style, true);
    }
    for (const DrawnLayer& layer : drawn_layers(scene, result)) {
        styles.push_back({layer.table, layer.style});
        // A table without features would be a layer in which there is nothing to see.
        if (!tables.has_features(layer.table)) continue;
        layers.add_vector(layer.title, "results.gpkg", layer.table, layer.style, layer.shown);
    }
    return geo::write_geopackage_styles(tables.file(), styles);
}

}  // namespace talus::products
