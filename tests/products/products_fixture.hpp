#pragma once

#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <ogrsf_frmts.h>

#include "products/products.hpp"
#include "report/report_fixture.hpp"
#include "support/fixtures.hpp"

namespace talus::products {

/// The features of a layer of a file.
inline std::vector<OGRFeatureUniquePtr> read_layer(GDALDataset& data, const char* name) {
    std::vector<OGRFeatureUniquePtr> features;
    OGRLayer* layer = data.GetLayerByName(name);
    EXPECT_NE(layer, nullptr) << name;
    if (layer == nullptr) return features;
    for (auto& feature : layer) features.push_back(std::move(feature));
    return features;
}

/// All products of the sample valley, written once.
class Products : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        scene_ = new scene::Scene(test::sample_scene());
        result_ = new run::RunResult(test::sample_result(*scene_));
        result_->simulated_time = 41.2;
        result_->wall_time = 1;  // beside the stages
        for (std::size_t i = 0; i < sim::stage_count; ++i) {
            result_->stage_times.seconds[i] = 0.5 * static_cast<double>(i + 1);
            result_->wall_time += result_->stage_times.seconds[i];
        }
        folder_ = new test::TemporaryFolder;
        const Status status = write_products(*scene_, *result_, folder_->path());
        ASSERT_TRUE(status.ok()) << status.error().message;
    }
    static void TearDownTestSuite() {
        delete folder_;
        delete result_;
        delete scene_;
    }
    static nlohmann::json manifest() {
        return nlohmann::json::parse(test::read_text(folder_->path() / "manifest.json"));
    }

    static inline scene::Scene* scene_ = nullptr;
    static inline run::RunResult* result_ = nullptr;
    static inline test::TemporaryFolder* folder_ = nullptr;
};

}  // namespace talus::products
