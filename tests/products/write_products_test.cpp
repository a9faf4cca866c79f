#include <csignal>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "products_fixture.hpp"
#include "report/intensity.hpp"

namespace talus::products {
namespace {

using nlohmann::json;
using test::TemporaryFolder;
using testing::HasSubstr;
using testing::StartsWith;

TEST_F(Products, folder_holds_what_it_should_and_nothing_else) {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_->path())) {
        names.push_back(entry.path().filename());
    }
    EXPECT_THAT(names,
                testing::UnorderedElementsAre(
                    "arrival_time.qml", "arrival_time.tif", "buildings.csv", "deposit_depth.qml", "deposit_depth.tif",
                    "front.csv", "intensity.qml", "intensity.tif", "manifest.json", "peak_depth.qml", "peak_depth.tif",
                    "peak_pressure.qml", "peak_pressure.tif", "peak_speed.qml", "peak_speed.tif", "report.html",
                    "results.gpkg", "results.json", "results.kml", "results.qlr", "run_out.csv", "stac_item.json",
                    "structures_over_time.csv", "terrain.qml", "terrain.tif", "timeseries.csv"));
}

TEST_F(Products, partial_result_says_so_everywhere) {
    const TemporaryFolder folder;
    run::RunResult result = *result_;
    result.status = run::RunStatus::fault;
    result.stop_reason = "at 12.5 s the mean compression is 0.61, above compression_limit 0.5";
    ASSERT_TRUE(write_products(*scene_, result, folder.path()).ok());
    EXPECT_THAT(test::read_text(folder.path() / "PARTIAL.txt"), HasSubstr(result.stop_reason));
    const json m = json::parse(test::read_text(folder.path() / "manifest.json"));
    EXPECT_EQ(m["partial"], true);
    EXPECT_EQ(m["status"], "fault");
    EXPECT_EQ(m["stop_reason"], result.stop_reason);
    const GDALDatasetUniquePtr data(GDALDataset::Open(folder.file("peak_depth.tif").c_str()));
    EXPECT_THAT(data->GetRasterBand(1)->GetDescription(), HasSubstr("partial result: fault"));
}

TEST_F(Products, run_without_debris_path_or_buildings_is_written_too) {
    const TemporaryFolder folder;
    scene::Scene scene = *scene_;
    scene.buildings.clear();
    scene.flow_path = terrain::FlowPath();
    run::RunResult result = *result_;
    result.status = run::RunStatus::interrupted;
    const Grid<float> blank(GridGeometry{824100, 825500, 1, 4, 3}, std::nanf(""));
    result.observation = {};
    result.observation.maps = {blank, blank, blank, blank, blank};
    result.steps = 0;
    result.wall_time = 0;
    const Status status = write_products(scene, result, folder.path());
    ASSERT_TRUE(status.ok()) << status.error().message;
    EXPECT_TRUE(json::accept(test::read_text(folder.path() / "manifest.json")));
}

TEST_F(Products, full_disk_is_an_error_that_names_the_file) {
    // In a child, since the limit on file sizes holds for the whole process.
    const TemporaryFolder folder;
    for (const rlim_t limit : {500, 2000, 20000}) {
        int ends[2];
        ASSERT_EQ(pipe(ends), 0);
        const pid_t child = fork();
        if (child == 0) {
            std::signal(SIGXFSZ, SIG_IGN);
            const rlimit size{limit, limit};
            setrlimit(RLIMIT_FSIZE, &size);
            const Status status = write_products(*scene_, *result_, folder.path());
            const std::string message = status.ok() ? "written" : status.error().message;
            _exit(write(ends[1], message.data(), message.size()) < 0 ? 1 : 0);
        }
        close(ends[1]);
        char buffer[4096];
        const ssize_t count = read(ends[0], buffer, sizeof buffer);
        close(ends[0]);
        waitpid(child, nullptr, 0);
        const std::string message(buffer, count > 0 ? static_cast<std::size_t>(count) : 0);
        EXPECT_THAT(message, StartsWith(folder.path().string() + "/")) << limit;
        EXPECT_THAT(message, HasSubstr("cannot be written")) << limit;
        EXPECT_FALSE(std::filesystem::exists(folder.path() / "manifest.json")) << limit;
    }
}

}  // namespace
}  // namespace talus::products
