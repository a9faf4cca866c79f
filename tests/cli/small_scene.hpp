#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "support/fixtures.hpp"

namespace talus::test {

/// A scene that runs in a moment: 120 m3 on a 300 m x 200 m plane that falls to the west, with a building below.
class SmallScene {
  public:
    SmallScene() {
        write_plane(input("terrain.tif"), terrain());
        write_vector(input("release.geojson"), {}, {{rectangle_wkt(824200, 825090, 824220, 825110), {}}});
        write_vector(input("buildings.geojson"), {}, {{rectangle_wkt(824150, 825090, 824160, 825110), {}}});
        write(text());
    }

    /// Where the program is run.
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_.path(); }
    [[nodiscard]] std::string input(const std::string& name) const { return folder_.file(name); }
    [[nodiscard]] std::string scene_file() const { return folder_.file("slope.toml"); }

    static RasterOptions terrain() {
        RasterOptions options;
        options.columns = 60;
        options.rows = 40;
        return options;
    }
    static std::string text() {
        return R"([scene]
title = "Plane"
[terrain]
file = "terrain.tif"
[[release]]
name = "scar"
file = "release.geojson"
thickness_m = 0.3
[buildings]
file = "buildings.geojson"
[solver]
particle_spacing_m = 0.8
end_time_s = 1
stop_moving_share = 0
[[observation]]
chainage_m = 5
front_velocity_mps = 3
)";
    }
    void write(const std::string& text) const { write_text(scene_file(), text); }
    /// Replaces a part of the scene file's text, which must be there.
    void replace(const std::string& part, const std::string& by) const {
        std::string text = read_text(scene_file());
        const auto at = text.find(part);
        if (at == std::string::npos) throw std::runtime_error("not in the scene: " + part);
        write(text.replace(at, part.size(), by));
    }

    /// Every file and folder below folder().
    [[nodiscard]] std::set<std::string> files() const {
        std::set<std::string> found;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder())) {
            found.insert(entry.path().lexically_relative(folder()).string());
        }
        return found;
    }

  private:
    TemporaryFolder folder_;
};

}  // namespace talus::test
