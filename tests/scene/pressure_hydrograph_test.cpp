#include "scene/pressure_hydrograph.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

namespace talus::scene {
namespace {

class PressureHydrograph : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ =
            std::filesystem::temp_directory_path() /
            (std::string("pressure_hydrograph_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    [[nodiscard]] Result<std::vector<params::PressureSample>> read(const std::string& text) const {
        const std::string file = (folder_ / "water.csv").string();
        std::ofstream(file) << text;
        return read_pressure_hydrograph(file);
    }
    [[nodiscard]] std::string error(const std::string& text) const {
        const auto rows = read(text);
        return rows ? "" : rows.error().message;
    }

  private:
    std::filesystem::path folder_;
};

TEST_F(PressureHydrograph, is_read_by_its_columns) {
    const auto rows = read("pore_pressure_ratio;note;time_s\n0,2;dry;0\n0,55;storm;3600\n");
    ASSERT_TRUE(rows) << rows.error().message;
    ASSERT_EQ(rows->size(), 2U);
    EXPECT_EQ(rows->back(), (params::PressureSample{3600, 0.55}));
}

TEST_F(PressureHydrograph, is_refused_with_its_line_and_what_is_allowed) {
    EXPECT_NE(error("time_s,ratio\n0,0.2\n1,0.3\n").find(":1: there is no column pore_pressure_ratio"),
              std::string::npos);
    EXPECT_NE(error("time_s,pore_pressure_ratio\n0,0.2\n1,1.3\n")
                  .find(":3: pore_pressure_ratio = \"1.3\" is refused; it must be a number from 0 to 1"),
              std::string::npos);
    EXPECT_NE(error("time_s,pore_pressure_ratio\n0,0.2\n0,0.3\n").find(":3: time_s = 0 is refused"), std::string::npos);
    EXPECT_NE(error("time_s,pore_pressure_ratio\n0,0.2\n").find("has 1 rows of values; it must have at least 2"),
              std::string::npos);
}

}  // namespace
}  // namespace talus::scene
