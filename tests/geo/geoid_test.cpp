#include "geo/geoid.hpp"

#include <array>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include <cpl_string.h>
#include <gmock/gmock.h>
#include <ogr_srs_api.h>

#include "support/fixtures.hpp"

namespace talus::geo {
namespace {

/// As the format GTX of NOAA has them: the most significant byte first.
template <class Number, class Bits>
void put(std::ofstream& out, Number value) {
    const auto bits = std::bit_cast<Bits>(value);
    for (int shift = 8 * (static_cast<int>(sizeof(Bits)) - 1); shift >= 0; shift -= 8) {
        out.put(static_cast<char>(bits >> shift & 0xFF));
    }
}

/// Folders in which PROJ looks for grids, put back at the end.
class Geoid : public testing::Test {
  protected:
    Geoid() : before_(OSRGetPROJSearchPaths()) {}
    ~Geoid() override {
        OSRSetPROJSearchPaths(before_);
        CSLDestroy(before_);
    }
    /// The folders of before have the systems of EPSG, and may have grids.
    void look_in(const test::TemporaryFolder& folder) const {
        char** paths = CSLAddString(nullptr, folder.path().c_str());
        for (int k = 0; before_ != nullptr && before_[k] != nullptr; ++k) paths = CSLAddString(paths, before_[k]);
        OSRSetPROJSearchPaths(paths);
        CSLDestroy(paths);
    }
    /// A grid of the whole earth with cells of 10 degrees: the longitude, over 10, in m.
    static void write_grid(const std::string& file) {
        std::ofstream out(file, std::ios::binary);
        for (const double value : {-90.0, -180.0, 10.0, 10.0}) put<double, std::uint64_t>(out, value);
        for (const std::int32_t count : {19, 37}) put<std::int32_t, std::uint32_t>(out, count);
        for (int row = 0; row < 19; ++row) {
            for (int column = 0; column < 37; ++column) {
                put<float, std::uint32_t>(out, static_cast<float>(-18 + column));
            }
        }
    }

    char** before_;
    test::TemporaryFolder folder_;
};

TEST_F(Geoid, is_that_of_the_grid_that_is_installed) {
    for (int k = 0; before_ != nullptr && before_[k] != nullptr; ++k) {
        if (std::filesystem::exists(std::filesystem::path(before_[k]) / "us_nga_egm08_25.tif")) {
            GTEST_SKIP() << "this PROJ has the newer file of EGM2008, which it prefers";
        }
    }
    write_grid(folder_.file("egm08_25.gtx"));
    look_in(folder_);
    // UTM zone 31: 500 km east is 3 degrees east of Greenwich.
    const auto found = geoid_height(*crs_from_text("EPSG:32631"), {500000, 4500000});
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->height, 0.3, 1e-4);
    EXPECT_EQ(found->model, "EGM2008");
}

TEST_F(Geoid, of_a_local_system_is_not_known) {
    write_grid(folder_.file("egm08_25.gtx"));
    look_in(folder_);
    EXPECT_FALSE(geoid_height(Crs::own_metres(), {2, 0.3}));
}

TEST_F(Geoid, nothing_is_fetched_and_the_setting_is_as_before) {
    const int before = OSRGetPROJEnableNetwork();
    (void)geoid_height(*crs_from_text("EPSG:32631"), {500000, 4500000});
    EXPECT_EQ(OSRGetPROJEnableNetwork(), before);
}

}  // namespace
}  // namespace talus::geo
