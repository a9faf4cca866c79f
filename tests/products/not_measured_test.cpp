// What a model does not measure is empty, never 0: docs/results.md has the table of all such fields.
#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "products/products.hpp"
#include "products/writers.hpp"
#include "run/run_scene.hpp"
#include "scene/scene_folder.hpp"
#include "support/fixtures.hpp"

namespace talus::products {
namespace {

using nlohmann::json;

std::vector<std::string> cut(const std::string& line, char at) {
    std::vector<std::string> parts;
    std::istringstream in(line);
    for (std::string part; std::getline(in, part, at);) parts.push_back(part);
    if (!line.empty() && line.back() == at) parts.emplace_back();
    return parts;
}

struct Field {
    std::string file, name;
    bool with_particles, depth_averaged;  ///< measured
};

std::vector<Field> documented() {
    std::ifstream in(TALUS_SOURCE_DIR "/docs/results.md");
    std::vector<Field> fields;
    const auto bare = [](std::string text) {
        std::erase_if(text, [](char c) { return c == ' ' || c == '`'; });
        return text;
    };
    for (std::string line; std::getline(in, line);) {
        const std::vector<std::string> cells = cut(line, '|');
        if (cells.size() < 5) continue;
        const std::string particles = bare(cells[3]), flat = bare(cells[4]);
        const auto said = [](const std::string& text) { return text == "measured" || text == "notmeasured"; };
        if (said(particles) && said(flat)) {
            fields.push_back({bare(cells[1]), bare(cells[2]), particles == "measured", flat == "measured"});
        }
    }
    return fields;
}

using Columns = std::map<std::string, std::vector<std::string>>;

Columns columns_of(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    const std::vector<std::string> names = cut(line, ',');
    Columns columns;
    while (std::getline(in, line)) {
        const std::vector<std::string> cells = cut(line, ',');
        for (std::size_t k = 0; k < names.size(); ++k) columns[names[k]].push_back(k < cells.size() ? cells[k] : "");
    }
    return columns;
}

class NotMeasured : public scene::SceneFolder {
  protected:
    /// A run of the valley with a dam and a house, and all that it writes, or its tables alone.
    [[nodiscard]] std::filesystem::path written(const std::string& model, bool tables = false) const {
        write_features("houses.geojson", {rectangle(100, 96, 108, 104)});
        write_valley(
            fmt::format("[buildings]\nfile = \"houses.geojson\"\n[[barrier]]\nname = \"dam\"\nline_m = [[{0}, "
                        "{1}], [{0}, {2}]]\nheight_m = 2\n",
                        west + 85, south + 70, south + 130));
        const scene::Scene scene =
            loaded({"solver.model=" + model, "solver.end_time_s=9", "solver.target_particle_count=400"});
        const run::RunResult result = test::value_of(run::run_scene(scene, {}));
        const std::filesystem::path to = folder / model;
        std::filesystem::create_directories(to);
        const Status status = tables ? write_tables(scene, result, to, "") : write_products(scene, result, to);
        if (!status.ok()) throw std::runtime_error(status.error().message);
        return to;
    }
};

TEST_F(NotMeasured, is_empty_in_every_file_and_nothing_else_is) {
    const std::vector<Field> fields = documented();
    ASSERT_GT(fields.size(), 10U);
    const std::filesystem::path particles = written("particles"), flat = written("depth_averaged");
    for (const auto& [from, is_flat] : {std::pair{particles, false}, {flat, true}}) {
        for (const Field& field : fields) {
            SCOPED_TRACE(field.file + " " + field.name + (is_flat ? ", depth-averaged" : ", particles"));
            const bool measured = is_flat ? field.depth_averaged : field.with_particles;
            if (field.file.ends_with(".json")) {
                const json all = json::parse(test::read_text(from / field.file));
                const json::json_pointer place(field.name);
                EXPECT_EQ(all.contains(place) && !all.at(place).is_null(), measured);
                continue;
            }
            const Columns table = columns_of(from / field.file);
            ASSERT_TRUE(table.contains(field.name));
            const auto& values = table.at(field.name);
            EXPECT_EQ(std::any_of(values.begin(), values.end(), [](const auto& v) { return !v.empty(); }), measured);
        }
    }
    // And the other way: what one model leaves empty where the other has values is in the table.
    for (const char* file :
         {"timeseries.csv", "buildings.csv", "structures_over_time.csv", "front.csv", "run_out.csv"}) {
        const Columns a = columns_of(particles / file), b = columns_of(flat / file);
        ASSERT_EQ(a.size(), b.size()) << file;
        for (const auto& [name, values] : a) {
            const auto some = [](const auto& list) {
                return std::any_of(list.begin(), list.end(), [](const auto& v) { return !v.empty(); });
            };
            if (some(values) == some(b.at(name))) continue;
            EXPECT_TRUE(std::any_of(fields.begin(), fields.end(),
                                    [&](const Field& field) { return field.file == file && field.name == name; }))
                << file << " " << name;
        }
    }
}

TEST_F(NotMeasured, has_no_step_before_the_first) {
    for (const char* model : {"particles", "depth_averaged"}) {
        const Columns table = columns_of(written(model, true) / "timeseries.csv");
        for (const char* name :
             {"mean_compression", "max_compression", "overcompressed_share", "time_step_s", "steps_per_second"}) {
            EXPECT_EQ(table.at(name).front(), "") << model << " " << name;
        }
        EXPECT_NE(table.at("time_step_s").back(), "") << model;
        EXPECT_NE(table.at("volume_held_m3").front(), "0") << model;
    }
}

}  // namespace
}  // namespace talus::products
