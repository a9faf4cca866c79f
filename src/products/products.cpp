#include "products/products.hpp"

#include <fmt/format.h>

#include "core/try.hpp"
#include "products/fault_files.hpp"
#include "products/results_json.hpp"
#include "products/text_file.hpp"
#include "products/writers.hpp"
#include "report/report.hpp"
#include "report/results.hpp"

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

}  // namespace

Status write_products(const scene::Scene& scene, const run::RunResult& result, const std::filesystem::path& folder,
                      const std::vector<run::Comparison>& comparisons, std::string_view changed,
                      const std::vector<double>& frame_times, std::vector<std::string>* missing) {
    TALUS_TRY(write_partial_note(result, folder));
    if (result.fault) TALUS_TRY(write_fault(*result.fault, folder / "fault"));
    LayerDefinition layers(title_of(scene, result), scene.crs.wkt);
    TALUS_TRY(write_maps(scene, result, folder, layers));
    TALUS_TRY(write_terrain(scene, result.observation.maps.peak_depth.geometry.extent(), folder, layers));
    add_maps_over_time(scene, result, frame_times, folder, layers);
    TALUS_TRY(write_tables(scene, result, folder, changed));
    TALUS_TRY(write_vectors(scene, result, folder, layers, missing));
    TALUS_TRY(layers.write(folder));
    TALUS_TRY(write_kml(scene, result, folder));
    TALUS_TRY(write_comparisons(comparisons, result, folder));
    TALUS_TRY(write_report(scene, result, comparisons, folder));
    TALUS_TRY(write_stac_item(scene, result, folder));
    // Last, as it lists the files; a folder that has one is complete.
    return write_manifest(scene, result, comparisons, folder);
}

}  // namespace talus::products
