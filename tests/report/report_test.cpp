#include <regex>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "params/fields.hpp"
#include "report/chart.hpp"
#include "report/report_fixture.hpp"
#include "report/results.hpp"

namespace talus::report {
namespace {

using ::testing::ElementsAre;

using test::has;
using test::Sample;

TEST(Report, is_one_small_page_that_names_no_other_file) {
    const std::string html = Sample().html();
    EXPECT_LT(html.size(), 3'000'000U);
    EXPECT_FALSE(has(html, "http://"));
    EXPECT_FALSE(has(html, "https://"));
    EXPECT_FALSE(has(html, "@import"));
    EXPECT_FALSE(has(html, "{{"));
    for (std::size_t at = 0; (at = html.find("src=\"", at)) != std::string::npos; ++at) {
        EXPECT_EQ(html.compare(at + 5, 5, "data:"), 0) << html.substr(at, 60);
    }
    for (std::size_t at = 0; (at = html.find("href=\"", at)) != std::string::npos; ++at) {
        EXPECT_TRUE(html.compare(at + 6, 5, "data:") == 0 || html[at + 6] == '#') << html.substr(at, 60);
    }
}

TEST(Report, escapes_every_text_of_the_scene) {
    Sample s;
    const std::string evil = "<script>alert('1')</script>\"&";
    s.scene.spec.scene.title = evil + "title";
    s.scene.spec.scene.description = evil + "description";
    s.scene.spec.scene.assumptions = {evil + "assumption"};
    s.scene.spec.scene.sources = {evil + "source"};
    s.scene.spec.observations[0].name = evil;
    s.scene.spec.observations[0].source = evil;
    s.scene.spec.releases[0].name = evil;
    s.scene.spec.terrain.file = evil;
    s.scene.releases[0].name = evil;
    s.scene.notes = {evil + "note"};
    s.scene.inputs[0] = {evil, evil, 1, evil};
    s.scene.crs.name = evil;
    s.scene.vertical_unit = evil;
    s.result.status = run::RunStatus::fault;
    s.result.stop_reason = evil;
    for (std::size_t i = 0; i < s.scene.buildings.size(); ++i) {
        s.scene.buildings[i].name = s.result.observation.buildings[i].name = evil;
    }
    const std::string html = s.html();
    EXPECT_FALSE(has(html, "<script>alert"));
    EXPECT_FALSE(has(html, "\"&title"));
    EXPECT_TRUE(has(html, "&lt;script&gt;alert(&apos;1&apos;)&lt;/script&gt;&quot;&amp;title"));
    for (const char* place : {"description", "assumption", "source", "note"}) {
        EXPECT_TRUE(has(html, std::string("&quot;&amp;") + place));
    }
}

TEST(Report, says_what_still_moved_at_the_end) {
    Sample s;
    observe::TimeSample& end = s.result.observation.timeseries.back();
    end.volume_moving = 12;
    end.volume_deposited = 588;
    end.largest_speed = 3.21;
    EXPECT_TRUE(has(s.html(), "12.0 m³ (2.00 % of the debris), at up to 3.2 m/s"));
    const Json moving = still_moving(s.result);
    EXPECT_EQ(moving["volume_m3"], 12);
    EXPECT_EQ(moving["share_percent"], 2);
    EXPECT_EQ(moving["greatest_speed_mps"], 3.21);
    end.volume_moving = 0;
    EXPECT_TRUE(has(s.html(), "nothing faster than 0.1 m/s"));
    EXPECT_EQ(still_moving(s.result)["greatest_speed_mps"], 0);
}

TEST(Report, a_brace_in_a_title_is_not_taken_for_a_template) {
    Sample s;
    s.scene.spec.scene.title = "{{style}}";
    EXPECT_TRUE(has(s.html(), "<h1>{{style}}</h1>"));
}

TEST(Report, says_reconstruction_on_the_page_and_on_every_map) {
    Sample s;
    const std::string with = s.html();
    EXPECT_TRUE(has(with, "banner reconstruction"));
    EXPECT_TRUE(has(with, ">RECONSTRUCTION</text>"));
    EXPECT_TRUE(has(with, "\"Reconstruction, not surveyed\""));
    s.scene.spec.scene.reconstruction = false;
    const std::string without = s.html();
    EXPECT_FALSE(has(without, "banner reconstruction"));
    EXPECT_FALSE(has(without, "RECONSTRUCTION"));
}

TEST(Report, says_partial_with_its_reason) {
    Sample s;
    EXPECT_FALSE(has(s.html(), "class=\"banner partial\""));
    s.result.status = run::RunStatus::fault;
    s.result.stop_reason = "compression 0.6 above compression_limit 0.5 at 12.3 s";
    const std::string html = s.html();
    EXPECT_TRUE(has(html, "class=\"banner partial\""));
    EXPECT_TRUE(has(html, "compression 0.6 above compression_limit 0.5 at 12.3 s"));
    s.result.status = run::RunStatus::interrupted;
    EXPECT_TRUE(has(s.html(), "was interrupted"));
}

/// What the page says, without its style and script, its maps' numbers and the titles of columns' keys.
std::string words_of(const std::string& html) {
    std::string text;
    bool tag = false;
    for (std::size_t i = 0; i < html.size(); ++i) {
        for (const char* skipped : {"style", "script"}) {
            if (html.compare(i, 1 + std::string(skipped).size(), std::string("<") + skipped) != 0) continue;
            i = html.find(std::string("</") + skipped, i);
        }
        if (html[i] == '<') tag = true;
        if (!tag) text += html[i];
        if (html[i] == '>') tag = false;
    }
    return text;
}

TEST(Report, has_one_verdict_beside_its_key_figures) {
    Sample s;
    const std::string good = s.html();
    EXPECT_TRUE(has(good, "<span class=\"status complete\">complete</span>"));
    EXPECT_TRUE(has(good, "<dl class=\"verdict-box\">"));
    EXPECT_FALSE(has(good, "BEYOND"));
    EXPECT_TRUE(has(words_of(good), "Convergence. Not tested; talus run --convergence"));
    observe::Compression& c = s.result.observation.compression;
    c.worst_overcompressed_share = 0.031;
    c.worst_overcompressed_time = 12.3;
    c.time_share_above = 0.25;
    const std::string html = s.html();
    EXPECT_TRUE(has(html, "BEYOND LIMITS: COMPRESSION")) << "on the maps";
    const std::size_t verdict = html.find("<dl class=\"verdict-box beyond\">");
    ASSERT_NE(verdict, std::string::npos);
    EXPECT_LT(html.find("<h2>Key results"), verdict);
    EXPECT_LT(verdict, html.find("<dl class=\"cards\">"));
    for (const char* part : {"<span class=\"status beyond\">complete, beyond limits: compression</span>",
                             "<dd class=\"beyond\"><b>Compression.</b> Debris too compressed during 25 % of the "
                             "simulated time</dd>",
                             "by more than 3&nbsp;% in up to 3.1&nbsp;% of the particles (at 12.3 s; limit 1&nbsp;%)",
                             "<code>solver.extra_iteration_count</code> (now 12)", "solver.displacement_limit"}) {
        EXPECT_TRUE(has(html, part)) << part;
    }
    s.scene.spec.solver.time_step = 0.01;
    EXPECT_TRUE(has(s.html(), "lower <code>solver.time_step_s</code>"));
}

TEST(Report, of_a_depth_averaged_run_says_nothing_that_only_particles_have) {
    Sample s;
    s.scene.spec.observations[0].source = s.scene.spec.observations[1].source = "";
    const std::string particles = words_of(s.html());
    for (const char* part : {"particle", "ompression", "position-based", "overcompressed", "averaged over 0.2"}) {
        EXPECT_TRUE(has(particles, part)) << part;
    }
    s.scene.spec.solver.model = params::ModelChoice::depth_averaged;
    s.scene.spec.solver.particle_spacing.reset();
    s.scene.spec.material.turbulent_friction = 470;
    s.result.grid_cell = 2.5;
    s.result.observation.compression = {};
    s.result.stage_times = {};
    terrain::Building dam = s.scene.buildings.back();
    dam.barrier.emplace();
    s.scene.buildings.push_back(dam);
    s.result.observation.buildings.push_back(s.result.observation.buildings[0]);
    s.result.observation.buildings.back().is_barrier = true;
    std::string words = words_of(s.html());
    // Keys keep the help that they have for either model.
    const std::size_t keys = words.find("The keys that were set"), rest = words.find("Inputs and computation");
    ASSERT_TRUE(keys < rest && rest != std::string::npos);
    words.erase(keys, rest - keys);
    for (const char* named : {"solver.model = \"particles\"", "the particle model"}) {
        for (std::size_t at = 0; (at = words.find(named)) != std::string::npos;)
            words.erase(at, std::string(named).size());
    }
    for (const char* part : {"article", "ompression", "position-based", "overcompressed", "iteration", "kernel",
                             "Kernel", "Friction inside", "Held"}) {
        const std::size_t at = words.find(part);
        EXPECT_EQ(at, std::string::npos) << (at == std::string::npos ? "" : words.substr(at < 80 ? 0 : at - 80, 160));
    }
    s.scene.spec.material.turbulent_friction.reset();
    s.scene.spec.material.samosat = true;
    const std::string snow = words_of(s.html());
    EXPECT_TRUE(has(snow, "Sampl & Granig 2009") || has(snow, "Sampl &amp; Granig 2009"));
    EXPECT_TRUE(has(snow, "R_s0 = 0.222, κ = 0.43, R = 0.05 m, B = 4.13"));
    EXPECT_FALSE(has(snow, "Voellmy 1955"));
    for (const char* part : {"cells are 2.5 m wide", "Speed of the flow", "ξ = 470 m/s²", "HLL", "Voellmy 1955",
                             "averaged over 0.2", "Over the crest", "Retained at the end"}) {
        EXPECT_TRUE(has(words, part)) << part;
    }
}

TEST(Report, of_a_depth_averaged_run_says_whether_debris_flies) {
    Sample s;
    s.scene.spec.solver.model = params::ModelChoice::depth_averaged;
    s.result.grid_cell = 2.5;
    EXPECT_TRUE(has(words_of(s.html()), "Debris does not leave the ground"));
    s.scene.spec.solver.flight = true;
    const std::string words = words_of(s.html());
    EXPECT_TRUE(has(words, "lands by an impulse"));
    EXPECT_FALSE(has(words, "does not leave the ground"));
}

TEST(Report, says_that_debris_left_the_part_of_the_terrain_that_a_scene_takes) {
    Sample s;
    s.result.observation.run_out.at_least = true;
    s.scene.spec.terrain.extent.reset();
    EXPECT_TRUE(has(s.html(), "; debris left the terrain"));
    s.scene.spec.terrain.extent = Extent{0, 0, 100, 100};
    EXPECT_TRUE(
        has(s.html(), "; debris left the part of the terrain that terrain.extent_m takes; a larger part shows"));
    EXPECT_FALSE(has(s.html(), "; debris left the terrain"));
}

TEST(Report, missing_volume_is_not_called_closed) {
    Sample s;
    EXPECT_TRUE(has(s.html(), "<strong>closed</strong>"));
    s.result.observation.timeseries.back().volume_deposited -= 0.25;
    const std::string html = s.html();
    EXPECT_FALSE(has(html, "<strong>closed</strong>"));
    EXPECT_TRUE(has(html, "<strong>0.250</strong> <span class=\"unit\">m³ missing</span>"));
    EXPECT_TRUE(has(html, "<b class=\"bad\">; 0.250 m³ missing</b>"));
}

TEST(Report, compares_the_front_with_each_observation) {
    Sample s;
    s.result.observation.front = {{120, 14, 10, 9}, {122, 14.2, 12, 10}};
    const std::string html = s.html();
    EXPECT_TRUE(has(html, "<b>11.0</b>"));         // between the two samples
    EXPECT_TRUE(has(html, "<b>not reached</b>"));  // 217 m lies beyond
}

TEST(Report, lists_buildings_by_pressure_and_marks_assumed_heights) {
    Sample s;
    const report::Json buildings = report::buildings(s.scene, s.result);
    std::vector<std::string> names;
    for (const auto& row : buildings["table"]["rows"]) names.push_back(row["name"]["value"]);
    ASSERT_EQ(names.size(), 3U) << "those that were not hit are not listed";
    EXPECT_THAT(names, ElementsAre(testing::HasSubstr("House 38"), "House 12", "House 21A"));
    EXPECT_TRUE(has(s.html(), "6.0<sup>a</sup>"));
}

TEST(Report, says_when_no_building_was_hit) {
    Sample s;
    for (observe::BuildingImpact& b : s.result.observation.buildings) b.hit = false;
    EXPECT_TRUE(has(s.html(), "No building was hit."));
}

TEST(Report, shows_thirty_of_many_buildings_and_counts_the_rest) {
    Sample s;
    s.scene.buildings.clear();
    s.result.observation.buildings.clear();
    for (int i = 0; i < 45; ++i) {
        observe::BuildingImpact b;
        b.name = "house number " + std::to_string(i);
        b.hit = true;
        b.peak_impact_pressure = 1000.0 * i;
        s.result.observation.buildings.push_back(b);
    }
    const report::Json buildings = report::buildings(s.scene, s.result);
    EXPECT_EQ(buildings["shown"], 30);
    EXPECT_EQ(buildings["hit"], 45);
    EXPECT_EQ(buildings["table"]["rows"].size(), 30U);
    EXPECT_EQ(buildings["table"]["rows"].back()["name"]["value"], "house number 15");
    EXPECT_TRUE(has(s.html(), "first 30 of 45 buildings"));
}

TEST(Report, prints_every_parameter_with_its_unit) {
    Sample s;
    const std::string html = s.html();
    for (const params::Section& section : params::scene_sections()) {
        // Observations have a table of their own; of kinds that the scene lacks there is nothing to print.
        if (section.name == "scene" || section.name == "report" || section.name == "observation" ||
            section.count(s.scene.spec) == 0)
            continue;
        for (const params::Parameter& parameter : section.parameters) {
            const bool other = parameter.use == params::KeyUse::depth_averaged;
            EXPECT_NE(has(html, "<code>" + parameter.key + "</code>"), other) << parameter.key;
        }
    }
    EXPECT_TRUE(has(html, "0.1 per 1/60 s"));
    EXPECT_TRUE(has(html, "0.310 m²/s"));
}

/// Whether the page's figures are numbered from 1 up, none twice.
void expect_numbered_figures(const std::string& html) {
    int count = 0;
    for (std::size_t at = 0; (at = html.find("<b>Figure ", at)) != std::string::npos; ++at) {
        EXPECT_EQ(std::atoi(html.c_str() + at + 10), ++count);
    }
    EXPECT_GT(count, 5);
}

TEST(Report, draws_zones_and_bed_with_their_values_where_there_are_some) {
    Sample sample;
    const std::string without = sample.html();
    EXPECT_FALSE(has(without, "id=\"zones\""));
    expect_numbered_figures(without);
    params::ZoneSpec rough, forest;
    rough.name = "rough <gully>";
    rough.friction_coefficient = 0.37;
    rough.turbulent_friction = 450;
    forest.name = "forest";
    forest.stem_density = 0.08;
    forest.stem_diameter = 0.35;
    sample.scene.spec.zones = {rough, forest};
    params::BedSpec bed;
    bed.name = "colluvium";
    bed.depth = 1.5;
    bed.growth_rate = 0.006;
    sample.scene.spec.beds = {bed};
    const std::size_t cells = sample.scene.terrain.elevation().values.size();
    sample.scene.zone_at.assign(cells, 1);
    std::fill(sample.scene.zone_at.begin(), sample.scene.zone_at.begin() + static_cast<std::ptrdiff_t>(cells / 2), 2);
    sample.scene.bed.materials.resize(1);
    sample.scene.bed.material_at.assign(cells, 1);
    const std::string html = sample.html();
    for (const char* part : {"id=\"zones\"", "rough &lt;gully&gt;", "friction 0.37", "ξ 450 m/s²", "0.08 stems/m²",
                             "0.35 m thick", "colluvium", "1.5 m deep", "growth 0.006 per m",
                             "Petryk &amp; Bosmajian 1975", "Zones of the ground and bed.</b>"}) {
        EXPECT_TRUE(has(html, part)) << part;
    }
    expect_numbered_figures(html);
}

TEST(Report, draws_the_density_of_an_inflow_where_it_has_one) {
    Sample sample;
    sample.scene.inflows.push_back({"torrent", {0, 0}, {3, 0}, {{0, 5, 2}, {10, 5, 2}}});
    std::string html = sample.html();
    EXPECT_TRUE(has(html, "torrent, across a line: 50.0 m³"));
    EXPECT_FALSE(has(html, "density, kg/m³"));
    expect_numbered_figures(html);
    terrain::Inflow rain{"scarp", {}, {}, {{0, 5, 2, 1500}, {10, 5, 2, 1700}}};
    rain.area.push_back({{{0, 0}, {20, 0}, {20, 10}, {0, 10}}, {}});
    sample.scene.inflows.push_back(rain);
    html = sample.html();
    EXPECT_TRUE(has(html, "scarp, over 200 m², down the slope: 50.0 m³"));
    EXPECT_TRUE(has(html, "80.0 t, ") && has(html, "600 kg/m³ on average"));
    EXPECT_TRUE(has(html, "density, kg/m³"));
    EXPECT_TRUE(has(html, "Their motion does not depend on it."));
}

TEST(Report, marks_inflows_on_its_maps_with_an_arrow_where_debris_goes) {
    Sample sample;
    const Extent ground = sample.scene.terrain.elevation().geometry.extent();
    const double x = (ground.x_min + ground.x_max) / 2, y = (ground.y_min + ground.y_max) / 2;
    EXPECT_FALSE(has(sample.html(), R"(class="inflow")"));
    // Northwards: to its right is the east, to the right on the page.
    sample.scene.inflows.push_back({"torrent", {x, y}, {x, y + 2}, {{0, 5, 2}, {10, 5, 2}}});
    const std::string html = sample.html();
    const std::regex mark(
        R"re(class="inflow" d="M([\d.]+) ([\d.]+)L([\d.]+) ([\d.]+)M\S+ \S+?L([\d.]+) ([\d.]+)M.*?<title>torrent)re");
    std::smatch found;
    ASSERT_TRUE(std::regex_search(html, found, mark));
    const auto number = [&](std::size_t k) { return std::stod(found[k]); };
    EXPECT_NEAR(number(1), number(3), 0.11);
    EXPECT_GT(number(2), number(4)) << "north is up";
    EXPECT_NEAR(number(5), number(1) + 16, 0.21) << "the tip";
    EXPECT_TRUE(has(html, ">Inflow</text>"));
}

TEST(Report, renders_a_run_in_which_nothing_moved) {
    Sample s;
    s.scene.buildings.clear();
    s.scene.spec.observations.clear();
    s.scene.flow_path = terrain::FlowPath();
    s.result.observation = observe::Observation();
    s.result.status = run::RunStatus::interrupted;
    const std::string html = s.html();
    EXPECT_TRUE(has(html, "No debris reached the flow path"));
    EXPECT_TRUE(has(html, "no debris mapped"));
    for (const char* nan : {">nan", " nan", "\"nan", "Lnan", "Mnan"}) EXPECT_FALSE(has(html, nan)) << nan;
}

TEST(Report, draws_the_discharge_through_cross_sections_over_time) {
    Sample s;
    EXPECT_FALSE(has(s.html(), "<h2>Cross-sections</h2>"));
    observe::DischargeRecord bridge{.section = {"bridge", {{824200, 825550}, {824220, 825550}}}};
    bridge.rows = {{1, 4, 4}, {2, 12.5, 16.5}};
    bridge.peak_discharge = 12.5;
    bridge.peak_time = 2;
    bridge.passed = 16.5;
    s.result.observation.cross_sections = {bridge, {.section = {"ford", {{824210, 825560}, {824230, 825560}}}}};
    const std::string page = words_of(s.html());
    for (const char* part : {"bridge", "ford", "12.50", "16.5", "nothing passed"}) EXPECT_TRUE(has(page, part)) << part;
    const report::Json of_one = report::cross_sections({{"", &s.result}});
    ASSERT_EQ(of_one["chart"]["plots"].size(), 2U) << "discharge and volume of the section that debris passed";
    EXPECT_EQ(of_one["table"]["rows"].size(), 2U);
    EXPECT_TRUE(of_one["not_drawn"].is_null());
    const report::Json both = report::cross_sections({{"particles", &s.result}, {"depth-averaged", &s.result}});
    EXPECT_EQ(both["table"]["rows"].size(), 4U);
    EXPECT_EQ(both["table"]["rows"][1]["model"], "depth-averaged");
    s.result.observation.cross_sections.assign(14, bridge);
    EXPECT_EQ(report::cross_sections({{"", &s.result}})["not_drawn"], 2U);
    s.result.observation.cross_sections = {{.section = {"ford", {{824210, 825560}, {824230, 825560}}}}};
    EXPECT_TRUE(has(words_of(s.html()), "No debris passed a cross-section."));
}

TEST(Report, draws_depth_and_speed_at_gauges_over_time) {
    Sample s;
    EXPECT_FALSE(has(s.html(), "<h2>Gauges</h2>"));
    observe::GaugeRecord gully{.gauge = {"gully", {824200, 825550}, 121}};
    gully.arrival_time = 12.5;
    gully.peak_depth = 1.75;
    gully.peak_depth_time = 14;
    gully.peak_speed = 6.5;
    gully.peak_speed_time = 13;
    gully.rows = {{0, 0, 0}, {12.5, 0.5, 6.5}, {14, 1.75, 4}, {20, 0.2, 0.1}};
    s.result.observation.gauges = {gully, {.gauge = {"mill", {824210, 825560}}}};
    const std::string html = s.html(), words = words_of(html);
    for (const char* part : {"<h2>Gauges</h2>", "chainage 121 m", "210.0 E 825", "560.0 N", "not reached"}) {
        EXPECT_TRUE(has(html, part)) << part;
    }
    for (const char* part : {"1.75", "14.0", "6.5", "Depth and speed at gauges over time"}) {
        EXPECT_TRUE(has(words, part)) << part;
    }
    const report::Json results = report::run_results(s.scene, s.result, {});
    const auto& plots = results["gauges"]["chart"]["plots"];
    ASSERT_EQ(plots.size(), 2U) << "depth and speed of the gauge that debris reached";
    EXPECT_EQ(plots[0]["curves"][0]["y"].size(), 4U);
    const report::Json both = report::gauges({{"particles", &s.result}, {"depth-averaged", &s.result}});
    EXPECT_EQ(both["table"]["rows"].size(), 4U);
    EXPECT_EQ(both["table"]["rows"][1]["model"], "depth-averaged");
    EXPECT_EQ(both["chart"]["plots"][0]["curves"].size(), 2U);
    EXPECT_EQ(both["chart"]["plots"][0]["curves"][1]["name"], "depth-averaged");
    s.result.observation.gauges.erase(s.result.observation.gauges.begin());
    EXPECT_TRUE(has(words_of(s.html()), "No debris reached a gauge."));
}

TEST(Report, says_what_a_zoom_was_and_its_balance) {
    Sample s;
    EXPECT_FALSE(has(s.html(), "<h2>Zoom</h2>"));
    run::ZoomRecord zoom;
    zoom.around = "House 1";
    zoom.area = {{{824100, 825500}, {824140, 825500}, {824140, 825530}, {824100, 825530}}, {}};
    zoom.surroundings = 5;
    zoom.event_volume = 600;
    zoom.particle_spacing = 0.3;
    zoom.thickness = 1.2;
    zoom.grid_cell = 2.5;
    zoom.simulated_time = 60;
    zoom.volumes = {.in = 161, .out = 113.5, .sampled_in = 166.8, .sampled_out = 109.7};
    zoom.pieces = 4;
    zoom.brought_volume = 160.9;
    zoom.momentum = {-3e6, 4e6};
    zoom.brought_momentum = {-3e6, 4.1e6};
    zoom.discharge.assign(400, 0);
    std::fill(zoom.discharge.begin() + 300, zoom.discharge.end(), 16.1);
    s.result.zoom = zoom;
    s.result.observation.gauges = {{.gauge = {"mill", {824210, 825560}}}, {.gauge = {"door", {824120, 825510}}}};
    const report::Json rows = report::run_results(s.scene, s.result, {})["gauges"]["table"]["rows"];
    EXPECT_EQ(rows[0]["arrival_s"], "outside the zoom");
    EXPECT_TRUE(rows[1]["arrival_s"].is_null());
    run::RunResult nearby = s.result;
    nearby.observation.front.clear();
    for (const auto& row : report::run_results(s.scene, nearby, {})["observations"]["rows"]) {
        EXPECT_EQ(row["computed_mps"], "outside the zoom");
    }
    const std::string words = words_of(s.html());
    for (const char* part : {"the surroundings of House 1 only", "40 × 30 m around House 1", "from 30.0 s on",
                             "4.0 particles", "not fed back", "outside the zoom", "but for what comes in", "161.0",
                             "160.9", "5000.0", "166.8 m³ in", "600 m³ came into the zoom"}) {
        EXPECT_TRUE(has(words, part)) << part;
    }
}

TEST(Results, hold_all_that_the_report_shows) {
    Sample s;
    s.result.observation.gauges = {{.gauge = {"mill", {824210, 825560}}, .peak_depth = 1}};
    s.result.zoom.emplace();
    s.result.zoom->particle_spacing = 0.3;
    s.result.zoom->simulated_time = 60;
    s.result.zoom->area = {{{824100, 825500}, {824140, 825500}, {824140, 825530}}, {}};
    const report::Json results = report::run_results(s.scene, s.result, test::sample_comparisons(s.scene, s.result));
    EXPECT_EQ(results["format"], "talus results");
    EXPECT_EQ(results["version"], report::results_version);
    int tables = 0, charts = 0;
    expect_documented(results, tables, charts);
    EXPECT_GE(tables, 6);
    EXPECT_GE(charts, 4);
    for (const auto& figure : results["key_figures"]) EXPECT_FALSE(figure["name"].get<std::string>().empty());
    EXPECT_EQ(results["key_figures"][0]["value"], s.result.observation.volume_released);

    const auto page = report::run_report(s.scene, s.result, results);
    const auto again = report::run_report(s.scene, s.result, report::Json::parse(results.dump()));
    ASSERT_TRUE(page.ok() && again.ok());
    EXPECT_TRUE(*page == *again) << "the page shows what results.json holds, also after it was written and read";
}

}  // namespace
}  // namespace talus::report
