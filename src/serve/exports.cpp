#include "serve/exports.hpp"

#include <algorithm>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "core/hazard_maps.hpp"
#include "core/try.hpp"
#include "geo/longitude_latitude.hpp"
#include "geo/vector.hpp"
#include "messages/messages.hpp"
#include "products/page_files.hpp"
#include "products/text_file.hpp"
#include "scene/bundle.hpp"
#include "serve/api.hpp"
#include "serve/library.hpp"
#include "session/json_text.hpp"
#include "twin/live_run.hpp"
#include "twin/results.hpp"
#include "twin/scene_copy.hpp"

namespace talus::serve {
namespace {

namespace fs = std::filesystem;

/// What a run must have for a file to be written.
enum class Needs { nothing, erosion, gauges, globe, source };

struct ExportFile {
    std::string name;
    const char* type = nullptr;
    std::string what;
    Needs needs = Needs::nothing;
};

constexpr const char *geotiff = "image/tiff", *qgis_style = "application/xml", *style_of_it = "QGIS style of it";

constexpr const char* scene_zip = "scene.zip";

constexpr const char* twin_what =
    "Twin in one file: all runs of this session in a page that opens in any browser, without program or network";

std::vector<ExportFile> make_export_files() {
    std::vector<ExportFile> files = {
        {"report.html", "text/html", "Report with maps, plots and tables, for the browser and for paper"},
        {"results.json", "application/json", "What the report shows, as data: key figures, tables, curves"},
        {products::front_csv.name, "text/csv", products::front_csv.what},
        {products::run_out_csv.name, "text/csv", products::run_out_csv.what},
        {products::buildings_csv.name, "text/csv", products::buildings_csv.what},
        {products::structures_csv.name, "text/csv", products::structures_csv.what},
        {products::timeseries_csv.name, "text/csv", products::timeseries_csv.what},
        {"results.gpkg", "application/geopackage+sqlite3",
         "Release areas, buildings, intensity, flow path and front for a GIS"},
        {products::gauges_csv.name, "text/csv", products::gauges_csv.what, Needs::gauges},
        {"results.qlr", "application/xml", "Opens all layers in QGIS, styled"},
        {"results.kml", "application/vnd.google-earth.kml+xml",
         "Inundation, arrival times and structures hit, for Google Earth and phones", Needs::globe},
        {"stac_item.json", "application/geo+json", "Place, time, software and files, for catalogues of geodata"},
        {scene_zip, "application/zip", "The scene and its files with the changes of this scenario, for talus run",
         Needs::source},
        {"manifest.json", "application/json", "All parameters, versions, checksums and the result's hash"},
    };
    for (const NamedMap& map : named_maps) {
        const std::string key(map.key);
        const char* title = map.title_so_far != nullptr ? map.title_so_far : map.title;
        files.push_back({key + ".tif", geotiff, fmt::format("{}, {}", title, map.unit)});
        files.push_back({key + ".qml", qgis_style, style_of_it});
    }
    files.insert(files.end(),
                 {
                     {"intensity.tif", geotiff, "Classes of intensity after a guideline"},
                     {"intensity.qml", qgis_style, style_of_it},
                     {"terrain.tif", geotiff, "Elevation of the terrain, m"},
                     {"terrain.qml", qgis_style, "QGIS style of it: hillshade"},
                     {"peak_thickness.tif", geotiff, "Peak flow thickness normal to the slope, m", Needs::erosion},
                     {"peak_thickness.qml", qgis_style, style_of_it, Needs::erosion},
                     {"erosion_depth.tif", geotiff, "Depth of erosion of the bed, m", Needs::erosion},
                     {"erosion_depth.qml", qgis_style, style_of_it, Needs::erosion},
                     {products::erosion_csv.name, "text/csv", products::erosion_csv.what, Needs::erosion},
                 });
    return files;
}

/// The files of a run; requested names are checked against these, so none leads out of the folder.
const std::vector<ExportFile>& export_files() {
    static const std::vector<ExportFile> files = make_export_files();
    return files;
}

const ExportFile* find_file(const std::string& name) {
    const std::vector<ExportFile>& files = export_files();
    const auto found = std::find_if(files.begin(), files.end(), [&](const ExportFile& f) { return name == f.name; });
    return found == files.end() ? nullptr : &*found;
}

/// Why a run has no such file; empty: it has one.
std::string why_none(const ExportFile& file, const twin::Scenario& run, const run::SceneSource& source) {
    switch (file.needs) {
        case Needs::nothing:
            return "";
        case Needs::erosion:
            return run.run().summary().entrained > 0 ? "" : "nothing was entrained";
        case Needs::gauges:
            return run.scene().gauges.empty() ? "the scene has no gauges" : "";
        case Needs::source:
            return source.file.empty() ? "this program does not serve the scene's file" : "";
        case Needs::globe:
            return geo::to_wgs84(run.scene().crs) ? ""
                                                  : "the terrain's reference system is local, without a place on Earth";
    }
    return "";
}

std::vector<const ExportFile*> files_of(const twin::Scenario& run, const run::SceneSource& source) {
    std::vector<const ExportFile*> files;
    for (const ExportFile& file : export_files()) {
        if (why_none(file, run, source).empty()) files.push_back(&file);
    }
    return files;
}

Response answer_with(Bytes bytes, const ExportFile& file) {
    Response response;
    response.type = file.type;
    response.body = std::move(bytes);
    response.file_name = file.name;
    return response;
}

Response read_file(const fs::path& path, const ExportFile& file, SentFiles& files) {
    auto bytes = files.read(path);
    return bytes ? answer_with(std::move(*bytes), file) : error_response(500, bytes.error().message);
}

/// As `folder`/scene.toml, with the files that it names beside it.
Status write_copy(const twin::SceneCopy& copy, const geo::Crs& crs, const fs::path& folder) {
    TALUS_TRY(products::write_text_file(folder / "scene.toml", copy.text));
    for (const twin::DrawnTable& table : copy.tables) {
        TALUS_TRY(products::write_text_file(folder / table.name, table.text));
    }
    const std::string drawn = (folder / twin::SceneCopy::drawn_file).string();
    for (const twin::DrawnLayer& layer : copy.layers) {
        TALUS_TRY(geo::write_geopackage_layer(drawn, layer.name, layer.fields, layer.features, crs));
    }
    return {};
}

}  // namespace

/// A run at the time of a request for files, and their folder. Once created, used by the writer only.
struct Exports::Snapshot {
    twin::Version version;
    fs::path folder;
    std::function<Status(const fs::path&)> products;  // none: they are written

    Snapshot() = default;
    Snapshot(const Snapshot&) = delete;
    Snapshot& operator=(const Snapshot&) = delete;
    ~Snapshot() {
        std::error_code error;
        fs::remove_all(folder, error);
    }
    /// Writes the files that are not written yet.
    [[nodiscard]] Status write() {
        if (!products) return {};
        std::error_code error;
        fs::remove_all(folder, error);  // of a former try
        fs::create_directories(folder, error);
        if (error) return Error{fmt::format("{}: {}", folder.string(), error.message())};
        TALUS_TRY(products(folder));
        products = nullptr;
        return {};
    }
};

Exports::Exports(Session& session, fs::path folder, run::SceneSource source)
    : session_(session),
      folder_(std::move(folder)),
      source_(std::move(source)),
      writer_(session.executor(), "exports") {}
Exports::~Exports() = default;

void Exports::close() {
    writer_.close();
}

bool Exports::is_current(int index, const twin::Scenario& scenario) const {
    const SnapshotPtr& taken = taken_[static_cast<std::size_t>(index)];
    return taken && taken->version == twin::version_of(scenario);
}

void Exports::list(const std::string& scenario, const Respond& respond) {
    session_.loop().post([this, scenario, respond](Scenarios& all) {
        const auto index = all.find(scenario);
        if (!index) {
            respond(no_scenario(scenario));
            return;
        }
        const bool current = is_current(*index, all.at(*index));
        writer_.post([taken = current ? taken_[static_cast<std::size_t>(*index)] : nullptr,
                      present = files_of(all.at(*index), source_), twin = twin_ != nullptr, respond] {
            messages::ExportFiles told{.files = {}};
            if (twin) told.files.push_back({.name = twin_html, .bytes = {}, .what = twin_what});
            const bool written = taken && !taken->products;
            for (const ExportFile* file : present) {
                std::error_code error;
                const bool known = written && file->needs != Needs::source;  // that is written when it is asked for
                const auto bytes = known ? fs::file_size(taken->folder / file->name, error) : 0;
                if (error) continue;  // this run has none
                told.files.push_back({.name = file->name, .bytes = {}, .what = file->what});
                if (known) told.files.back().bytes = bytes;
            }
            respond(json_response(200, told));
        });
    });
}

void Exports::file(const std::string& scenario, const std::string& name, const Respond& respond) {
    if (name == twin_html && twin_) return twin_(respond);
    const ExportFile* wanted = find_file(name);
    if (wanted == nullptr) {
        respond(error_response(404, fmt::format("there is no export {}", tidy_name(name, 40))));
        return;
    }
    session_.loop().post([this, scenario, wanted, respond](Scenarios& all) {
        const auto index = all.find(scenario);
        if (!index) {
            respond(no_scenario(scenario));
            return;
        }
        SnapshotPtr& taken = taken_[static_cast<std::size_t>(*index)];
        const twin::Scenario& run = all.at(*index);
        if (const std::string why = why_none(*wanted, run, source_); !why.empty()) {
            respond(error_response(404, fmt::format("there is no {}: {}", wanted->name, why)));
            return;
        }
        if (wanted->needs == Needs::source) return scene_archive(run, respond);
        if (!is_current(*index, run)) {
            auto fresh = std::make_shared<Snapshot>();
            fresh->version = twin::version_of(run);
            // A new name each time: the previous one may still be in use.
            fresh->folder = folder_ / fmt::format("{}{}", Scenarios::name_of(*index), ++count_);
            fresh->products = twin::products_of(run);
            std::swap(taken, fresh);
            writer_.post([former = std::move(fresh)] {});  // this removes its files
        }
        writer_.post([this, taken, wanted, respond] {
            const Status written = taken->write();
            respond(written ? read_file(taken->folder / wanted->name, *wanted, sent_)
                            : error_response(500, without_folder(written.error().message, taken->folder)));
        });
    });
}

void Exports::scene_archive(const twin::Scenario& scenario, const Respond& respond) {
    const fs::path folder = folder_ / fmt::format("scene{}", ++count_);
    writer_.post([this, folder, source = source_, copy = twin::scene_copy_of(scenario), respond] {
        const ExportFile& wanted = *find_file(scene_zip);
        const auto made = [&]() -> Result<Response> {
            // It is written into another folder: its files need whole paths.
            const auto copied = copy(fs::absolute(source.file), source.overrides);
            if (!copied) return error_response(409, copied.error().message);
            const twin::SceneCopy& scene = *copied;
            // What is in a layer or a table does not show in the text.
            const bool text_is_all = scene.layers.empty() && scene.tables.empty();
            if (Bytes sent = archive_sent_.lock(); sent && text_is_all && scene.text == archived_)
                return answer_with(std::move(sent), wanted);
            std::error_code error;
            fs::create_directories(folder, error);
            if (error) return Error{fmt::format("{}: {}", folder.string(), error.message())};
            TALUS_TRY(write_copy(scene, session_.scene()->crs, folder));
            TALUS_TRY(scene::write_bundle(folder / "scene.toml", folder / scene_zip));
            Response response = read_file(folder / scene_zip, wanted, sent_);
            if (response.status == 200) {
                archive_sent_ = response.body;
                archived_ = text_is_all ? scene.text : "";
            }
            return response;
        }();
        respond(made ? *made : error_response(500, without_folder(made.error().message, folder)));
        std::error_code ignored;
        fs::remove_all(folder, ignored);
    });
}

}  // namespace talus::serve
