#include "scene/suspect_ground.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <gdal_priv.h>
#include <gtest/gtest.h>

#include "matchers.hpp"
#include "scene_folder.hpp"

namespace talus::scene {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

class SuspectGround : public SceneFolder {
  protected:
    SuspectGround() { write_valley(); }
    /// The notes of the scene on this ground, or why it is refused.
    [[nodiscard]] std::vector<std::string> told(const std::function<double(double, double)>& elevation) const {
        write_terrain("dem.tif", elevation);
        const auto scene = load_scene(folder / "scene.toml");
        return scene ? scene->notes : std::vector<std::string>{"refused: " + scene.error().message};
    }
};

TEST_F(SuspectGround, an_undeclared_0_is_refused_with_the_command_that_declares_it) {
    const auto notes = told([](double x, double y) { return x < west + 200 ? 700 + valley(x, y) : 0; });
    EXPECT_THAT(notes, Contains(AllOf(HasSubstr("refused: "), HasSubstr("terrain.file"),
                                      HasSubstr("cells hold exactly 0 m"), HasSubstr("it marks missing data"),
                                      // write_cog declares -9999: that has to stay
                                      HasSubstr("--calc='where(A==0,-9999,A)'"))));
}

TEST_F(SuspectGround, a_low_cliff_to_0_is_asked_about) {
    const auto notes = told([](double x, double y) { return x < west + 200 ? valley(x, y) - 50 : 0; });
    EXPECT_THAT(notes, Contains(AllOf(HasSubstr("terrain: "),
                                      HasSubstr("check these heights. If the value marks missing data"))));
    EXPECT_THAT(notes, Not(Contains(HasSubstr("refused"))));
}

TEST_F(SuspectGround, a_coast_is_not) {
    const auto notes = told([](double x, double y) { return std::max(0.0, valley(x, y) - 130); });
    EXPECT_THAT(notes, Not(Contains(HasSubstr("missing data"))));
}

TEST_F(SuspectGround, what_0_behind_a_hill_holds_does_not_matter) {
    // The release drains to the east; 0 lies behind a crest of 600 m in the west.
    const auto ground = [](double x, double y) {
        if (y > south + 150) return y > south + 180 ? 0.0 : 900.0;
        return 300 + valley(x, y);
    };
    EXPECT_THAT(told(ground), Not(Contains(HasSubstr("missing data"))));
}

TEST_F(SuspectGround, means_of_ground_and_nodata_are_refused) {
    const auto ground = [](double x, double y) {
        if (x > west + 200) return nan;
        if (x > west + 190) return 0.5 * (700 + valley(x, y)) - 0.5 * 9999;
        return 700 + valley(x, y);
    };
    EXPECT_THAT(told(ground),
                Contains(AllOf(HasSubstr("refused: "), HasSubstr("beside nodata are far below all other ground"),
                               HasSubstr("gdalwarp -srcnodata"), HasSubstr("--calc='where(A<"))));
    const auto mild = [](double x, double y) {
        if (x > west + 200) return nan;
        if (x > west + 190 && x < west + 195) return valley(x, y) - 60;
        return valley(x, y);
    };
    EXPECT_THAT(told(mild), Contains(HasSubstr("cells beside nodata are up to")));
    EXPECT_THAT(told([](double x, double y) { return x > west + 200 ? nan : valley(x, y); }),
                Not(Contains(HasSubstr("beside nodata"))));
}

TEST_F(SuspectGround, steep_ground_far_from_the_debris_is_no_question_of_feet) {
    // Walls of 70 degrees above a release at 27 degrees.
    const auto notes = told([](double x, double y) {
        const double across = std::abs(y - (south + rows * cell / 2));
        return 200 - 0.5 * (x - west) + (across > 30 ? 2.7 * (across - 30) : 0.2 * across);
    });
    EXPECT_THAT(notes, Not(Contains(HasSubstr("in feet"))));
}

TEST_F(SuspectGround, eight_bits_are_rarely_elevations) {
    EXPECT_THAT(told(valley), Not(Contains(HasSubstr("8-bit"))));
    GDALAllRegister();
    {
        const GDALDatasetUniquePtr from(GDALDataset::Open(path("dem.tif").c_str(), GDAL_OF_RASTER));
        const GDALDatasetUniquePtr made(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
            path("hillshade.tif").c_str(), columns, rows, 1, GDT_Byte, nullptr));
        std::array<double, 6> transform{};
        from->GetGeoTransform(transform.data());
        made->SetGeoTransform(transform.data());
        made->SetSpatialRef(from->GetSpatialRef());
        std::vector<float> line(columns * rows);
        ASSERT_EQ(from->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, columns, rows, line.data(), columns, rows,
                                                   GDT_Float32, 0, 0, nullptr),
                  CE_None);
        ASSERT_EQ(made->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, columns, rows, line.data(), columns, rows,
                                                   GDT_Float32, 0, 0, nullptr),
                  CE_None);
    }
    const Scene scene = loaded({"terrain.file=" + path("hillshade.tif")});
    EXPECT_THAT(scene.notes, Contains(AllOf(HasSubstr("8-bit numbers"), HasSubstr("hillshade"))));
}

}  // namespace
}  // namespace talus::scene
