#include "report/second_opinion.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/angle.hpp"
#include "core/number_or_null.hpp"
#include "core/try.hpp"
#include "report/map.hpp"
#include "report/number_text.hpp"
#include "report/results.hpp"
#include "report_files.hpp"

namespace talus::report {
namespace {

constexpr Colour deep_orange{168, 74, 4}, orange{222, 135, 45}, pale_orange{247, 208, 150}, same{226, 226, 226},
    pale_blue{166, 206, 232}, blue{72, 144, 196}, deep_blue{14, 76, 138}, shared{92, 92, 100};

/// In which models a structure is hit.
enum HitBy { neither, depth_averaged_only, particles_only, both };
constexpr std::array<const char*, 4> hit_by_names = {"neither", "depth-averaged only", "particles only", "both"};

HitBy hit_by(const observe::BuildingImpact& particles, const observe::BuildingImpact& depth_averaged) {
    return static_cast<HitBy>((depth_averaged.hit ? 1 : 0) + (particles.hit ? 2 : 0));
}

/// The structures of both runs, side by side.
template <class F>
void for_each_structure(const BothModels& models, const F& f) {
    const auto &p = models.particles.observation.buildings, &d = models.depth_averaged.observation.buildings;
    for (std::size_t i = 0; i < std::min(p.size(), d.size()); ++i) f(p[i], d[i], hit_by(p[i], d[i]));
}

std::string structures_text(const BothModels& models) {
    std::array<std::vector<std::string>, 4> names;
    std::size_t count = 0;
    for_each_structure(models, [&](const auto& p, const auto&, HitBy by) {
        names.at(by).push_back(p.name.empty() ? "unnamed" : p.name);
        ++count;
    });
    if (count == names[neither].size()) return "";
    constexpr std::size_t most_named = 6;
    std::string text = fmt::format("Of {}, {} {} hit in both models", plural(count, "structure"), names[both].size(),
                                   names[both].size() == 1 ? "is" : "are");
    for (const auto& [by, model] :
         {std::pair{particles_only, "with particles"}, std::pair{depth_averaged_only, "in the depth-averaged model"}}) {
        std::vector<std::string>& list = names.at(by);
        if (list.empty()) continue;
        const std::size_t more = list.size() > most_named ? list.size() - most_named : 0;
        list.resize(list.size() - more);
        text += fmt::format("; {}{} only {}", fmt::join(list, ", "), more > 0 ? fmt::format(" and {} more", more) : "",
                            model);
    }
    return text + ".";
}

std::string area_text(const BothModels& models, const run::AreaAgreement& area) {
    const double iou = area.intersection_over_union();
    if (std::isnan(iou)) return "";
    return fmt::format(
        "Both models cover {} m² deeper than {} m, {} % of what either covers; {} m² are covered with particles only, "
        "{} m² in the depth-averaged model only.",
        fixed(area.both, 0), plain(models.scene.spec.outputs.arrival_depth), fixed(100 * iou, 0),
        fixed(area.only_first, 0), fixed(area.only_second, 0));
}

struct Quantity {
    std::string name, unit, format;
    double particles = observe::never, depth_averaged = observe::never, observed = observe::never;
};

std::vector<Quantity> quantities(const BothModels& models, const run::SecondOpinion& opinion) {
    std::vector<Quantity> all;
    const observe::Observation &p = models.particles.observation, &d = models.depth_averaged.observation;
    const auto add = [&](const std::string& name, const char* unit, const char* format, const auto& value) {
        all.push_back({name, unit, format, value(p), value(d)});
    };
    for (const params::ObservationSpec& observed : models.scene.spec.observations) {
        const std::string at = fmt::format(" at {} m", plain(observed.chainage));
        add("Front velocity" + at, "m/s", "f1",
            [&](const auto& o) { return front_at(o, observed.chainage).front_velocity; });
        all.back().observed = observed.front_velocity;
        add("Front arrival" + at, "s", "f1",
            [&](const auto& o) { return front_at(o, observed.chainage).arrival_time; });
    }
    add("Front to chainage", "m", "f0", [](const auto& o) { return o.run_out.front_chainage; });
    add("Run-out along the flow", "m", "f0", [](const auto& o) { return o.run_out.along_flow; });
    add("Run-out in a straight line", "m", "f0", [](const auto& o) { return o.run_out.straight; });
    add("Runout angle", "°", "f1", [](const auto& o) { return o.run_out.runout_angle * degrees_per_radian; });
    all.push_back({"Affected area", "m²", "f0", opinion.area.both + opinion.area.only_first,
                   opinion.area.both + opinion.area.only_second});
    add("Deposit, area", "m²", "f0", [](const auto& o) { return o.deposit.area; });
    add("Deposit, depth that nine tenths stay below", "m", "f2", [](const auto& o) { return o.deposit.depth; });
    add("Peak depth", "m", "f1", [](const auto& o) { return greatest(o.maps.peak_depth); });
    add("Peak speed", "m/s", "f1", [](const auto& o) { return greatest(o.maps.peak_speed); });
    add("Released volume", "m³", "f1", [](const auto& o) { return o.volume_released; });
    all.push_back({"Wall time", "s", "f1", models.particles.wall_time, models.depth_averaged.wall_time});
    return all;
}

Json quantity_rows(const BothModels& models, const run::SecondOpinion& opinion) {
    const bool observed = !models.scene.spec.observations.empty();
    std::vector<Column> columns = {{"quantity", "Quantity", ""},
                                   {"unit", "Unit", "", "", ""},
                                   {"particles", "Particles", "", "", "n"},
                                   {"depth_averaged", "Depth-averaged", "", "", "n"},
                                   {"difference_percent", "Difference", "%", "d0"}};
    if (observed) columns.push_back({"observed", "Observed", "", "", "n"});
    Json rows = table(columns, "comparison");
    const auto shown = [](double value, const std::string& format) {
        return std::isfinite(value) ? Json{{"value", value}, {"format", format}} : Json();
    };
    for (const Quantity& q : quantities(models, opinion)) {
        rows["rows"].push_back(
            {{"quantity", q.name},
             {"unit", q.unit},
             {"particles", shown(q.particles, q.format)},
             {"depth_averaged", shown(q.depth_averaged, q.format)},
             {"difference_percent",
              q.particles > 0 ? number_or_null<Json>(100 * (q.depth_averaged / q.particles - 1)) : Json()}});
        if (observed) rows["rows"].back()["observed"] = shown(q.observed, q.format);
    }
    return rows;
}

Json structure_rows(const BothModels& models) {
    Json rows = table({{"name", "Structure", ""},
                       {"hit_by", "Hit in", ""},
                       {"first_hit_s", "First hit", "s", "f1"},
                       {"first_hit_depth_averaged_s", "depth-averaged", "s", "f1"},
                       {"peak_force_kN", "Peak force", "kN", "s3"},
                       {"peak_force_depth_averaged_kN", "depth-averaged", "kN", "s3"},
                       {"peak_impact_pressure_kPa", "Impact pressure", "kPa", "s3"},
                       {"peak_impact_pressure_depth_averaged_kPa", "depth-averaged", "kPa", "s3"},
                       {"peak_depth_m", "Depth at walls", "m", "f2"},
                       {"peak_depth_depth_averaged_m", "depth-averaged", "m", "f2"}});
    for_each_structure(models, [&](const auto& p, const auto& d, HitBy by) {
        if (by == neither) return;
        Json row = {
            {"name", {{"value", p.name.empty() ? "unnamed" : p.name}, {"mark", fmt::format("hit-{}", int{by})}}},
            {"hit_by", hit_by_names.at(by)}};
        const auto add = [&](const observe::BuildingImpact& impact, const std::string& model) {
            const auto shown = [&](double value) { return impact.hit ? number_or_null<Json>(value) : Json(); };
            row["first_hit" + model + "_s"] = shown(impact.first_hit_time);
            row["peak_force" + model + "_kN"] = shown(impact.peak_force / 1e3);
            row["peak_impact_pressure" + model + "_kPa"] = shown(impact.peak_impact_pressure / 1e3);
            row["peak_depth" + model + "_m"] = shown(impact.peak_depth);
        };
        add(p, "");
        add(d, "_depth_averaged");
        rows["rows"].push_back(std::move(row));
    });
    return rows["rows"].empty() ? Json() : rows;
}

Json cards(const BothModels& models, const run::SecondOpinion& opinion) {
    Json all = Json::array();
    const run::AreaAgreement& area = opinion.area;
    all.push_back(key_figure("intersection_over_union_percent", "Agreement of the affected area",
                             number_or_null<Json>(100 * area.intersection_over_union()), "f0", "%",
                             "intersection over union"));
    const double p = models.particles.observation.run_out.along_flow,
                 d = models.depth_averaged.observation.run_out.along_flow;
    all.push_back(key_figure("run_out_along_flow_m", "Run-out along the flow, particles", number_or_null<Json>(p), "f0",
                             "m", std::isfinite(d) ? fmt::format("depth-averaged {} m", fixed(d, 0)) : ""));
    const auto difference = [&](const char* key, const char* name, const run::LargestDifference& largest, int digits,
                                const char* unit, const std::string& where) {
        const std::string format = fmt::format("f{}", digits);
        all.push_back(key_figure(key, name, largest.known() ? Json(std::abs(largest.size())) : Json(), format, unit,
                                 largest.known() ? fmt::format("{} {} with particles, {} {} depth-averaged, {}",
                                                               fixed(largest.particles, digits), unit,
                                                               fixed(largest.depth_averaged, digits), unit, where)
                                                 : ""));
    };
    difference("largest_depth_difference_m", "Largest difference in peak depth", opinion.depth, 1, "m",
               opinion.depth.known() ? place(models.scene, opinion.depth.at) : "");
    difference("largest_arrival_difference_s", "Largest difference in arrival of the front", opinion.arrival, 1, "s",
               fmt::format("at chainage {} m", fixed(opinion.arrival.chainage, 0)));
    std::array<int, 4> hits{};
    for_each_structure(models, [&](const auto&, const auto&, HitBy by) { ++hits.at(by); });
    const int one = hits[particles_only] + hits[depth_averaged_only];
    all.push_back(key_figure("structures_hit_in_one_model", "Structures hit in one model only", one, "f0", "",
                             fmt::format("{} in both, {} in neither", hits[both], hits[neither]), one > 0));
    return all;
}

HazardMap style_of(const char* file, const char* title, std::vector<Category> categories) {
    HazardMap style;
    style.file = file;
    style.title = title;
    style.categories = std::move(categories);
    return style;
}

/// Classes of a difference in depth, and their limits in m.
constexpr std::array<double, 6> limits = {-1, -0.5, -0.1, 0.1, 0.5, 1};

Grid<float> classes_of_difference(const Grid<float>& difference) {
    Grid<float> classes = difference;
    for (float& value : classes.values) {
        if (std::isnan(value)) continue;
        value =
            static_cast<float>(1 + (std::upper_bound(limits.begin(), limits.end(), double{value}) - limits.begin()));
    }
    return classes;
}

Grid<float> classes_of_area(const run::SecondOpinion& opinion, double least) {
    Grid<float> classes = opinion.difference;
    for (std::size_t i = 0; i < classes.values.size(); ++i) {
        const int by =
            (opinion.depth_averaged.values[i] > least ? 1 : 0) + (opinion.particles.values[i] > least ? 2 : 0);
        classes.values[i] = by == 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(by);
    }
    return classes;
}

}  // namespace

std::vector<std::string> differences(const BothModels& models, const run::SecondOpinion& opinion) {
    std::vector<std::string> all;
    const auto add = [&](std::string text) {
        if (!text.empty()) all.push_back(std::move(text));
    };
    add(area_text(models, opinion.area));
    const run::LargestDifference &depth = opinion.depth, &arrival = opinion.arrival;
    if (depth.known()) {
        add(fmt::format("Peak depths differ most {}: {} m with particles, {} m depth-averaged.",
                        place(models.scene, depth.at), fixed(depth.particles, 1), fixed(depth.depth_averaged, 1)));
    }
    if (arrival.known()) {
        add(
            fmt::format("The fronts are farthest apart in time at chainage {} m, where particles arrive after {} s and "
                        "the depth-averaged front {} s {}.",
                        fixed(arrival.chainage, 0), fixed(arrival.particles, 1), fixed(std::abs(arrival.size()), 1),
                        arrival.size() < 0 ? "earlier" : "later"));
    }
    const double p = models.particles.observation.run_out.front_chainage,
                 d = models.depth_averaged.observation.run_out.front_chainage;
    if (std::isfinite(p) && std::isfinite(d)) {
        add(fmt::format("The front comes to chainage {} m with particles and to {} m depth-averaged.", fixed(p, 0),
                        fixed(d, 0)));
    }
    add(structures_text(models));
    return all;
}

Json second_opinion_results(const BothModels& models, const run::SecondOpinion& opinion) {
    Json all = results_head("talus comparison", models.scene);
    const run::RunVerdict particles = judge(models.particles), grid = judge(models.depth_averaged);
    const Json of_particles = status(models.particles, particles), of_grid = status(models.depth_averaged, grid);
    const bool partial = of_particles["partial"].get<bool>() || of_grid["partial"].get<bool>();
    all.update({{"status",
                 {{"name", partial ? "a run did not come to its end" : "complete"},
                  {"partial", partial},
                  {"beyond_limits", beyond_limits(run::judge_together({particles, grid}))},
                  {"particles", of_particles},
                  {"depth_averaged", of_grid}}},
                {"verdict", {{"particles", verdict_json(particles)}, {"depth_averaged", verdict_json(grid)}}},
                {"agreement",
                 {{"intersection_over_union", number_or_null<Json>(opinion.area.intersection_over_union())},
                  {"both_m2", opinion.area.both},
                  {"particles_only_m2", opinion.area.only_first},
                  {"depth_averaged_only_m2", opinion.area.only_second},
                  {"cell_m", opinion.difference.geometry.cell},
                  {"arrival_depth_m", models.scene.spec.outputs.arrival_depth}}},
                {"differences", differences(models, opinion)},
                {"key_figures", cards(models, opinion)},
                {"quantities", quantity_rows(models, opinion)},
                {"structures", structure_rows(models)},
                {"fronts", fronts_chart(models.scene, {{"particles", &models.particles},
                                                       {"depth-averaged", &models.depth_averaged}})},
                {"gauges", gauges({{"particles", &models.particles}, {"depth-averaged", &models.depth_averaged}})},
                {"as_computed",
                 {{"particles", chosen_values(models.scene, models.particles)},
                  {"depth_averaged", chosen_values(models.grid_scene, models.depth_averaged)}}},
                {"notes", models.grid_scene.notes},
                {"hashes",
                 {{"particles", fmt::format("{:016x}", models.particles.hash)},
                  {"depth_averaged", fmt::format("{:016x}", models.depth_averaged.hash)}}}});
    return all;
}

Result<std::string> second_opinion_report(const BothModels& models, const run::SecondOpinion& opinion,
                                          const Json& results) {
    const observe::HazardMaps &p = models.particles.observation.maps, &d = models.depth_averaged.observation.maps;
    HazardMap depth = hazard_maps().front();
    depth.full_scale = std::max(greatest(p.peak_depth), greatest(d.peak_depth));
    const Grid<float> difference_classes = classes_of_difference(opinion.difference);
    const Grid<float> areas = classes_of_area(opinion, models.scene.spec.outputs.arrival_depth);

    MapContent content = map_content(models.scene, models.particles);
    content.reached = &opinion.difference;
    content.farthest_chainage =
        std::fmax(content.farthest_chainage, models.depth_averaged.observation.run_out.front_chainage);
    content.cell = opinion.difference.geometry.cell;
    if (!results["status"]["beyond_limits"].is_null()) content.beyond_limits = results["status"]["beyond_limits"];
    content.buildings.title = "Structures hit in";
    for (std::size_t k = 0; k < hit_by_names.size(); ++k) content.buildings.class_names.at(k) = hit_by_names.at(k);
    content.buildings.classes.clear();
    content.buildings.titles.clear();
    for_each_structure(models, [&](const auto& impact, const auto&, HitBy by) {
        content.buildings.classes.push_back(by);
        content.buildings.titles.push_back(fmt::format("{}: {}", impact.name.empty() ? "unnamed" : impact.name,
                                                       by == neither ? "not hit" : hit_by_names.at(by)));
    });
    content.layers.clear();
    depth.file = "peak_depth_particles";
    content.layers.push_back({depth, &p.peak_depth, "Peak depth, particles",
                              "Greatest vertical flow depth at each place, with particles.", 2});
    depth.file = "peak_depth_depth_averaged";
    content.layers.push_back({depth, &d.peak_depth, "Peak depth, depth-averaged",
                              "Greatest vertical flow depth at each place, in the depth-averaged model.", 2});
    content.layers.push_back(
        {style_of("difference", "Difference in peak depth",
                  {{"below −1 m", deep_orange},
                   {"−1 – −0.5 m", orange},
                   {"−0.5 – −0.1 m", pale_orange},
                   {"−0.1 – 0.1 m", same},
                   {"0.1 – 0.5 m", pale_blue},
                   {"0.5 – 1 m", blue},
                   {"over 1 m", deep_blue}}),
         &difference_classes, "Difference",
         "Peak depth of the depth-averaged model less that of the particles, as means over the same cells; blue where "
         "the depth-averaged model is deeper, orange where the particles are.",
         0, "depth-averaged less particles"});
    content.layers.push_back({style_of("affected_area", "Affected area",
                                       {{"depth-averaged only", blue}, {"particles only", orange}, {"both", shared}}),
                              &areas, "Affected area", "Where debris stood deeper than the arrival depth.", 0,
                              "deeper than the arrival depth"});
    TALUS_ASSIGN(auto maps, map_figures(models.scene, content));
    Json page = results;
    page["report_name"] = "two models compared";
    page["masthead"] = "Landslide run-out, two models compared";
    page["maps"] = std::move(maps);
    page["verdicts"] = Json::array({named_verdict("Particles", results["verdict"]["particles"]),
                                    named_verdict("Depth-averaged", results["verdict"]["depth_averaged"])});
    return render(report_files::second_opinion_html, page);
}

}  // namespace talus::report
