#include <gmock/gmock.h>

#include "scene/scene.hpp"
#include "scene_folder.hpp"

namespace talus::scene {
namespace {

using testing::HasSubstr;

class AlertsOfAScene : public SceneFolder {
  protected:
    /// The valley with a house on its thalweg, one beside it, and an inflow.
    void write_with(const std::string& more) const {
        write_features("houses.geojson", {rectangle(200, 90, 210, 110, "\"name\": \"House 38\""),
                                          rectangle(200, 170, 210, 180, "\"name\": \"far away\"")});
        write("surge.csv", "time_s,discharge_m3ps,velocity_mps\n0,0,0\n1,10,4\n5,0,0\n");
        write_valley(fmt::format("[buildings]\nfile = \"houses.geojson\"\nname_attribute = \"name\"\n"
                                 "[[inflow]]\nname = \"gully\"\nline_m = [[{0}, {1}], [{0}, {2}]]\n"
                                 "hydrograph = \"surge.csv\"\n",
                                 west + 45, south + 95, south + 105) +
                     more);
    }
    [[nodiscard]] std::string error_of(const std::string& more) const {
        write_with(more);
        return load_error();
    }
};

TEST_F(AlertsOfAScene, are_loaded_as_they_stand) {
    write_with(
        "[[trigger]]\nname = \"meter\"\nrelease = \"scarp\"\nvolume_limit_m3 = 900\n"
        "[[trigger]]\nname = \"gauge\"\ninflow = \"gully\"\ndischarge_limit_m3ps = 30\nhold_time_s = 20\n"
        "[[alarm]]\nname = \"near\"\nstructure = \"House 38\"\ndistance_m = 50\n"
        "[[alarm]]\nname = \"load\"\nstructure = \"far away\"\nimpact_pressure_Pa = 30000\n");
    const Scene scene = loaded();
    ASSERT_EQ(scene.spec.triggers.size(), 2U);
    EXPECT_EQ(scene.spec.triggers[0].volume_limit, 900);
    EXPECT_FALSE(scene.spec.triggers[0].discharge_limit);
    EXPECT_EQ(scene.spec.triggers[1].hold_time, 20);
    ASSERT_EQ(scene.spec.alarms.size(), 2U);
    EXPECT_EQ(scene.spec.alarms[1].impact_pressure, 30000);
}

TEST_F(AlertsOfAScene, name_only_what_exists_and_fits_together) {
    const std::string trigger = "[[trigger]]\nname = \"t\"\n", alarm = "[[alarm]]\nname = \"a\"\n";
    const std::pair<std::string, std::vector<std::string>> bad[] = {
        {"[[trigger]]\nrelease = \"scarp\"\n", {"trigger[0].name"}},
        {trigger + trigger, {"2 entries have that name"}},
        {trigger + "release = \"scar\"\n", {"trigger[0].release", "nearest name: scarp"}},
        {trigger + "inflow = \"guly\"\n", {"trigger[0].inflow", "nearest name: gully"}},
        {trigger + "volume_limit_m3 = 10\n", {"trigger[0].volume_limit_m3", "needs release"}},
        {trigger + "discharge_limit_m3ps = 10\n", {"trigger[0].discharge_limit_m3ps", "needs inflow"}},
        {trigger + "inflow = \"gully\"\ndischarge_limit_m3ps = 10\nstart_discharge_m3ps = 10\n",
         {"start_discharge_m3ps", "below discharge_limit_m3ps"}},
        {trigger + "pore_pressure_ratio_limit = 1.5\n", {"pore_pressure_ratio_limit = 1.5"}},
        {trigger + "token = \"secret\"\n", {"token"}},
        {alarm + "distance_m = 50\n", {"exactly one of structure, chainage_m, x_m"}},
        {alarm + "structure = \"House 38\"\n", {"exactly one of distance_m"}},
        {alarm + "structure = \"House 38\"\ndistance_m = 50\ndepth_m = 1\n", {"exactly one of distance_m"}},
        {alarm + "structure = \"House 83\"\ndistance_m = 50\n", {"alarm[0].structure", "nearest name: House 38"}},
        {alarm + "structure = \"far away\"\ndistance_m = 50\n", {"alarm[0].distance_m", "outside the flow path"}},
        {alarm + "chainage_m = 1e5\ndistance_m = 50\n", {"alarm[0].chainage_m", "beyond the flow path"}},
        {alarm + "chainage_m = 50\nimpact_pressure_Pa = 50\n", {"impact_pressure_Pa", "needs structure"}},
        {alarm + "x_m = 5\ny_m = 5\ndepth_m = 1\n", {"alarm[0].x_m", "is not on the terrain"}},
        {alarm + "x_m = 5\ndepth_m = 1\n", {"go together"}},
        {alarm + "x_m = 5\ny_m = 5\nlead_time_s = 1\n", {"lead_time_s", "needs structure or chainage_m"}},
    };
    for (const auto& [more, parts] : bad) {
        const std::string error = error_of(more);
        for (const std::string& part : parts) EXPECT_THAT(error, HasSubstr(part)) << more;
    }
}

}  // namespace
}  // namespace talus::scene
