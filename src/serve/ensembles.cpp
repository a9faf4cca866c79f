#include "serve/ensembles.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/raster.hpp"
#include "twin/frame.hpp"

namespace talus::serve {
namespace {

namespace fs = std::filesystem;

/// Checks that a map of an ensemble fits this terrain.
Status check_extent(const fs::path& file, const Extent& map, const Extent& terrain, double cell) {
    const Extent most = terrain.grown(cell);
    if (map.x_min >= most.x_min && map.y_min >= most.y_min && map.x_max <= most.x_max && map.y_max <= most.y_max) {
        return {};
    }
    const auto words = [](const Extent& e) {
        return fmt::format("{:.0f} to {:.0f} east, {:.0f} to {:.0f} north", e.x_min, e.x_max, e.y_min, e.y_max);
    };
    return Error{fmt::format("{}: lies at {}, beyond the terrain of this scene, {}; the ensemble is of another scene",
                             file.string(), words(map), words(terrain))};
}

std::optional<double> number_if(bool there, double value) {
    return there ? std::optional(value) : std::nullopt;
}

}  // namespace

Result<Ensembles::Ensemble> Ensembles::read_one(const fs::path& folder, const scene::Scene& scene) {
    Ensemble made;
    TALUS_ASSIGN(made.about, ensemble::read_finished_ensemble(folder));
    for (const scene::InputFile& input : scene.inputs) {
        if (input.role == "terrain" && !made.about.terrain_hash.empty()) {
            made.same_terrain = input.hash == made.about.terrain_hash;
        }
    }
    const Extent terrain = scene.terrain.elevation().geometry.extent();
    for (ensemble::FinishedMap& map : made.about.maps) {
        TALUS_ASSIGN(const auto raster, read_map_raster(map.file.string(), scene.crs));
        const GridGeometry& grid = raster.grid.geometry;
        TALUS_TRY(check_extent(map.file, grid.extent(), terrain, std::max(grid.cell, scene.terrain.cell())));
        made.maps.push_back({std::move(map), std::make_shared<const std::string>(twin::encode_grid(raster.grid)),
                             report::greatest(raster.grid)});
    }
    made.about.maps.clear();
    return Result<Ensemble>(std::move(made));
}

Result<Ensembles> Ensembles::read(const std::vector<fs::path>& folders, const scene::Scene& scene) {
    Ensembles all;
    for (const fs::path& folder : folders) {
        TALUS_ASSIGN(auto ensemble, read_one(folder, scene));
        all.ensembles_.push_back(std::move(ensemble));
    }
    return Result<Ensembles>(std::move(all));
}

messages::Ensembles Ensembles::describe() const {
    std::vector<messages::Ensemble> list;
    list.reserve(ensembles_.size());
    for (const Ensemble& ensemble : ensembles_) {
        std::vector<messages::EnsembleFactor> factors;
        factors.reserve(ensemble.about.factors.size());
        for (const ensemble::Factor& f : ensemble.about.factors) {
            factors.push_back({.key = f.key, .distribution = f.distribution.text()});
        }
        std::vector<messages::EnsembleMap> maps;
        maps.reserve(ensemble.maps.size());
        for (const Map& map : ensemble.maps) {
            const ensemble::FinishedMap& about = map.about;
            using Kind = ensemble::FinishedMap::Kind;
            const bool threshold = about.kind == Kind::probability && !std::isnan(about.level);
            std::vector<messages::Category> categories;
            categories.reserve(about.style.categories.size());
            for (const report::Category& c : about.style.categories) {
                categories.push_back({.name = c.name, .colour = c.colour.hex()});
            }
            maps.push_back({.name = about.style.file,
                            .title = about.style.title,
                            .unit = about.style.unit,
                            .kind = about.kind == Kind::zones         ? "zones"
                                    : about.kind == Kind::probability ? "probability"
                                                                      : "percentile",
                            .of = about.of,
                            .description = about.style.description,
                            .threshold = number_if(threshold, about.level),
                            .threshold_unit = threshold ? std::optional(about.level_unit) : std::nullopt,
                            .percentile = number_if(about.kind == Kind::percentile, about.level),
                            .categories = std::move(categories),
                            .greatest = number_if(map.greatest > 0, map.greatest)});
        }
        list.push_back({.id = std::to_string(list.size() + 1),
                        .name = ensemble.about.name,
                        .runs = ensemble.about.complete,
                        .failed = ensemble.about.failed,
                        .factors = std::move(factors),
                        .same_terrain = ensemble.same_terrain,
                        .maps = std::move(maps)});
    }
    return {.ensembles = std::move(list)};
}

Bytes Ensembles::map(const std::string& ensemble, const std::string& name) const {
    for (std::size_t i = 0; i < ensembles_.size(); ++i) {
        if (std::to_string(i + 1) != ensemble) continue;
        for (const Map& map : ensembles_[i].maps) {
            if (map.about.style.file == name) return map.grid;
        }
    }
    return nullptr;
}

}  // namespace talus::serve
