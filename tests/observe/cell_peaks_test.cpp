#include "observe/cell_peaks.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "observe/grid_flow.hpp"
#include "simd/dispatch.hpp"

namespace talus::test {
namespace {

class CellPeaks : public testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        const Status chosen = simd::choose_instruction_set(GetParam());
        if (!chosen) GTEST_SKIP() << chosen.error().message;
        for (std::vector<float>* array : {&depth_, &u_, &v_, &slope_x_, &slope_y_, &climb_}) {
            array->resize(cells);
            for (float& number : *array) number = uniform_(random_);
        }
        for (float& depth : depth_) depth = std::abs(depth);
    }
    void TearDown() override { ASSERT_TRUE(simd::choose_instruction_set(simd::instruction_sets().front())); }

    /// A row that begins and ends within a register.
    [[nodiscard]] depth::CellRow row(bool flies) const {
        return {0,
                3,
                static_cast<int>(cells),
                depth_.data() + 3,
                u_.data() + 3,
                v_.data() + 3,
                slope_x_.data() + 3,
                slope_y_.data() + 3,
                flies ? climb_.data() + 3 : nullptr};
    }

    static constexpr std::size_t cells = 70;
    std::mt19937 random_{7};
    std::uniform_real_distribution<float> uniform_{-3, 3};
    std::vector<float> depth_, u_, v_, slope_x_, slope_y_, climb_;
};

TEST_P(CellPeaks, rise_where_debris_is_deeper_or_faster_than_before_and_not_too_thin) {
    constexpr float thinnest = 0.5F;
    for (const bool flies : {false, true}) {
        const depth::CellRow from = row(flies);
        std::vector<float> depth(cells, 1.5F), speed(cells, 4);
        observe::raise_peaks_function()(from, thinnest, depth.data() + 3, speed.data() + 3);
        int deeper = 0, faster = 0;
        for (std::size_t k = 0; k < cells; ++k) {
            const bool counts = k >= 3 && depth_[k] > thinnest;
            const float now = observe::speed_of(u_[k], v_[k], slope_x_[k], slope_y_[k], flies ? climb_[k] : 0.0F);
            EXPECT_EQ(depth[k], counts ? std::max(1.5F, depth_[k]) : 1.5F) << k;
            EXPECT_EQ(speed[k], counts ? std::max(4.0F, now) : 4.0F) << k;
            deeper += depth[k] > 1.5F ? 1 : 0;
            faster += speed[k] > 4 ? 1 : 0;
        }
        EXPECT_GT(deeper, 10);
        EXPECT_GT(faster, 10);
    }
}

INSTANTIATE_TEST_SUITE_P(EveryInstructionSet, CellPeaks, ::testing::Values("AVX3", "AVX2", "SSE4", "SCALAR"),
                         [](const auto& set) { return std::string(set.param); });

}  // namespace
}  // namespace talus::test
