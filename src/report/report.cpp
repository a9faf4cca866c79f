#include "report/report.hpp"

#include "core/try.hpp"
#include "report/map.hpp"
#include "report_files.hpp"

namespace talus::report {

Result<std::string> run_report(const scene::Scene& scene, const run::RunResult& result, const Json& results) {
    MapContent content = map_content(scene, result);
    content.not_converged = results["verdict"]["not_converged"];
    TALUS_ASSIGN(auto maps, map_figures(scene, content));
    TALUS_ASSIGN(auto zone_map, zone_figure(scene, content, maps["contour_interval"]));
    TALUS_ASSIGN(auto location, location_figure(scene, content));
    Json page = results;
    page["report_name"] = "landslide run-out report";
    page["masthead"] = "Landslide run-out simulation";
    page["maps"] = std::move(maps);
    page["location"] = std::move(location);
    page["zone_map"] = std::move(zone_map);
    return render(report_files::report_html, page);
}

}  // namespace talus::report
