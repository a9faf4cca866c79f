#include "ensemble/finished_ensemble.hpp"

#include <array>
#include <fstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "ensemble/ensemble_folder.hpp"
#include "ensemble/ensemble_products.hpp"
#include "ensemble/hazard_zones.hpp"
#include "report/intensity.hpp"

namespace talus::ensemble {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string name_of(const fs::path& folder) {
    const fs::path whole = fs::absolute(folder).lexically_normal();
    return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

std::string terrain_hash_of(const Json& definition) {
    for (const Json& input : definition.value("inputs", Json::array())) {
        if (input.value("role", "") == "terrain") return input.value("hash", "");
    }
    return "";
}

void add_map(FinishedEnsemble& ensemble, const fs::path& folder, FinishedMap map) {
    map.file = folder / (map.style.file + ".tif");
    std::error_code error;
    if (fs::is_regular_file(map.file, error)) ensemble.maps.push_back(std::move(map));
}

/// The probabilities of the classes of a guideline, and the zones that follow from them.
void add_intensity_maps(FinishedEnsemble& ensemble, const fs::path& folder, const std::string& guideline_name) {
    using enum params::GuidelineChoice;
    for (const params::GuidelineChoice choice : {swiss_debris_flow, swiss_flood, garcia_2003}) {
        const report::IntensityGuideline& guideline = report::intensity_guideline(choice);
        if (guideline.name != guideline_name) continue;
        for (std::size_t k = 0; k < guideline.classes.size(); ++k) {
            const bool most_severe = k + 1 == guideline.classes.size();
            add_map(ensemble, folder,
                    {FinishedMap::Kind::probability,
                     "intensity",
                     observe::never,
                     "",
                     intensity_odds_style(guideline.classes[k], most_severe),
                     {}});
        }
        if (const HazardMatrix* matrix = hazard_matrix(choice)) {
            add_map(ensemble, folder,
                    {FinishedMap::Kind::zones, "intensity", observe::never, "", zone_style(*matrix), {}});
        }
    }
}

}  // namespace

Result<FinishedEnsemble> read_finished_ensemble(const fs::path& folder) {
    std::error_code error;
    if (!fs::is_directory(folder, error)) return Error{folder.string() + ": is no folder"};
    TALUS_ASSIGN(const Json definition, read_definition(folder));
    const Result<EnsemblePlan> plan = plan_of(definition);
    if (!plan) return Error{fmt::format("{}: {}", folder.string(), plan.error().message)};
    // It is written last, so the maps are complete if it exists.
    std::ifstream in(folder / "statistics.json");
    const Json statistics = Json::parse(in, nullptr, false);
    if (!statistics.is_object()) {
        return Error{
            fmt::format("{}: is not finished (no statistics.json); run talus ensemble on it again, or "
                        "talus ensemble merge",
                        folder.string())};
    }
    FinishedEnsemble made;
    made.name = name_of(folder);
    made.factors = plan->factors;
    Thresholds counted;
    try {
        made.complete = statistics.at("complete").get<std::size_t>();
        made.failed = statistics.at("failed").size();
        made.terrain_hash = terrain_hash_of(definition);
        if (const std::size_t missing = statistics.at("missing").size(); missing > 0) {
            return Error{
                fmt::format("{}: is not finished, {} of its {} runs are missing; run talus ensemble on it "
                            "again",
                            folder.string(), missing, statistics.at("runs").get<std::size_t>())};
        }
        const Json& thresholds = statistics.at("thresholds");
        counted = {thresholds.at("depth_m").get<std::vector<double>>(),
                   thresholds.at("speed_mps").get<std::vector<double>>(),
                   thresholds.at("pressure_kPa").get<std::vector<double>>()};
    } catch (const Json::exception& wrong) {
        return Error{fmt::format("{}: statistics.json is not as talus writes it: {}", folder.string(), wrong.what())};
    }
    const std::array<const std::vector<double>*, 3> lists = {&counted.depth, &counted.speed, &counted.pressure};
    const auto add = [&](FinishedMap::Kind kind, EnsembleMap::Kind of_kind, std::size_t map, double level) {
        const report::HazardMap& single = report::hazard_maps().at(map);
        add_map(made, folder, {kind, single.file, level, single.unit, style_of({of_kind, map, level, {}}), {}});
    };
    for (std::size_t map = 0; map < lists.size(); ++map) {
        for (const double level : *lists[map]) {
            add(FinishedMap::Kind::probability, EnsembleMap::Kind::probability, map, level);
        }
    }
    for (std::size_t map = 0; map < recorded_maps.size(); ++map) {
        for (const double level : mapped_percentiles) {
            add(FinishedMap::Kind::percentile, EnsembleMap::Kind::percentile, map, level);
        }
    }
    add_intensity_maps(made, folder, statistics.value("intensity_guideline", ""));
    if (made.maps.empty()) {
        return Error{fmt::format("{}: has no maps; debris reached no cell, or they were removed", folder.string())};
    }
    return made;
}

}  // namespace talus::ensemble
