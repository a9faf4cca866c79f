#pragma once

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "talus.h"

/// A small scene and what tests of libtalus ask for again and again.
namespace talus::embed::test {

namespace fs = std::filesystem;

struct Close {
    void operator()(talus_simulation* simulation) const { talus_close(simulation); }
};
using Simulation = std::unique_ptr<talus_simulation, Close>;

/// A slope of 1 : 2 that falls to the east, with a scar 1 m deep and a house below it.
struct Slope {
    static constexpr int columns = 60, rows = 30;
    std::vector<float> elevation, release;
    std::vector<double> outline{40, 12, 46, 12, 46, 18, 40, 18};
    talus_building house{sizeof(talus_building), "house", outline.data(), 4, 4};
    talus_arrays arrays = TALUS_SIZED(talus_arrays);

    Slope() {
        for (int row = 0; row < rows; ++row) {
            for (int column = 0; column < columns; ++column) {
                elevation.push_back(200 - 0.5F * static_cast<float>(column));
                const bool scar = column >= 5 && column < 15 && row >= 10 && row < 20;
                release.push_back(scar ? 1.0F : 0.0F);
            }
        }
        arrays.crs = "EPSG:32650";
        arrays.grid = {0, 0, 1, columns, rows};
        arrays.elevation = elevation.data();
        arrays.release = release.data();
        arrays.buildings = &house;
        arrays.building_count = 1;
    }

    [[nodiscard]] Simulation open(const char* folder = nullptr, const char* threads = "solver.thread_count=1") const {
        const char* settings[] = {"solver.target_particle_count=600", "material.friction_coefficient=0.2", threads};
        talus_simulation* simulation = nullptr;
        talus_error error = TALUS_SIZED(talus_error);
        EXPECT_EQ(talus_open_arrays(&arrays, folder, settings, 3, nullptr, &simulation, &error), TALUS_OK)
            << error.text;
        return Simulation(simulation);
    }
};

/// A new folder, removed with this.
struct Folder {
    fs::path path;
    Folder() {
        std::string name = (fs::temp_directory_path() / "talus-embed-XXXXXX").string();
        path = mkdtemp(name.data());
    }
    ~Folder() { fs::remove_all(path); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
};

inline talus_state state_of(const Simulation& simulation) {
    talus_error error = TALUS_SIZED(talus_error);
    talus_state state = TALUS_SIZED(talus_state);
    EXPECT_EQ(talus_get_state(simulation.get(), &state, &error), TALUS_OK) << error.text;
    return state;
}

inline std::uint64_t hash_of(const Simulation& simulation) {
    std::uint64_t hash = 0;
    EXPECT_EQ(talus_get_hash(simulation.get(), &hash, nullptr), TALUS_OK);
    return hash;
}

inline talus_debris debris_of(const Simulation& simulation) {
    talus_debris debris = TALUS_SIZED(talus_debris);
    EXPECT_EQ(talus_get_debris(simulation.get(), &debris, nullptr), TALUS_OK);
    return debris;
}

inline void advance_to(const Simulation& simulation, double time) {
    talus_error error = TALUS_SIZED(talus_error);
    ASSERT_EQ(talus_advance(simulation.get(), time, nullptr, &error), TALUS_OK) << error.text;
}

}  // namespace talus::embed::test
