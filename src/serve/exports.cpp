#include "serve/exports.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <system_error>

#include <fmt/format.h>

#include "serve/json_text.hpp"

namespace talus::serve {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct ExportFile {
    const char *name, *type, *what;
};

// The files of a run; names that are asked for are held against these, so none leads out of the folder.
constexpr ExportFile export_files[] = {
    {"report.html", "text/html", "Report with maps, plots and tables, for the browser and for paper"},
    {"front.csv", "text/csv", "Front: chainage, first arrival, velocity"},
    {"run_out.csv", "text/csv", "Run-out, drop, runout angle and travel angle"},
    {"buildings.csv", "text/csv", "Impact per building"},
    {"timeseries.csv", "text/csv", "Front, volumes, energy and compression over time"},
    {"results.gpkg", "application/geopackage+sqlite3", "Release areas, buildings, flow path and front for a GIS"},
    {"manifest.json", "application/json", "All parameters, versions, checksums and the result's hash"},
    {"peak_depth.tif", "image/tiff", "Peak flow depth, m"},
    {"peak_depth.qml", "application/xml", "QGIS style of it"},
    {"peak_speed.tif", "image/tiff", "Peak speed, m/s"},
    {"peak_speed.qml", "application/xml", "QGIS style of it"},
    {"peak_pressure.tif", "image/tiff", "Peak dynamic pressure, kPa"},
    {"peak_pressure.qml", "application/xml", "QGIS style of it"},
    {"arrival_time.tif", "image/tiff", "First arrival, s"},
    {"arrival_time.qml", "application/xml", "QGIS style of it"},
    {"deposit_depth.tif", "image/tiff", "Depth of the debris now, m"},
    {"deposit_depth.qml", "application/xml", "QGIS style of it"},
};

const ExportFile* find_file(const std::string& name) {
    const auto found = std::find_if(std::begin(export_files), std::end(export_files),
                                    [&](const ExportFile& f) { return name == f.name; });
    return found == std::end(export_files) ? nullptr : found;
}

Response read_file(const fs::path& path, const ExportFile& file) {
    std::ifstream in(path, std::ios::binary);
    auto bytes = std::make_shared<std::string>(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    if (!in) return error_response(500, fmt::format("{} cannot be read back", file.name));
    Response response;
    response.type = file.type;
    response.body = std::move(bytes);
    response.file_name = file.name;
    return response;
}

}  // namespace

bool Exports::is_current(int index, const twin::Scenario& scenario) const {
    const Written& written = written_[static_cast<std::size_t>(index)];
    return written.valid && written.step == scenario.step() && written.hash == scenario.hash();
}

Status Exports::write(int index, const twin::Scenario& scenario) {
    Written& written = written_[static_cast<std::size_t>(index)];
    std::error_code error;
    if (!written.folder.empty()) fs::remove_all(written.folder, error);
    written = Written();
    // A new name each time: somebody may still read from the former one.
    written.folder = folder_ / fmt::format("{}{}", Scenarios::name_of(index), ++count_);
    fs::create_directories(written.folder, error);
    if (error) return Error{fmt::format("{}: {}", written.folder.string(), error.message())};
    if (Status status = scenario.write_products(written.folder); !status) return status;
    written.step = scenario.step();
    written.hash = scenario.hash();
    written.valid = true;
    return {};
}

void Exports::list(const std::string& scenario, const Respond& respond) {
    session_.loop().post([this, scenario, respond](Scenarios& all) {
        const auto index = all.find(scenario);
        if (!index) {
            respond(error_response(404, fmt::format("there is no scenario {}", tidy_name(scenario, 20))));
            return;
        }
        json files = json::array();
        const bool current = is_current(*index, all.at(*index));
        for (const ExportFile& file : export_files) {
            std::error_code error;
            const auto bytes = fs::file_size(written_[static_cast<std::size_t>(*index)].folder / file.name, error);
            if (current && error) continue;  // this run has none
            files.push_back({{"name", file.name}, {"bytes", current ? json(bytes) : json()}, {"what", file.what}});
        }
        respond(json_response(200, {{"files", files}}));
    });
}

void Exports::file(const std::string& scenario, const std::string& name, const Respond& respond) {
    const ExportFile* wanted = find_file(name);
    if (wanted == nullptr) {
        respond(error_response(404, fmt::format("there is no export {}", tidy_name(name, 40))));
        return;
    }
    session_.loop().post([this, scenario, wanted, respond](Scenarios& all) {
        const auto index = all.find(scenario);
        if (!index) {
            respond(error_response(404, fmt::format("there is no scenario {}", tidy_name(scenario, 20))));
            return;
        }
        if (!is_current(*index, all.at(*index))) {
            if (const Status written = write(*index, all.at(*index)); !written) {
                respond(error_response(500, written.error().message));
                return;
            }
        }
        respond(read_file(written_[static_cast<std::size_t>(*index)].folder / wanted->name, *wanted));
    });
}

}  // namespace talus::serve
