#include "products/products.hpp"

#include <cstddef>
#include <vector>

#include <fmt/format.h>

#include "core/phases.hpp"
#include "core/try.hpp"
#include "products/fault_files.hpp"
#include "products/results_json.hpp"
#include "products/text_file.hpp"
#include "products/writers.hpp"
#include "report/report.hpp"
#include "report/results.hpp"
#include "run/threads.hpp"
#include "simd/parallel.hpp"

namespace talus::products {

namespace {

/// A file whose name shows that the run did not end by itself.
Status write_partial_note(const run::RunResult& result, const std::filesystem::path& folder) {
    if (result.status == run::RunStatus::complete) return {};
    const std::string text = fmt::format(
        "These results are partial: the run ended after {:.6g} s of simulated time ({}).\n{}\n"
        "Peaks, run-out and impacts are those up to then; the deposit is where debris was at that moment.\n",
        result.simulated_time, status_text(result.status), result.stop_reason);
    return write_text_file(folder / "PARTIAL.txt", text);
}

/// results.json and report.html, which displays it.
Status write_report(const scene::Scene& scene, const run::RunResult& result,
                    const std::vector<run::Comparison>& comparisons, const std::filesystem::path& folder) {
    const report::Json results = report::run_results(scene, result, comparisons);
    TALUS_TRY(write_results(results, folder / "results.json"));
    TALUS_ASSIGN(const auto page, report::run_report(scene, result, results));
    return write_text_file(folder / "report.html", page);
}

/// Errors: that of the first job in their order, whichever failed first.
Status write_beside_each_other(const std::vector<WriteJob>& jobs, PhaseTimes& times) {
    std::vector<Status> written(jobs.size());
    // The report takes longest: it comes first.
    simd::parallel_ranges(jobs.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) {
            const std::size_t job = jobs.size() - 1 - k;
            written[job] = times.time(jobs[job].name, jobs[job].write);
        }
    });
    for (const Status& status : written) TALUS_TRY(status);
    return {};
}

}  // namespace

Status write_products(const scene::Scene& scene, const run::RunResult& result, const std::filesystem::path& folder,
                      const std::vector<run::Comparison>& comparisons, std::string_view changed,
                      const std::vector<double>& frame_times, std::vector<std::string>* missing) {
    TALUS_TRY(write_partial_note(result, folder));
    if (result.fault) TALUS_TRY(write_fault(*result.fault, folder / "fault"));
    PhaseTimes times;
    const run::Threads threads(scene.spec.solver.thread_count);
    LayerDefinition layers(title_of(scene, result), scene.crs.wkt);
    std::vector<WriteJob> jobs;
    add_maps(scene, result, folder, layers, jobs);
    add_terrain(scene, result.observation.maps.peak_depth.geometry.extent(), folder, layers, jobs);
    add_maps_over_time(scene, result, frame_times, folder, layers);
    jobs.push_back({"tables", [&] { return write_tables(scene, result, folder, changed); }});
    // The only job that adds to `layers`.
    jobs.push_back({"vectors", [&] { return write_vectors(scene, result, folder, layers, missing); }});
    jobs.push_back({"kml", [&] { return write_kml(scene, result, folder); }});
    jobs.push_back({"report", [&] { return write_report(scene, result, comparisons, folder); }});
    TALUS_TRY(threads.execute([&] { return write_beside_each_other(jobs, times); }));
    TALUS_TRY(layers.write(folder));
    TALUS_TRY(write_comparisons(comparisons, result, folder));
    TALUS_TRY(write_stac_item(scene, result, folder));
    // Last, as it lists the files; a folder that has one is complete.
    return write_manifest(scene, result, comparisons, folder, times.all());
}

}  // namespace talus::products
