#include <sys/stat.h>

#include <gmock/gmock.h>

#include "scene/new_scene.hpp"
#include "scene/scene_folder.hpp"

namespace talus::scene {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class InputFiles : public SceneFolder {
  protected:
    static constexpr const char* loaded = "(it loaded)";

    void write_inflow(const std::string& hydrograph) const {
        write_valley("[[inflow]]\nline_m = [[824100, 825110], [824100, 825090]]\nhydrograph = \"h.csv\"\n");
        write("h.csv", hydrograph);
    }
};

TEST_F(InputFiles, pipes_and_devices_are_refused) {
    write_inflow("");
    ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
    for (const char* key : {"terrain.file", "release.file", "inflow.hydrograph"}) {
        for (const std::string& file : {path("pipe"), std::string("/dev/zero")}) {
            EXPECT_THAT(load_error({key + ("=" + file)}), AllOf(HasSubstr("--set"), HasSubstr(file + ": is a pipe")));
        }
    }
    for (const char* file : {"pipe", "/dev/zero"}) {
        const auto scene = load_scene(folder / file);
        ASSERT_FALSE(scene);
        EXPECT_THAT(scene.error().message, HasSubstr("it must be a file"));
    }
    NewSceneOptions options;
    options.dem = path("dem.tif");
    options.release = path("pipe");
    options.folder = folder / "new";
    const auto created = write_new_scene(options);
    ASSERT_FALSE(created);
    EXPECT_THAT(created.error().message, HasSubstr("it must be a file"));
}

TEST_F(InputFiles, a_byte_order_mark_before_a_hydrograph_is_read) {
    write_inflow("\xEF\xBB\xBFtime_s,discharge_m3ps,velocity_mps\n0,10,2\n10,10,2\n");
    EXPECT_EQ(load_error(), std::string(loaded));
}

TEST_F(InputFiles, hydrographs_of_spreadsheets_give_their_volume) {
    const auto volume = [&](const std::string& hydrograph) {
        write_inflow(hydrograph);
        const auto scene = load_scene(folder / "scene.toml");
        EXPECT_TRUE(scene) << scene.error().message;
        return scene ? scene->inflows.at(0).volume() : 0;
    };
    const std::string plain = "time_s,discharge_m3ps,velocity_mps\n0,0,3\n5,10.5,3\n25,0,3\n";
    EXPECT_DOUBLE_EQ(volume(plain), 131.25);
    EXPECT_DOUBLE_EQ(volume("time_s,discharge_m3ps,velocity_mps\n0,0,3\n5,\"10,5\",3\n25,0,3\n"), 131.25);
    EXPECT_DOUBLE_EQ(volume("time_s;discharge_m3ps;velocity_mps\r\n0;0;3\r\n5;10,500;3\r\n25;0;3\r\n"), 131.25);
    std::string utf16 = "\xFF\xFE";
    for (const char c : plain) utf16 += {c, '\0'};
    EXPECT_DOUBLE_EQ(volume(utf16), 131.25);
}

TEST_F(InputFiles, fields_that_no_column_has_are_refused) {
    write_inflow("time_s,discharge_m3ps,velocity_mps\n0,0,3\n5,10,5,3\n25,0,3\n");
    EXPECT_THAT(load_error(), HasSubstr("h.csv:3: has 4 fields, and the first line names 3 columns"));
    write_inflow("time_s,discharge_m3ps,velocity_mps\n0,0,3\n5,\"10,500\",3\n25,0,3\n");
    EXPECT_THAT(load_error(), HasSubstr("h.csv:3: discharge_m3ps = \"10,500\" is refused, because its comma may mark"));
}

TEST_F(InputFiles, a_column_given_twice_is_refused) {
    write_inflow("time_s,discharge_m3ps,velocity_mps,discharge_m3ps\n0,10,2,20\n10,10,2,20\n");
    EXPECT_THAT(load_error(), HasSubstr("h.csv:1: there are two columns discharge_m3ps; leave one of them out"));
    write_inflow("time_s,discharge_m3ps,velocity_mps,note,note\n0,10,2,a,b\n10,10,2,a,b\n");
    EXPECT_EQ(load_error(), std::string(loaded)) << "columns that are not read";
}

}  // namespace
}  // namespace talus::scene
