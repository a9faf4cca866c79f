#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <unistd.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "geo/raster.hpp"
#include "scene/scene.hpp"
#include "support/value_of.hpp"

namespace talus::scene {

/// A folder of its own for a test, with a small valley: 60 x 40 cells of 5 m in EPSG:2326, falling towards the east,
/// and a release of 20 m x 20 m near its top.
class SceneFolder : public testing::Test {
  protected:
    static constexpr double west = 824000, south = 825000, cell = 5;
    static constexpr int columns = 60, rows = 40;

    SceneFolder() : folder(std::filesystem::path(testing::TempDir()) / unique_name()) {
        std::filesystem::remove_all(folder);
        std::filesystem::create_directories(folder);
    }
    ~SceneFolder() override { std::filesystem::remove_all(folder); }

    [[nodiscard]] std::string path(const std::string& name) const { return (folder / name).string(); }

    void write(const std::string& name, const std::string& text) const {
        std::ofstream(folder / name, std::ios::binary) << text;
    }

    /// A valley 0.5 steep towards the east with its thalweg in the middle row.
    static double valley(double x, double y) {
        const double across = y - (south + rows * cell / 2);
        return 200 - 0.5 * (x - west) + 0.2 * std::abs(across);
    }

    void write_terrain(const std::string& name, const std::function<double(double, double)>& elevation) const {
        Grid<float> grid(GridGeometry{west, south, cell, columns, rows});
        for (int row = 0; row < rows; ++row) {
            for (int column = 0; column < columns; ++column) {
                const PlanPoint p = grid.geometry.centre(column, row);
                grid.at(column, row) = static_cast<float>(elevation(p.x, p.y));
            }
        }
        const Status written = geo::write_cog(path(name), {&grid, "elevation", "m"}, {"", "", 2326});
        ASSERT_TRUE(written) << written.error().message;
    }

    /// A GeoJSON feature: a rectangle relative to the terrain's south-west corner.
    static std::string rectangle(double x_min, double y_min, double x_max, double y_max,
                                 const std::string& properties = "") {
        return fmt::format(
            R"({{"type": "Feature", "properties": {{{0}}}, "geometry": {{"type": "Polygon", "coordinates": )"
            R"([[[{1}, {2}], [{3}, {2}], [{3}, {4}], [{1}, {4}], [{1}, {2}]]]}}}})",
            properties, west + x_min, south + y_min, west + x_max, south + y_max);
    }

    void write_features(const std::string& name, const std::vector<std::string>& features) const {
        std::string list;
        for (const std::string& feature : features) list += (list.empty() ? "" : ",\n") + feature;
        write(name, R"({"type": "FeatureCollection", "crs": {"type": "name", "properties": )"
                    R"({"name": "urn:ogc:def:crs:EPSG::2326"}}, "features": [)" +
                        list + "]}");
    }

    /// The valley, its release and a scene of both; `more` is appended to the scene.
    void write_valley(const std::string& more = "", const std::string& thickness = "thickness_m = 2") const {
        write_terrain("dem.tif", valley);
        write_features("release.geojson", {rectangle(20, 90, 40, 110)});
        write("scene.toml",
              "[terrain]\nfile = \"dem.tif\"\n[[release]]\nname = \"scarp\"\nfile = \"release.geojson\"\n" + thickness +
                  "\n" + more);
    }

    /// The scene in scene.toml.
    [[nodiscard]] Scene loaded(const std::vector<std::string>& overrides = {}) const {
        return test::value_of(load_scene(folder / "scene.toml", overrides));
    }
    [[nodiscard]] std::string load_error(const std::vector<std::string>& overrides = {}) const {
        const auto scene = load_scene(folder / "scene.toml", overrides);
        return scene ? "(it loaded)" : scene.error().message;
    }

    std::filesystem::path folder;

  private:
    static std::string unique_name() {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        return fmt::format("{}-{}-{}", test->test_suite_name(), test->name(), getpid());
    }
};

}  // namespace talus::scene
