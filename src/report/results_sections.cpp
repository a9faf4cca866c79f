// Discharge through cross-sections over time.
#include "core/number_or_null.hpp"
#include "report/number_text.hpp"
#include "report/place_results.hpp"

namespace talus::report {
namespace {

const observe::DischargeRecord& section_record(const NamedRun& run, std::size_t section) {
    return run.result->observation.cross_sections.at(section);
}

}  // namespace

Json cross_sections(const std::vector<NamedRun>& runs) {
    const std::size_t count = runs.front().result->observation.cross_sections.size();
    if (count == 0) return {};
    const PlaceRows rows{.place = {{"section", "Cross-section", ""}},
                         .values = {{"peak_discharge_m3ps", "Peak discharge", "m³/s", "f2"},
                                    {"peak_time_s", "at", "s", "f1", "", "nothing passed"},
                                    {"passed_m3", "Passed", "m³", "f1"}},
                         .place_of = [](const NamedRun& run, std::size_t k) -> Json {
                             return {{"section", section_record(run, k).section.name}};
                         },
                         .add_values =
                             [](Json& row, const NamedRun& run, std::size_t k) {
                                 const observe::DischargeRecord& record = section_record(run, k);
                                 row["peak_discharge_m3ps"] = record.peak_discharge;
                                 row["peak_time_s"] = number_or_null<Json>(record.peak_time);
                                 row["passed_m3"] = record.passed;
                             }};
    const PlacePlots plots{
        .title = "Discharge through cross-sections",
        .first_axis = "discharge, m³/s",
        .second_axis = "passed, m³",
        .shows = [](const NamedRun& run, std::size_t k) { return section_record(run, k).peak_discharge != 0; },
        .curves =
            [](const NamedRun& run, std::size_t k) {
                PlacePlots::Curves curves{{0}, {0}, {0}};
                for (const observe::DischargeSample& s : section_record(run, k).rows) {
                    curves.time.push_back(s.time);
                    curves.first.push_back(s.discharge);
                    curves.second.push_back(s.passed);
                }
                return curves;
            },
        .name = [&](std::size_t k) { return shortened(section_record(runs.front(), k).section.name, 40); }};
    auto [chart, not_drawn] = place_chart(runs, count, plots);
    return {
        {"table", place_table(runs, count, rows)}, {"chart", std::move(chart)}, {"not_drawn", std::move(not_drawn)}};
}

}  // namespace talus::report
