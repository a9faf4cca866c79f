#include "geo/overlay.hpp"

#include <functional>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "core/temporary_folder.hpp"
#include "geo/clip.hpp"
#include "geo/layer_style.hpp"
#include "geo/vector.hpp"

namespace talus::geo {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

/// 100 m x 100 m in the Hong Kong 1980 grid.
class OverlayTest : public ::testing::Test {
  protected:
    void SetUp() override {
        auto crs = crs_from_text("EPSG:2326");
        ASSERT_TRUE(crs) << crs.error().message;
        ground_ = {*crs, {820000, 825000, 820100, 825100}};
    }
    std::string write(const std::vector<Field>& fields, const std::vector<OutputFeature>& features,
                      const std::string& layer = "roads") {
        const std::string file = (folder_.path() / "layers.gpkg").string();
        const Status written = write_geopackage_layer(file, layer, fields, features, ground_.crs);
        EXPECT_TRUE(written) << written.error().message;
        return file;
    }
    Result<std::vector<VectorOverlay>> read(const std::string& file, const LayerSymbols& symbols = {}) const {
        return read_vector_overlays(file, {symbols}, ground_, limits_);
    }
    static OutputFeature line(std::vector<PlanPoint> points, std::vector<Attribute> values = {}) {
        return {{}, std::move(points), std::move(values)};
    }

    TemporaryFolder folder_;
    OverlayGround ground_;
    OverlayLimits limits_;
};

TEST_F(OverlayTest, a_line_is_cut_to_the_terrain_and_told_from_its_corner) {
    const auto made = read(write({{"NAME", true}, {"lanes", false}},
                                 {line({{819950, 825050}, {820050, 825050}}, {std::string("Route 7"), 2.0}),
                                  line({{830000, 825050}, {830050, 825050}}, {std::string("elsewhere"), 1.0})}));
    ASSERT_TRUE(made) << made.error().message;
    ASSERT_EQ(made->size(), 1U);
    EXPECT_EQ(made->front().name, "roads");
    EXPECT_EQ(made->front().features, 1U);
    EXPECT_EQ(made->front().outside, 1U);
    EXPECT_FALSE(made->front().styled);
    const json feature = json::parse(made->front().json)["features"][0];
    EXPECT_EQ(feature["kind"], "line");
    EXPECT_EQ(feature["name"], "Route 7");
    EXPECT_EQ(feature["attributes"], json({{"lanes", 2.0}}));
    EXPECT_EQ(feature["parts"], json::parse("[[0.0, 50.0, 50.0, 50.0]]"));
    EXPECT_EQ(feature["style"], -1);
    EXPECT_TRUE(check_overlay_text(made->front().json, limits_));
}

TEST_F(OverlayTest, an_area_with_a_hole_keeps_both_rings) {
    const Polygon area{{{820010, 825010}, {820090, 825010}, {820090, 825090}, {820010, 825090}},
                       {{{820040, 825040}, {820040, 825060}, {820060, 825060}, {820060, 825040}}}};
    const auto made = read(write({}, {{{area}, {}, {}}}, "parcels"));
    ASSERT_TRUE(made) << made.error().message;
    const json feature = json::parse(made->front().json)["features"][0];
    EXPECT_EQ(feature["kind"], "area");
    EXPECT_EQ(feature["parts"].size(), 2U);
}

TEST_F(OverlayTest, degrees_are_brought_to_the_terrain) {
    const std::string file = (folder_.path() / "degrees.gpkg").string();
    const auto wgs84 = crs_from_text("EPSG:4326");
    ASSERT_TRUE(wgs84);
    // Near 820050 E, 825050 N.
    ASSERT_TRUE(write_geopackage_layer(file, "points", {}, {line({{114.017, 22.37}})}, *wgs84));
    ground_.extent = {800000, 800000, 850000, 850000};
    const auto made = read(file);
    ASSERT_TRUE(made) << made.error().message;
    EXPECT_THAT(made->front().note, HasSubstr("EPSG:4326"));
    const json at = json::parse(made->front().json)["features"][0]["parts"][0];
    EXPECT_NEAR(at[0].get<double>(), 20000, 2000);
    EXPECT_NEAR(at[1].get<double>(), 25000, 3000);
}

TEST_F(OverlayTest, what_lies_elsewhere_or_is_too_much_is_refused_in_one_sentence) {
    const std::string file = write({}, {line({{1, 1}, {2, 2}})});
    const auto elsewhere = read(file);
    ASSERT_FALSE(elsewhere);
    EXPECT_THAT(elsewhere.error().message, HasSubstr("outside the terrain: none of its 1 features"));
    const std::string two = write({}, {line({{820001, 825001}}), line({{820002, 825001}})}, "many");
    limits_.features = 1;
    const auto many = read(two);
    ASSERT_FALSE(many);
    EXPECT_THAT(many.error().message, HasSubstr("layer \"many\" has more than 1 features"));
}

TEST_F(OverlayTest, a_file_of_more_layers_than_a_session_can_have_is_refused_before_all_are_read) {
    const std::string file = write({}, {line({{820001, 825001}, {820050, 825001}})}, "first");
    write({}, {line({{820001, 825002}, {820050, 825002}})}, "second");
    const auto within = [&](const OverlayFileLimits& together) {
        return read_vector_overlays(file, {}, ground_, limits_, together);
    };
    const auto both = within({.layers = 2, .bytes = 10'000});
    ASSERT_TRUE(both) << both.error().message;
    ASSERT_EQ(both->size(), 2U) << "the second layer is beside the first";
    for (const OverlayFileLimits& less : {OverlayFileLimits{1, 10'000}, OverlayFileLimits{2, 150}}) {
        const auto many = within(less);
        ASSERT_FALSE(many);
        EXPECT_THAT(many.error().message, HasSubstr(fmt::format("has more than {} layers", less.layers)));
    }
}

TEST_F(OverlayTest, simplestyle_and_symbols_by_value_give_styles) {
    const std::string file =
        write({{"kind", true}, {"stroke", true}, {"stroke-width", false}},
              {line({{820001, 825001}, {820050, 825001}}, {std::string("main"), Attribute(), Attribute()}),
               line({{820001, 825002}, {820050, 825002}}, {std::string("other"), std::string("#F80"), 5.0}),
               line({{820001, 825003}, {820050, 825003}}, {std::string("none"), Attribute(), Attribute()})});
    LayerSymbols symbols;
    symbols.attribute = "kind";
    symbols.values["main"].stroke = "#112233";
    const auto made = read(file, symbols);
    ASSERT_TRUE(made) << made.error().message;
    EXPECT_TRUE(made->front().styled);
    const json whole = json::parse(made->front().json);
    const auto style = [&](int k) { return whole["styles"][whole["features"][k]["style"].get<std::size_t>()]; };
    EXPECT_EQ(style(0)["stroke"], "#112233");
    EXPECT_EQ(style(1)["stroke"], "#ff8800");
    EXPECT_EQ(style(1)["width_px"], 5.0);
    EXPECT_EQ(whole["features"][2]["style"], -1);
    EXPECT_EQ(whole["features"][1]["attributes"], json({{"kind", "other"}})) << "a style is no datum";
}

TEST(LayerStyle, reads_simple_symbols_of_either_version_of_qml) {
    const LayerSymbols one = read_qml(
        R"(<qgis><renderer-v2 type="singleSymbol"><symbols><symbol name="0" type="fill" alpha="0.5"><layer class="SimpleFill">
           <Option type="Map"><Option name="color" value="10,20,30,255" type="QString"/>
           <Option name="outline_color" value="255,0,0,255,rgb:1,0,0,1" type="QString"/>
           <Option name="outline_width" value="1" type="QString"/></Option></layer></symbol></symbols></renderer-v2></qgis>)");
    ASSERT_EQ(one.values.size(), 1U);
    const FeatureStyle& style = one.values.at("");
    EXPECT_EQ(style.fill, "#0a141e");
    EXPECT_EQ(style.stroke, "#ff0000");
    EXPECT_DOUBLE_EQ(style.fill_opacity, 0.5);
    EXPECT_NEAR(style.width_px, 3.78, 0.01);

    const LayerSymbols several = read_qml(
        R"(<qgis><renderer-v2 type="categorizedSymbol" attr="&quot;class&quot;"><categories>
           <category value="a" symbol="0"/><category value="b" symbol="1"/></categories><symbols>
           <symbol name="0" type="line"><layer class="SimpleLine"><prop k="line_color" v="1,2,3,128"/></layer></symbol>
           <symbol name="1" type="line"><layer class="ArrowLine"/></symbol></symbols></renderer-v2></qgis>)");
    EXPECT_EQ(several.attribute, "class");
    ASSERT_EQ(several.values.size(), 1U) << "what is not simple is left out";
    EXPECT_EQ(several.values.at("a").stroke, "#010203");
    EXPECT_NEAR(several.values.at("a").stroke_opacity, 0.5, 0.01);
}

TEST(LayerStyle, hostile_qml_gives_nothing) {
    EXPECT_TRUE(read_qml("").empty());
    EXPECT_TRUE(read_qml("<qgis><renderer-v2").empty());
    EXPECT_TRUE(read_qml("<!DOCTYPE q [<!ENTITY a SYSTEM 'file:///etc/passwd'>]><qgis>&a;</qgis>").empty());
    EXPECT_TRUE(read_qml(std::string(3'000'000, 'x')).empty());
    const LayerSymbols odd = read_qml(
        R"(<qgis><renderer-v2 type="singleSymbol"><symbols><symbol name="0"><layer class="SimpleLine">
           <prop k="line_color" v="999,0,0"/><prop k="line_width" v="1e300"/></layer></symbol></symbols></renderer-v2></qgis>)");
    ASSERT_EQ(odd.values.size(), 1U);
    EXPECT_EQ(odd.values.at("").stroke, "");
    EXPECT_LE(odd.values.at("").width_px, 20);
}

TEST(OverlayText, of_a_saved_session_is_checked) {
    const OverlayLimits limits;
    const auto good = [] {
        return json{{"styles", json::array()},
                    {"features",
                     {{{"kind", "line"},
                       {"parts", {{0, 0, 1, 1}}},
                       {"name", ""},
                       {"attributes", json::object()},
                       {"style", -1}}}}};
    };
    EXPECT_TRUE(check_overlay_text(good().dump(), limits));
    const auto refused = [&](const std::function<void(json&)>& spoil) {
        json text = good();
        spoil(text);
        return !check_overlay_text(text.dump(), limits);
    };
    EXPECT_TRUE(refused([](json& t) { t["features"][0]["kind"] = "script"; }));
    EXPECT_TRUE(refused([](json& t) { t["features"][0]["parts"][0].push_back(1); }));
    EXPECT_TRUE(refused([](json& t) { t["features"][0]["parts"][0][1] = "x"; }));
    EXPECT_TRUE(refused([](json& t) { t["features"][0]["style"] = 0; }));
    EXPECT_TRUE(refused([](json& t) { t["features"][0]["style"] = 18446744073709551615U; })) << "-1 once it wraps";
    EXPECT_TRUE(refused([](json& t) { t["features"][0]["style"] = -1.0; })) << "no whole number";
    EXPECT_TRUE(refused([](json& t) { t["features"][0]["name"] = "a\u202Eb"; }));
    EXPECT_TRUE(refused([](json& t) { t["features"][0]["attributes"]["a\u2066"] = 1; }));
    EXPECT_TRUE(refused([](json& t) { t["features"][0]["attributes"]["a"] = "\u001B[2J"; }));
    EXPECT_FALSE(refused([](json& t) { t["features"][0]["attributes"]["a"] = "Route\n7"; }));
    EXPECT_TRUE(refused([](json& t) { t["features"][0]["attributes"]["a"] = json::array(); }));
    EXPECT_TRUE(refused([](json& t) { t["styles"].push_back({{"stroke", "red"}}); }));
    EXPECT_TRUE(refused([](json& t) { t["features"] = json::array(); }));
    EXPECT_TRUE(refused([](json& t) { t["more"] = 1; }));
}

TEST(Clip, cuts_lines_into_the_parts_inside) {
    const Extent box{0, 0, 10, 10};
    const auto parts = clip_line({{-5, 5}, {5, 5}, {5, 15}, {7, 15}, {7, 5}}, box);
    ASSERT_EQ(parts.size(), 2U);
    EXPECT_EQ(parts[0], (std::vector<PlanPoint>{{0, 5}, {5, 5}, {5, 10}}));
    EXPECT_EQ(parts[1], (std::vector<PlanPoint>{{7, 10}, {7, 5}}));
    EXPECT_TRUE(clip_line({{-5, -5}, {-1, -1}}, box).empty());
}

TEST(Clip, a_ring_around_the_rectangle_becomes_it) {
    const Extent box{0, 0, 10, 10};
    const Ring around = clip_ring({{-100, -100}, {100, -100}, {100, 100}, {-100, 100}}, box);
    EXPECT_DOUBLE_EQ(plan_area({around, {}}), 100);
    EXPECT_DOUBLE_EQ(plan_area({clip_ring({{5, 5}, {15, 5}, {15, 15}, {5, 15}}, box), {}}), 25);
    EXPECT_TRUE(clip_ring({{20, 20}, {30, 20}, {30, 30}}, box).empty());
}

}  // namespace
}  // namespace talus::geo
