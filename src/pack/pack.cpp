#include "pack/pack.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <variant>

#include <fmt/format.h>

#include "core/hash.hpp"
#include "core/try.hpp"
#include "pack/check.hpp"
#include "pack/inflate.hpp"
#include "pack/members.hpp"
#include "pack/write.hpp"
#include "params/fields.hpp"
#include "scene/particle_spacing.hpp"

namespace talus::pack {
namespace {

constexpr std::string_view mark = "TALUSPAK";
constexpr std::size_t header_size = mark.size() + sizeof version + sizeof(std::uint64_t);
constexpr std::size_t hash_size = sizeof(std::uint64_t);

struct PathContent {
    std::vector<PlanPoint> points;
    double corridor_width = 0;
};
TALUS_PACKED(PathContent, points, corridor_width)

struct FrameContent {
    double time = 0;
    std::vector<std::uint8_t> message;
};
TALUS_PACKED(FrameContent, time, message)

struct PictureContent {
    std::string type;
    std::vector<std::uint8_t> bytes;
};
TALUS_PACKED(PictureContent, type, bytes)

/// A scene without what follows from the rest, which is made again.
struct Content {
    std::filesystem::path file;
    params::SceneSpec spec;
    std::set<std::string> given_keys;
    geo::Crs crs;
    std::string vertical_unit;
    double nodata_share = 0;
    Grid<float> elevation;
    std::vector<scene::Zone> zones;
    std::vector<terrain::Release> releases;
    std::vector<scene::BedLayer> bed_layers;
    std::vector<terrain::Inflow> inflows;
    std::optional<scene::ThinnestSource> thinnest;
    std::vector<terrain::Building> buildings;
    std::vector<std::size_t> barrier_sections;
    PathContent flow_path;
    scene::PathOrigin flow_path_origin = scene::PathOrigin::file;
    std::vector<terrain::Gauge> gauges;
    std::vector<terrain::CrossSection> cross_sections;
    std::optional<Polygon> zoom;
    std::vector<std::vector<Polygon>> deposit_outlines, affected_areas;
    std::vector<Grid<float>> elevation_changes;
    std::vector<scene::InputFile> inputs;
    std::vector<std::string> notes;
    std::vector<std::string> overrides;
    std::optional<double> latitude;
    std::optional<PictureContent> orthophoto;
    std::vector<FrameContent> recording;
};
TALUS_PACKED(Content, file, spec, given_keys, crs, vertical_unit, nodata_share, elevation, zones, releases, bed_layers,
             inflows, thinnest, buildings, barrier_sections, flow_path, flow_path_origin, gauges, cross_sections, zoom,
             deposit_outlines, affected_areas, elevation_changes, inputs, notes, overrides, latitude, orthophoto,
             recording)

std::vector<std::uint8_t> to_bytes(const std::string& text) {
    return {text.begin(), text.end()};
}

/// Without its folders, unless it is of the program itself.
std::string name_of_file(const std::string& path) {
    return path.starts_with("built-in:") ? path : std::filesystem::path(path).filename().string();
}

void forget_folders(params::SceneSpec& spec) {
    for (const params::Section& section : params::scene_sections()) {
        for (std::size_t index = 0; index < section.count(spec); ++index) {
            for (const params::Parameter& parameter : section.parameters) {
                const params::ParameterValue value = parameter.get(spec, index);
                const auto* path = std::get_if<std::string>(&value);
                if (parameter.kind != params::ParameterKind::path || path == nullptr || path->empty()) continue;
                parameter.set(spec, index, name_of_file(*path));
            }
        }
    }
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
        text.replace(at, from.size(), to);
    }
}

void forget_folders(Content& content) {
    forget_folders(content.spec);
    const auto forget = [](std::string& path) {
        if (!path.empty()) path = name_of_file(path);
    };
    for (terrain::Release& release : content.releases) {
        forget(release.spec.file);
        forget(release.spec.thickness_raster);
        forget(release.spec.pore_pressure_hydrograph);
    }
    for (terrain::Inflow& inflow : content.inflows) {
        for (std::string* path : {&inflow.spec.file, &inflow.spec.polygon_file, &inflow.spec.hydrograph}) forget(*path);
    }
    for (scene::Zone& zone : content.zones) {
        forget(zone.spec.file);
        forget(zone.spec.raster);
    }
    for (scene::BedLayer& layer : content.bed_layers) {
        forget(layer.spec.file);
        forget(layer.spec.depth_raster);
    }
    for (terrain::Building& building : content.buildings) {
        if (building.barrier) forget(building.barrier->file);
    }
    for (scene::InputFile& input : content.inputs) {
        const std::string name = name_of_file(input.path);
        for (std::string& note : content.notes) replace_all(note, input.path, name);
        input.path = name;
    }
}

Content content_of(const Packed& packed) {
    const scene::Scene& s = packed.scene;
    Content content{.file = name_of_file(s.file.generic_string()),
                    .spec = s.spec,
                    .given_keys = s.given_keys,
                    .crs = s.crs,
                    .vertical_unit = s.vertical_unit,
                    .nodata_share = s.nodata_share,
                    .elevation = s.terrain.elevation(),
                    .zones = s.zones,
                    .releases = s.releases,
                    .bed_layers = s.bed_layers,
                    .inflows = s.inflows,
                    .thinnest = s.thinnest,
                    .buildings = s.buildings,
                    .barrier_sections = s.barrier_sections,
                    .flow_path = {s.flow_path.points(), s.flow_path.corridor_width()},
                    .flow_path_origin = s.flow_path_origin,
                    .gauges = s.gauges,
                    .cross_sections = s.cross_sections,
                    .zoom = s.zoom,
                    .deposit_outlines = s.deposit_outlines,
                    .affected_areas = s.affected_areas,
                    .elevation_changes = s.elevation_changes,
                    .inputs = s.inputs,
                    .notes = s.notes,
                    .overrides = packed.overrides,
                    .latitude = packed.latitude,
                    .orthophoto = {},
                    .recording = {}};
    forget_folders(content);
    if (packed.orthophoto) content.orthophoto = {packed.orthophoto->type, to_bytes(packed.orthophoto->bytes)};
    for (const RecordedFrame& frame : packed.recording) {
        content.recording.push_back({frame.time, to_bytes(frame.message)});
    }
    return content;
}

Status check_further(const Content& content) {
    if (content.latitude && !(std::abs(*content.latitude) <= 90)) return Error{"it lies nowhere on the globe"};
    if (content.orthophoto) {
        const std::string& type = content.orthophoto->type;
        if (type != "image/jpeg" && type != "image/png" && type != "image/webp")
            return Error{"its picture is of no known kind"};
    }
    const PathContent& path = content.flow_path;
    if (!(path.corridor_width > 0 && path.corridor_width < 1e6)) return Error{"its flow path has no corridor"};
    const Extent extent = content.elevation.geometry.extent();
    const Extent near = extent.grown(std::max(extent.width(), extent.height()));
    const auto inside = [&](const PlanPoint& p) { return near.contains(p); };
    if (path.points.size() == 1 || !std::all_of(path.points.begin(), path.points.end(), inside)) {
        return Error{"its flow path leaves the terrain"};
    }
    double before = -1;
    for (const FrameContent& frame : content.recording) {
        if (!(frame.time >= before && frame.time < 1e9)) return Error{"its recording goes back in time"};
        before = frame.time;
    }
    return {};
}

Result<Packed> to_packed(Content&& content) {
    TALUS_TRY(check_terrain(content.elevation));
    const std::size_t cells = content.elevation.geometry.size();
    if (cells > most_cells) {
        return Error{fmt::format("its terrain has {} cells; a page has memory for {}", cells, most_cells)};
    }
    TALUS_TRY(check_further(content));
    Packed packed{.scene = {},
                  .overrides = std::move(content.overrides),
                  .latitude = content.latitude,
                  .orthophoto = {},
                  .recording = {}};
    scene::Scene& s = packed.scene;
    s.file = std::move(content.file);
    s.spec = std::move(content.spec);
    s.given_keys = std::move(content.given_keys);
    s.crs = std::move(content.crs);
    s.vertical_unit = std::move(content.vertical_unit);
    s.nodata_share = content.nodata_share;
    s.terrain = terrain::Terrain(std::move(content.elevation));
    s.zones = std::move(content.zones);
    s.releases = std::move(content.releases);
    s.bed_layers = std::move(content.bed_layers);
    s.inflows = std::move(content.inflows);
    s.thinnest = std::move(content.thinnest);
    s.buildings = std::move(content.buildings);
    s.barrier_sections = std::move(content.barrier_sections);
    s.flow_path_origin = content.flow_path_origin;
    s.gauges = std::move(content.gauges);
    s.cross_sections = std::move(content.cross_sections);
    s.zoom = std::move(content.zoom);
    s.deposit_outlines = std::move(content.deposit_outlines);
    s.affected_areas = std::move(content.affected_areas);
    s.elevation_changes = std::move(content.elevation_changes);
    s.inputs = std::move(content.inputs);
    s.notes = std::move(content.notes);
    TALUS_TRY(check_parts(s));
    if (!content.flow_path.points.empty()) {
        s.flow_path = terrain::FlowPath(content.flow_path.points, content.flow_path.corridor_width);
    }
    TALUS_TRY(check_scene(s));
    if (scene::ZonesOnTerrain on_terrain = zones_on_terrain(s.zones, s.terrain); true) {
        s.cover = std::move(on_terrain.cover);
        s.zone_at = std::move(on_terrain.zone_at);
    }
    s.bed = lay_bed(s.bed_layers, s.terrain);
    if (content.orthophoto) {
        const auto& bytes = content.orthophoto->bytes;
        packed.orthophoto = {std::move(content.orthophoto->type), std::string(bytes.begin(), bytes.end())};
    }
    for (const FrameContent& frame : content.recording) {
        packed.recording.push_back({frame.time, std::string(frame.message.begin(), frame.message.end())});
    }
    TALUS_TRY(check_size(packed));
    return packed;
}

template <class T>
T number_at(std::span<const std::byte> bytes, std::size_t at) {
    T value{};
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

Error refused(std::string_view name, const std::string& why) {
    return Error{fmt::format("{} {}", name, why)};
}

}  // namespace

Status check_size(const Packed& packed) {
    const std::size_t cells = packed.scene.terrain.elevation().geometry.size();
    if (cells > most_cells) {
        return Error{
            fmt::format("the terrain has {} cells, and a page has memory for {}; terrain.extent takes a part of "
                        "it",
                        cells, most_cells)};
    }
    if (const double maps = map_cells(packed.scene); !(maps <= static_cast<double>(most_cells))) {
        return Error{
            fmt::format("the maps would have {:.3g} cells, and a page has memory for {}; a larger "
                        "outputs.map_cell_m makes fewer",
                        maps, most_cells)};
    }
    const double spacing = particle_spacing(packed.scene);
    const double particles = total_volume(packed.scene) / (spacing * spacing * spacing);
    if (packed.scene.spec.solver.model == params::ModelChoice::particles &&
        !(particles <= static_cast<double>(most_particles))) {
        return Error{
            fmt::format("the run would have {:.3g} particles, and a page has memory for {}; set "
                        "solver.target_particle_count",
                        particles, most_particles)};
    }
    std::size_t bytes = packed.orthophoto ? packed.orthophoto->bytes.size() : 0;
    for (const RecordedFrame& frame : packed.recording) bytes += frame.message.size();
    if (bytes > most_bytes / 2) {
        return Error{fmt::format("orthophoto and recording have {} MB, and may have {} MB", bytes / 1'000'000,
                                 most_bytes / 2'000'000)};
    }
    return {};
}

Result<Packed> read_content(std::string_view text, std::string_view name) {
    Reader reader(text);
    Content content;
    reader.get(content);
    if (!reader.complete()) return refused(name, "is damaged: it does not hold a scene");
    Result<Packed> packed = to_packed(std::move(content));
    if (!packed) return refused(name, "is refused: " + packed.error().message);
    return packed;
}

Result<Packed> read(std::span<const std::byte> bytes, std::string_view name) {
    const auto begins = [&](std::size_t size) {
        return std::equal(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size), mark.begin(),
                          [](std::byte a, char b) { return std::to_integer<char>(a) == b; });
    };
    if (!begins(std::min(bytes.size(), mark.size()))) return refused(name, "is not a packed scene");
    if (bytes.size() < header_size + hash_size) return refused(name, "is cut short: it is not a whole packed scene");
    const auto found = number_at<std::uint32_t>(bytes, mark.size());
    if (found != version) {
        return refused(name,
                       fmt::format("is of version {} of packed scenes, and this program reads version {}: publish "
                                   "the scene again",
                                   found, version));
    }
    StateHash hash;
    hash.add(bytes.data(), bytes.size() - hash_size);
    if (hash.value() != number_at<std::uint64_t>(bytes, bytes.size() - hash_size)) {
        return refused(name, "is cut short or damaged: its hash is not that of its content");
    }
    const auto size = number_at<std::uint64_t>(bytes, mark.size() + sizeof version);
    if (size > most_bytes) {
        return refused(name, fmt::format("claims {} MB, and may have {} MB", size / 1'000'000, most_bytes / 1'000'000));
    }
    const auto content =
        inflate(bytes.subspan(header_size, bytes.size() - header_size - hash_size), static_cast<std::size_t>(size));
    if (!content) return refused(name, content.error().message);
    return read_content(*content, name);
}

std::string write_content(const Packed& packed) {
    Writer writer;
    writer.put(content_of(packed));
    return writer.take();
}

std::string enclose(const std::string& content, const std::string& deflated) {
    std::string bytes(mark);
    const auto add = [&](const auto& value) {
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);  // as number_at() reads it
    };
    add(version);
    add(static_cast<std::uint64_t>(content.size()));
    bytes += deflated;
    StateHash hash;
    hash.add(bytes.data(), bytes.size());
    add(hash.value());
    return bytes;
}

}  // namespace talus::pack
