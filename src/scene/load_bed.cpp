#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/vector.hpp"
#include "scene/attributes.hpp"
#include "scene/known_ground.hpp"
#include "scene/load.hpp"

namespace talus::scene {
namespace {

Status load_one(const ParsedScene& parsed, std::size_t index, Scene& scene) {
    params::BedSpec& spec = scene.spec.beds[index];
    if (spec.name.empty()) spec.name = fmt::format("bed {}", index + 1);
    const std::string label = fmt::format("bed \"{}\"", spec.name);
    const auto refused = [&](const char* key, const Error& error) {
        return Error{parsed.at(fmt::format("bed[{}].{}", index, key)) + ": " + error.message};
    };
    const double deepest = params::parameter_of("bed", "depth_m").range.high;
    BedLayer bed;
    if (!spec.depth_raster.empty()) {
        Result<geo::Raster> read = read_value_raster(spec.depth_raster, scene.crs);
        if (!read) return refused("depth_raster", read.error());
        record_input(label + " depth", spec.depth_raster, scene);
        bed.depth_raster = std::make_shared<const Grid<float>>(std::move(read->grid));
    }
    if (!spec.file.empty()) {
        const Result<geo::PolygonLayer> layer = load_polygons(label, spec.file, spec.layer, scene);
        if (!layer) return refused("file", layer.error());
        for (std::size_t feature = 0; feature < layer->features.size(); ++feature) {
            double depth = spec.depth.value_or(0);
            if (!spec.depth_attribute.empty()) {
                const Result<double> read =
                    read_length(spec.file, *layer, feature, {spec.depth_attribute, "depth", deepest});
                if (!read) return refused("depth_attribute", read.error());
                depth = *read;
            }
            for (const Polygon& part : layer->features[feature].parts) bed.parts.push_back({part, depth});
        }
    }
    bed.spec = spec;
    const BedAmount amount = amount_of(bed, scene.terrain);
    if (amount.deepest > deepest) {
        return refused("depth_raster", Error{fmt::format("{}: holds a depth of {:.6g}; it must be at most {:.0f} (m)",
                                                         spec.depth_raster, amount.deepest, deepest)});
    }
    if (!(amount.volume > 0)) {
        return refused(bed.depth_raster != nullptr ? "depth_raster" : "file",
                       Error{label + " " + covers_no_cell(scene.terrain)});
    }
    scene.notes.push_back(
        fmt::format("{}: {:.6g} m3 on the ground, in cells of {:.4g} m", label, amount.volume, scene.terrain.cell()));
    scene.bed_layers.push_back(std::move(bed));
    return {};
}

}  // namespace

Status load_bed(const ParsedScene& parsed, Scene& scene) {
    if (scene.spec.beds.empty()) return {};
    if (scene.spec.beds.size() > terrain::Bed::max_materials) {
        return Error{fmt::format("{}: {} beds are too many; there can be {}", parsed.at("bed[0].name"),
                                 scene.spec.beds.size(), terrain::Bed::max_materials)};
    }
    for (std::size_t i = 0; i < scene.spec.beds.size(); ++i) {
        TALUS_TRY(load_one(parsed, i, scene));
    }
    scene.bed = lay_bed(scene.bed_layers, scene.terrain);
    return {};
}

}  // namespace talus::scene
