#include "report/report.hpp"

#include "core/try.hpp"
#include "report/map.hpp"
#include "report/results.hpp"
#include "report_files.hpp"

namespace talus::report {

Result<std::string> run_report(const scene::Scene& scene, const run::RunResult& result, const Json& results) {
    MapContent content = map_content(scene, result);
    if (!results["status"]["beyond_limits"].is_null()) content.beyond_limits = results["status"]["beyond_limits"];
    TALUS_ASSIGN(auto maps, map_figures(scene, content));
    TALUS_ASSIGN(auto zone_map, zone_figure(scene, content, maps["contour_interval"]));
    TALUS_ASSIGN(auto location, location_figure(scene, content));
    Json page = results;
    page["report_name"] = "landslide run-out report";
    page["masthead"] = "Landslide run-out simulation";
    page["maps"] = std::move(maps);
    page["verdicts"] = Json::array({named_verdict("", results["verdict"])});
    page["location"] = std::move(location);
    page["zone_map"] = std::move(zone_map);
    return render(report_files::report_html, page);
}

}  // namespace talus::report
