#include <ctime>
#include <string>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "products/products.hpp"
#include "products/report_map.hpp"
#include "products/report_sections.hpp"
#include "products/report_text.hpp"
#include "report_files.hpp"

namespace talus {

using namespace report;

Result<std::string> render_report(const Scene& scene, const RunResult& result,
                                  const std::vector<Comparison>& comparisons) {
    const MapContent content = map_content(scene, result);
    auto maps = render_maps(scene, content);
    if (!maps) return maps.error();
    const SceneInfo& info = scene.spec.scene;
    const std::string title = escape(info.title.empty() ? scene.file.stem().string() : info.title);
    const std::string date = fmt::format("{:%d %B %Y, %H:%M} UTC", fmt::gmtime(std::time(nullptr)));
    const bool partial = result.status != RunStatus::complete;
    const char* status = result.status == RunStatus::complete      ? "complete"
                         : result.status == RunStatus::interrupted ? "partial: interrupted"
                                                                   : "partial: fault";
    // Running heads on paper: what must not be overlooked is said on every page.
    std::string page_note = info.reconstruction ? "Reconstruction, not surveyed" : "";
    if (partial) page_note += page_note.empty() ? "Partial result" : " · Partial result";
    const bool forces = has_structure_figure(result);
    const std::string nets = net_figure(result);
    const int net_number = maps->count + 1 + (forces ? 1 : 0);
    const int first_figure_after_maps = net_number + (nets.empty() ? 0 : 1);
    const std::string force_figure =
        forces ? fill(report_files::forces_html, {{"number", fmt::format("{}", maps->count + 1)},
                                                  {"figure", structure_figure(result)},
                                                  {"window", plain(scene.spec.outputs.impact_filter_window)}})
               : "";
    const std::string net_part =
        nets.empty() ? ""
                     : fill(report_files::nets_html, {{"number", fmt::format("{}", net_number)}, {"figure", nets}});
    const int zone_number = first_figure_after_maps + 2;
    const Result<std::string> zones = zone_section(scene, content, *maps, zone_number);
    if (!zones) return zones.error();
    const int inflow_number = zone_number + (zones->empty() ? 0 : 1);
    const std::string inflow = inflow_section(scene, result, inflow_number);
    const int erosion_number = inflow_number + (inflow.empty() ? 0 : 1);
    const std::string erosion = erosion_section(scene, result, erosion_number);
    const int first_of_comparisons = erosion_number + (erosion.empty() ? 0 : 1);
    const std::string description =
        info.description.empty() ? "" : "<p class=\"lead\">" + escape(info.description) + "</p>";
    return fill(report_files::report_html,
                {{"title", title},
                 {"style", report_files::report_css},
                 {"script", report_files::report_js},
                 {"page_note", page_note},
                 {"date", date},
                 {"status", status},
                 {"status_class", partial ? "partial" : "complete"},
                 {"version", TALUS_VERSION},
                 {"description", description},
                 {"banners", banners(scene, result) + comparison_banners(comparisons)},
                 {"key_results", key_results(scene, result)},
                 {"observation_table", observation_table(scene, result)},
                 {"run_quality", run_quality(scene, result)},
                 {"map_definitions", maps->definitions},
                 {"map_figures", maps->figures},
                 {"map_read_out", maps->read_out},
                 {"crs", escape(scene.crs.label())},
                 {"front_number", fmt::format("{}", first_figure_after_maps)},
                 {"front_figure", front_figure(scene, result)},
                 {"front_window", plain(scene.spec.outputs.front_velocity_window)},
                 {"time_number", fmt::format("{}", first_figure_after_maps + 1)},
                 {"time_figure", time_figure(result)},
                 {"zones", *zones},
                 {"inflow", inflow},
                 {"erosion", erosion},
                 {"comparisons", comparison_sections(comparisons, scene, result, first_of_comparisons)},
                 {"building_table", building_table(scene, result)},
                 {"barrier_table", barrier_table(result)},
                 {"force_figure", force_figure + net_part},
                 {"chosen_values", chosen_values(scene, result)},
                 {"parameter_table", parameter_table(scene)},
                 {"method", method(scene)},
                 {"assumptions", assumptions(scene)},
                 {"input_table", input_table(scene)},
                 {"computation_table", computation_table(scene, result)}});
}

}  // namespace talus
