#include <algorithm>
#include <cstdlib>
#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "params/scene_text.hpp"
#include "scene/scene.hpp"
#include "scene_folder.hpp"

namespace talus::scene {
namespace {

using testing::AnyOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

class ParseScene : public SceneFolder {
  protected:
    /// The error of a scene with a valid start of five lines followed by `text`: line 6 is its first.
    [[nodiscard]] std::string error_after(const std::string& text,
                                          const std::vector<std::string>& overrides = {}) const {
        return error_of(minimal + text, overrides);
    }
    [[nodiscard]] std::string error_of(const std::string& text, const std::vector<std::string>& overrides = {}) const {
        write("scene.toml", text);
        const auto spec = parse_scene(file(), overrides);
        if (spec) return "(it parsed)";
        EXPECT_EQ(spec.error().message.find('\n'), std::string::npos) << spec.error().message;
        return spec.error().message;
    }
    params::SceneSpec parsed(const std::string& text, const std::vector<std::string>& overrides = {}) const {
        write("scene.toml", text);
        return test::value_of(parse_scene(file(), overrides));
    }
    [[nodiscard]] std::string file() const { return path("scene.toml"); }
    [[nodiscard]] std::string line(int number) const { return file() + ":" + std::to_string(number) + ": "; }

    const std::string minimal =
        "[terrain]\nfile = \"dem.tif\"\n[[release]]\nfile = \"release.geojson\"\nthickness_m = 2\n";
};

TEST_F(ParseScene, reads_every_section_and_keeps_defaults) {
    const params::SceneSpec spec = parsed(minimal + R"([scene]
title = "Häng"
assumptions = ["one", "two"]
[buildings]
file = "/data/houses.gpkg"
[solver]
target_particle_count = 1e5
end_time_s = 30
kernel = "spiky"
[[observation]]
chainage_m = 121
front_velocity_mps = 11
)");
    EXPECT_EQ(spec.scene.title, "Häng");
    EXPECT_EQ(spec.scene.assumptions.size(), 2U);
    EXPECT_EQ(spec.terrain.file, path("dem.tif"));
    EXPECT_EQ(spec.buildings.file, "/data/houses.gpkg");
    EXPECT_EQ(spec.releases.at(0).thickness, 2.0);
    EXPECT_EQ(spec.solver.target_particle_count, 100000);
    EXPECT_EQ(spec.solver.kernel, params::KernelChoice::spiky);
    EXPECT_EQ(spec.solver.end_time, 30);
    EXPECT_EQ(spec.material.viscosity, params::MaterialSpec{}.viscosity);
    EXPECT_EQ(spec.observations.at(0).chainage, 121);
}

TEST_F(ParseScene, unknown_keys_name_the_nearest_one) {
    EXPECT_EQ(error_after("[material]\nviscocity = 0.1\n"),
              line(7) + "unknown key \"viscocity\" in [material]; nearest known key: viscosity");
    EXPECT_THAT(error_after("[solver]\n\nparticle_spacing = 0.1\n"), EndsWith("nearest known key: particle_spacing_m"));
    EXPECT_EQ(error_after("[outputs]\nviscosity = 0.1\n"),
              line(7) + "unknown key \"viscosity\" in [outputs]; it belongs in [material]");
}

TEST_F(ParseScene, unknown_keys_of_other_programs_lead_to_the_key_of_the_same_meaning) {
    EXPECT_EQ(error_after("[material]\nmu = 0.2\n"),
              line(7) + "unknown key \"mu\" in [material]; here it is called friction_coefficient or viscosity");
    EXPECT_THAT(error_after("[material]\nxi = 500\n"), EndsWith("here it is called turbulent_friction_mps2"));
    EXPECT_THAT(error_after("[material]\nxsiVoellmy = 500\n"), EndsWith("here it is called turbulent_friction_mps2"));
    EXPECT_THAT(error_after("[material]\nfrictoin = 0.2\n"), EndsWith("nearest known key: friction_coefficient"));
    EXPECT_THAT(error_after("[material]\ncohesion = 100\n"), EndsWith("nearest known key: cohesion_Pa"));
    EXPECT_THAT(error_after("[solver]\nxi = 500\n"), EndsWith("it belongs in [material] as turbulent_friction_mps2"));
    EXPECT_EQ(error_of("xi = 500\n" + minimal),
              line(1) + "key \"xi\" stands outside a section; it belongs in [material] as turbulent_friction_mps2");
}

TEST_F(ParseScene, control_characters_do_not_reach_the_terminal) {
    for (const std::string text : {"[solver]\n\"\\u001b[31m\\n\" = 1\n", "[solver]\nkernel = \"\\u001b[31m\\n\"\n",
                                   "[\"\\u001b[31m\"]\n", "[buildings]\nfile = \"a\\u0000b\"\n"}) {
        const std::string message = error_after(text);
        EXPECT_THAT(message, AnyOf(StartsWith(line(6)), StartsWith(line(7))));
        EXPECT_TRUE(std::none_of(message.begin(), message.end(), [](char c) { return c >= 0 && c < ' '; })) << message;
    }
}

TEST_F(ParseScene, unknown_sections_name_the_nearest_one) {
    EXPECT_EQ(error_after("[materials]\n"), line(6) + "unknown section \"materials\"; nearest known section: material");
    EXPECT_EQ(error_of("title = \"a\"\n" + minimal),
              line(1) + "key \"title\" stands outside a section; it belongs in [scene]");
}

TEST_F(ParseScene, wrong_types_name_key_value_and_kind) {
    EXPECT_EQ(error_after("[material]\nviscosity = \"high\"\n"),
              line(7) + "material.viscosity = 'high' is refused; it must be a number from 0 to below 1");
    EXPECT_THAT(error_after("[solver]\niteration_count = 2.5\n"),
                StartsWith(line(7) + "solver.iteration_count = 2.5 is refused; it must be a whole number"));
    EXPECT_THAT(error_after("[scene]\nreconstruction = 1\n"), EndsWith("it must be true or false"));
    EXPECT_THAT(error_after("[scene]\nsources = \"one\"\n"), EndsWith("a list of texts in quotes"));
    EXPECT_THAT(error_after("[scene]\nsources = [1]\n"), EndsWith("a list of texts in quotes"));
    EXPECT_THAT(error_after("[solver]\nend_time_s = [1]\n"),
                EndsWith("a number greater than 0 and at most 10000000 (s)"));
    EXPECT_THAT(error_after("[solver]\nend_time_s = 2020-01-01\n"),
                EndsWith("a number greater than 0 and at most 10000000 (s)"));
}

TEST_F(ParseScene, values_out_of_range_name_the_range) {
    EXPECT_EQ(error_after("[material]\nviscosity = 1\n"),
              line(7) + "material.viscosity = 1 is refused; it must be a number from 0 to below 1");
    EXPECT_EQ(error_after("[solver]\nkernel = \"gauss\"\n"),
              line(7) +
                  "solver.kernel = 'gauss' is refused; it must be one of \"wendland_c2\", \"cubic_spline\", "
                  "\"spiky\", \"poly6_spiky\"");
    EXPECT_THAT(error_after("[solver]\nparticle_limit = 99999999999999\n"), HasSubstr("from 1 to"));
    EXPECT_THAT(error_after("[solver]\nend_time_s = nan\n"), HasSubstr("end_time_s = nan is refused"));
    EXPECT_THAT(error_after("[solver]\nend_time_s = inf\n"), HasSubstr("end_time_s = inf is refused"));
    EXPECT_THAT(error_of("[terrain]\nextent_m = [0, 0, 0, 1]\n"), StartsWith(line(2) + "terrain.extent_m = "));
    EXPECT_THAT(error_of("[terrain]\nextent_m = [0, 0, 1]\n"), HasSubstr("[x_min, y_min, x_max, y_max]"));
}

TEST_F(ParseScene, zero_and_negative_thickness_are_refused) {
    const std::string start = "[terrain]\nfile = \"dem.tif\"\n[[release]]\nfile = \"r.gpkg\"\n";
    EXPECT_EQ(error_of(start + "thickness_m = 0\n"),
              line(5) + "release[0].thickness_m = 0 is refused; it must be a number from 0.001 to 1000 (m)");
    EXPECT_THAT(error_of(start + "thickness_m = -2\n"), StartsWith(line(5) + "release[0].thickness_m = -2 is refused"));
    EXPECT_THAT(error_of(start + "volume_m3 = 0\n"), StartsWith(line(5) + "release[0].volume_m3 = 0 is refused"));
}

TEST_F(ParseScene, missing_keys_are_named) {
    EXPECT_EQ(error_of("[[release]]\nfile = \"r.gpkg\"\nthickness_m = 2\n"),
              file() + ": terrain.file is missing; it must be a file path in quotes");
    EXPECT_EQ(error_of("\n[terrain]\nband = 1\n[[release]]\nfile = \"r.gpkg\"\n"),
              line(2) + "terrain.file is missing; it must be a file path in quotes");
    EXPECT_EQ(error_of("[terrain]\nfile = \"dem.tif\"\n[[release]]\nthickness_m = 2\n"),
              line(3) + "release[0].file is missing; it must be a file path in quotes, or thickness_raster be given");
    EXPECT_THAT(error_of("[terrain]\nfile = \"dem.tif\"\n"),
                EndsWith("there is no [[release]] and no [[inflow]]; a scene needs at least one"));
    EXPECT_THAT(error_after("[[observation]]\nchainage_m = 3\n"),
                StartsWith(line(6) + "observation[0].front_velocity_mps: exactly one of front_velocity_mps, "
                                     "debris_speed_mps must be given; there is none"));
    EXPECT_THAT(error_of(""), HasSubstr("terrain.file is missing"));
    EXPECT_THAT(error_of("[terrain]\nfile = \"\"\n"), EndsWith("not empty"));
}

TEST_F(ParseScene, exactly_one_source_of_thickness) {
    const std::string start = "[terrain]\nfile = \"dem.tif\"\n[[release]]\nfile = \"r.gpkg\"\n";
    EXPECT_EQ(error_of(start), line(4) +
                                   "release[0].file: exactly one of thickness_m, thickness_attribute, "
                                   "thickness_raster, volume_m3 must be given; there is none");
    EXPECT_THAT(error_of(start + "thickness_m = 1\nvolume_m3 = 600\n"),
                AllOf(StartsWith(line(6)), EndsWith("given are thickness_m, volume_m3")));
}

TEST_F(ParseScene, one_section_or_several) {
    EXPECT_EQ(error_of("[terrain]\nfile = \"dem.tif\"\n[release]\nfile = \"r.gpkg\"\n"),
              line(3) + "there can be several of release; write [[release]]");
    EXPECT_EQ(error_of("[[terrain]]\nfile = \"dem.tif\"\n"), line(1) + "terrain must be one section; write [terrain]");
    EXPECT_THAT(error_of("terrain = 3\n"), StartsWith(line(1) + "terrain must be one section"));
    EXPECT_THAT(error_of("release = [1]\n"), StartsWith(line(1) + "release must be sections"));
}

TEST_F(ParseScene, toml_errors_name_the_line) {
    EXPECT_THAT(error_after("[solver]\nend_time_s = 1\nend_time_s = 2\n"),
                AllOf(StartsWith(line(8) + "not valid TOML: "), HasSubstr("end_time_s")));
    EXPECT_THAT(error_after("[terrain]\n"), StartsWith(line(6) + "not valid TOML: "));
    EXPECT_THAT(error_after("[solver\n"), StartsWith(line(6) + "not valid TOML: "));
    EXPECT_THAT(error_after("[solver]\nend_time_s = \n"), StartsWith(line(7) + "not valid TOML: "));
    EXPECT_THAT(error_after("[solver]\nend_time_s = 1m\n"), StartsWith(line(7) + "not valid TOML: "));
    EXPECT_THAT(error_after("[solver]\nkernel = \"spi\n"), StartsWith(line(7) + "not valid TOML: "));
    EXPECT_THAT(error_of("[[[[[[[[[[[\n"), StartsWith(line(1) + "not valid TOML: "));
}

TEST_F(ParseScene, values_that_contradict_each_other_are_named) {
    EXPECT_EQ(error_after("[solver]\nsmallest_time_step_s = 0.1\n"),
              line(7) +
                  "solver.smallest_time_step_s = 0.1 is refused; smallest_time_step_s = 0.1 must not be above "
                  "largest_time_step_s = 0.016666666666666666");
    EXPECT_EQ(error_after("start_time_s = 120\n"),
              line(6) + "release[0].start_time_s = 120 is refused; it must be below solver.end_time_s = 120");
}

TEST_F(ParseScene, unreadable_files_are_named) {
    const auto error = [](const std::string& name) { return parse_scene(name).error().message; };
    EXPECT_EQ(error(path("absent.toml")), path("absent.toml") + ": no such scene file");
    EXPECT_THAT(error(folder.string()), HasSubstr("is a folder, not a scene file"));
    EXPECT_EQ(error_of("[terrain]\nfile = \"d\xe9m.tif\"\n"), line(2) + "not UTF-8 text; save the scene file as UTF-8");
    EXPECT_THAT(error_of(std::string("\xff\xfe[\0t\0", 6)), StartsWith(line(1) + "not UTF-8"));
    EXPECT_THAT(error("/dev/zero"), HasSubstr("/dev/zero: is a pipe, a socket or a device; it must be a file"));
    write("large.toml", std::string(17 << 20, ' '));
    EXPECT_THAT(error(path("large.toml")), HasSubstr("larger than 16 MB"));
}

TEST_F(ParseScene, a_byte_order_mark_and_windows_line_ends_are_fine) {
    const params::SceneSpec spec =
        parsed("\xef\xbb\xbf[terrain]\r\nfile = \"dem.tif\"\r\n[[release]]\r\nfile = \"r\"\r\nthickness_m = 2\r\n");
    EXPECT_EQ(spec.releases.size(), 1U);
}

TEST_F(ParseScene, every_truncation_of_a_scene_is_one_line_or_parses) {
    const std::string whole =
        minimal + "[scene]\ntitle = \"\xc3\xa4\\u00e4\"\nsources = [\"a\", 'b']\n[solver]\nkernel = 'spiky'\n";
    for (std::size_t length = 0; length < whole.size(); ++length) {
        const std::string message = error_of(whole.substr(0, length));
        EXPECT_TRUE(message == "(it parsed)" || message.rfind(file(), 0) == 0) << length << ": " << message;
    }
}

TEST_F(ParseScene, paths_are_taken_from_the_scenes_folder_and_the_environment) {
    setenv("TALUS_TEST_DATA", "/somewhere", 1);
    unsetenv("TALUS_TEST_ABSENT");
    const std::string rest = "[[release]]\nfile = \"sub/../r.gpkg\"\nvolume_m3 = 600\n";
    const params::SceneSpec spec = parsed("[terrain]\nfile = \"${TALUS_TEST_DATA}/dem.tif\"\n" + rest);
    EXPECT_EQ(spec.terrain.file, "/somewhere/dem.tif");
    EXPECT_EQ(spec.releases.at(0).file, path("r.gpkg"));
    EXPECT_EQ(error_of("[terrain]\nfile = \"${TALUS_TEST_ABSENT}/dem.tif\"\nobtain = \"ask the survey\"\n" + rest),
              line(2) +
                  "terrain.file = \"${TALUS_TEST_ABSENT}/dem.tif\" needs the environment variable "
                  "TALUS_TEST_ABSENT, which is not set; to obtain the file: ask the survey");
    const std::string long_text(1000, 'o');
    EXPECT_THAT(error_of("[terrain]\nfile = \"${TALUS_TEST_ABSENT}\"\nobtain = \"" + long_text + "\"\n" + rest),
                EndsWith(long_text));
    EXPECT_THAT(error_of("[terrain]\nfile = \"${TALUS\"\n" + rest), HasSubstr("\"${\" without \"}\""));
    EXPECT_EQ(parsed("[terrain]\nfile = 'NETCDF:\"a.nc\":z'\n" + rest).terrain.file, "NETCDF:\"a.nc\":z");
}

TEST_F(ParseScene, overrides_replace_values) {
    const params::SceneSpec spec = parsed(
        minimal + "[[release]]\nfile = \"b\"\nvolume_m3 = 5\n",
        {"solver.particle_spacing_m=0.25", "solver.kernel=spiky", "release[1].volume_m3=7", "terrain.file=other.tif",
         "scene.title=A = B", "scene.sources=[\"x\"]", "scene.reconstruction=true", "terrain.extent_m=[0,0,10,20]",
         "release[0].thickness_m=none", "release[0].volume_m3=600", "material.viscosity=5e-2"});
    EXPECT_EQ(spec.solver.particle_spacing, 0.25);
    EXPECT_EQ(spec.solver.kernel, params::KernelChoice::spiky);
    EXPECT_EQ(spec.releases.at(1).volume, 7.0);
    EXPECT_EQ(spec.terrain.file, path("other.tif"));
    EXPECT_EQ(spec.scene.title, "A = B");
    EXPECT_EQ(spec.scene.sources, std::vector<std::string>{"x"});
    EXPECT_TRUE(spec.scene.reconstruction);
    EXPECT_EQ(spec.terrain.extent->y_max, 20);
    EXPECT_FALSE(spec.releases.at(0).thickness.has_value());
    EXPECT_EQ(spec.releases.at(0).volume, 600.0);
    EXPECT_EQ(spec.material.viscosity, 0.05);
}

TEST_F(ParseScene, overrides_are_checked_like_the_file) {
    const auto error = [&](const std::string& text) { return error_after("", {text}); };
    EXPECT_EQ(error("material.viscosity=2"),
              "--set material.viscosity=2: material.viscosity = 2 is refused; it must be a number from 0 to below 1");
    EXPECT_EQ(
        error("material.viscosity=much"),
        "--set material.viscosity=much: material.viscosity = much is refused; it must be a number from 0 to below 1");
    EXPECT_EQ(error("material.viscocity=0"),
              "--set material.viscocity=0: unknown key \"viscocity\" in [material]; nearest known key: viscosity");
    EXPECT_THAT(error("materia.viscosity=0"), HasSubstr("nearest known section: material"));
    EXPECT_THAT(error("viscosity=0"), HasSubstr("must read section.key=value"));
    EXPECT_THAT(error("material.viscosity"), HasSubstr("must read section.key=value"));
    EXPECT_THAT(error("release[1].volume_m3=3"), HasSubstr("say which: release[0]"));
    EXPECT_THAT(error("release[-1].volume_m3=3"), HasSubstr("say which: release[0]"));
    EXPECT_THAT(error("release[x.volume_m3=3"), HasSubstr("must read section[0].key=value"));
    EXPECT_THAT(error("observation.chainage_m=3"), HasSubstr("the scene has no [[observation]]"));
    EXPECT_THAT(error("solver[0].end_time_s=3"), HasSubstr("leave out the index"));
    EXPECT_THAT(error("terrain.file="), HasSubstr("not empty"));
    EXPECT_THAT(error("solver.end_time_s=1\nkernel='spiky'"), HasSubstr("is refused"));
    EXPECT_THAT(error("material.viscosity=none"), HasSubstr("is refused"));
    EXPECT_THAT(error("release.volume_m3=3"),
                AllOf(StartsWith("--set release.volume_m3=3: "), HasSubstr("given are thickness_m, volume_m3")));
}

TEST_F(ParseScene, a_written_scene_parses_to_the_same_values) {
    params::SceneSpec spec;
    spec.scene.title = "A \"title\"\nof two lines \xc3\xa4";
    spec.scene.assumptions = {"first, with comma", "second"};
    spec.terrain.file = path("dem.tif");
    spec.terrain.extent = Extent{1.1, 2.2, 3.3, 4.4};
    spec.releases.resize(2);
    spec.releases[0].file = path("a.gpkg");
    spec.releases[0].thickness = 1.0 / 3;
    spec.releases[1].file = path("b.gpkg");
    spec.releases[1].volume = 600;
    spec.releases[1].start_time = 12.5;
    spec.solver.time_step = 0.1 + 0.2;
    spec.solver.kernel = params::KernelChoice::poly6_spiky;
    spec.observations.resize(1);
    spec.observations[0].chainage = 121;
    spec.observations[0].front_velocity = 11;
    const params::SceneSpec again = parsed(write_scene(spec, "A header\nof two lines."));
    std::vector<std::string> before, after;
    const auto collect = [](std::vector<std::string>& into) {
        return [&into](const params::Section& s, std::size_t index, const params::Parameter& p,
                       const params::ParameterValue& value) {
            into.push_back(key_path(s, index, p) + " = " + params::toml_text(value));
        };
    };
    for_each_value(spec, collect(before));
    for_each_value(again, collect(after));
    EXPECT_EQ(before, after);
}

TEST_F(ParseScene, every_commented_default_of_a_written_scene_is_valid) {
    params::SceneSpec spec;
    spec.terrain.file = "dem.tif";
    spec.releases.resize(1);
    spec.releases[0].file = "release.gpkg";
    spec.releases[0].thickness = 2;
    std::istringstream lines(write_scene(spec));
    // Of these, one of several keys must be given, or one that has no default.
    const std::set<std::string> with_a_choice = {"bed",
                                                 "zone",
                                                 "inflow",
                                                 "barrier",
                                                 "barrier_opening",
                                                 "gauge",
                                                 "cross_section",
                                                 "zoom",
                                                 "trigger",
                                                 "alarm",
                                                 "observation",
                                                 "superelevation",
                                                 "arrival",
                                                 "run_up",
                                                 "deposit_depth",
                                                 "damage",
                                                 "observed_run_out",
                                                 "deposit_outline",
                                                 "affected_area",
                                                 "elevation_change",
                                                 "variant",
                                                 "option",
                                                 "risk_scenario",
                                                 "exposure"};
    std::string text, current, section;
    while (std::getline(lines, current)) {
        const bool commented_header = current.starts_with("# [") && current.ends_with(']');  // no line of prose
        if (commented_header || current.starts_with('[')) {
            const std::size_t from = current.find_first_not_of("# [");
            section = current.substr(from, current.find(']') - from);
        }
        if (with_a_choice.contains(section)) continue;
        const bool is_default =
            commented_header || (current.rfind("# ", 0) == 0 && current.find(" = ") != std::string::npos &&
                                 current.find_first_of(" =", 2) == current.find(" = "));
        // The release has a thickness, and particle_spacing_m is one of three keys of which no two may be given, as
        // laminar viscosity is one of two. A key without a default has none to try.
        const bool excluded = current.find("thickness") != std::string::npos ||
                              current.find("volume") != std::string::npos || current.starts_with("# target_") ||
                              current.starts_with("# laminar_viscosity_Pas") ||
                              current.find(" = none") != std::string::npos;
        text += (is_default && !excluded ? current.substr(2) : current) + "\n";
    }
    EXPECT_THAT(text, HasSubstr("\nviscosity = 0.1\n"));
    parsed(text);
}

}  // namespace
}  // namespace talus::scene
