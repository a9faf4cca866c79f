#include <string>

#include "core/try.hpp"
#include "products/csv.hpp"
#include "products/text_file.hpp"
#include "products/writers.hpp"

namespace talus::products {

namespace {

std::string header(const run::Comparison& comparison) {
    std::string text = "variant,overrides,outcome";
    for (const run::Quantity& quantity : comparison.quantities) {
        text += "," + quantity.key + "_" + quantity.suffix + "," + quantity.key + "_change_percent";
    }
    return text +
           ",particles,particle_spacing_m,steps,simulated_time_s,wall_time_s,worst_mean_compression,"
           "worst_overcompressed_share";
}

void add_cost(Csv& csv, const run::RunResult& result) {
    const auto of_particles = [&](double value) { return result.depth_averaged() ? observe::never : value; };
    const observe::Compression& c = result.observation.compression;
    csv.row({of_particles(result.particles), of_particles(result.particle_spacing), static_cast<double>(result.steps),
             result.simulated_time, result.wall_time, of_particles(c.worst_mean),
             of_particles(c.worst_overcompressed_share)});
}

std::string outcome(const run::Comparison& comparison, const run::Comparison::Row& row) {
    if (!row.run.result) return "missing: " + row.run.missing;
    if (comparison.kind == run::ComparisonKind::sensitivity) return "complete";
    return verdict_name(row.verdict());
}

std::string comparison_table(const run::Comparison& comparison, const run::RunResult& base) {
    Csv csv(header(comparison));
    csv.word("as given").word("").word("base");
    for (const run::Quantity& quantity : comparison.quantities) csv.number(quantity.base).number(observe::never);
    add_cost(csv, base);
    for (const run::Comparison::Row& row : comparison.rows) {
        std::string overrides;
        for (const std::string& text : row.run.variant.overrides) overrides += (overrides.empty() ? "" : " ") + text;
        csv.word(row.run.variant.name).word(overrides).word(outcome(comparison, row));
        for (const run::Change& change : row.changes) csv.number(change.value).number(change.percent);
        if (row.run.result) {
            add_cost(csv, *row.run.result);
        } else {
            csv.row({observe::never, observe::never, observe::never, observe::never, observe::never, observe::never,
                     observe::never});
        }
    }
    return csv.text();
}

}  // namespace

Status write_comparisons(const std::vector<run::Comparison>& comparisons, const run::RunResult& base,
                         const std::filesystem::path& folder) {
    for (const run::Comparison& comparison : comparisons) {
        const char* name = comparison.kind == run::ComparisonKind::convergence ? "convergence.csv" : "variants.csv";
        TALUS_TRY(write_text_file(folder / name, comparison_table(comparison, base)));
    }
    return {};
}

}  // namespace talus::products
