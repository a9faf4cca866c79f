#pragma once

#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "geo/crs.hpp"
#include "products/series.hpp"
#include "report/report_fixture.hpp"
#include "support/fixtures.hpp"

namespace talus::products {

/// The sample valley with debris that grows over three frames, as the run over time sees it.
class ViewOfARun : public testing::Test {
  protected:
    static constexpr double times[] = {0, 1, 2.5};
    static constexpr int first_column = 100, first_row = 90;  ///< of the debris on the map

    ViewOfARun() {
        scene.crs = *geo::crs_from_text("EPSG:2326");
        place_buildings(scene.terrain, scene.buildings);
    }

    Status write(const std::vector<std::string>& formats, bool with_particles = true) {
        scene.spec.outputs.series = formats;
        Series series(scene, folder.path() / "series", "/home/somebody's \"runs\"/series");
        const sim::State state = particles();
        for (std::size_t k = 0; k < 3; ++k) {
            run::Frame frame = frame_at(k);
            frame.frame = &scene.terrain.frame();
            if (with_particles) frame.particles = &state;
            if (Status added = series.add(frame); !added) return added;
        }
        const std::vector<std::string> missing = series.finish(result);
        return missing.empty() ? Status() : Status(Error{missing.front()});
    }
    [[nodiscard]] std::string file(const std::string& name) const { return folder.file("series/" + name); }

    /// A square of 2 m deep debris, 4 cells wide in the first frame and 2 more in each that follows.
    [[nodiscard]] run::Frame frame_at(std::size_t k) const {
        const GridGeometry& map = result.observation.maps.peak_depth.geometry;
        const int width = 4 + 2 * static_cast<int>(k);
        run::Frame frame;
        frame.time = times[k];
        frame.thinnest_depth = 0.1;
        frame.debris.first_column = first_column;
        frame.debris.first_row = first_row;
        const GridGeometry window{map.x_min + first_column * map.cell, map.y_min + first_row * map.cell, map.cell,
                                  width, width};
        frame.debris.depth = Grid<float>(window, 2);
        frame.debris.speed = Grid<float>(window, 3);
        return frame;
    }

    static sim::State particles() {
        sim::State state;
        state.count = 4;
        for (sim::VectorArray* array : {&state.position, &state.velocity}) array->resize(4);
        state.id = {7, 4, 9, 1};
        state.held = {0, 0, 0, 0};
        for (std::size_t i = 0; i < 4; ++i) {
            const auto f = static_cast<float>(i);
            state.position.set(i, {f, 10 + f, 20.126F + f});
            state.velocity.set(i, {3 * f, 4 * f, 0});
        }
        return state;
    }

    scene::Scene scene = test::sample_scene();
    run::RunResult result = test::sample_result(scene);
    test::TemporaryFolder folder;
};

}  // namespace talus::products
