#include <array>
#include <cmath>

#include <nlohmann/json.hpp>

#include "geo/gltf_file.hpp"
#include "products/view_fixture.hpp"
#include "support/value_of.hpp"

namespace talus::products {
namespace {

using Json = nlohmann::json;

/// The scale of a node at a time of the animation, as a player steps through it; that of the node where it has none.
double scale_at(const geo::GltfFile& file, std::size_t node, double time) {
    const Json& animation = file.root()["animations"][0];
    for (const Json& channel : animation["channels"]) {
        if (channel["target"]["node"] != node || channel["target"]["path"] != "scale") continue;
        const Json& sampler = animation["samplers"][channel["sampler"].get<std::size_t>()];
        EXPECT_EQ(sampler["interpolation"], "STEP");
        const auto keys = file.accessor(sampler["input"]), scales = file.accessor(sampler["output"]);
        EXPECT_EQ(keys->count, scales->count);
        std::size_t key = 0;
        while (key + 1 < keys->count && keys->at(key + 1, 0) <= time) ++key;
        for (std::size_t k = 1; k < keys->count; ++k) EXPECT_GT(keys->at(k, 0), keys->at(k - 1, 0));
        return scales->at(key, 0);
    }
    const Json& scale = geo::gltf_member(*file.entry("nodes", node), "scale");
    return scale.is_array() ? scale[0].get<double>() : 1;
}

std::vector<std::string> seen_at(const geo::GltfFile& file, double time) {
    std::vector<std::string> names;
    for (std::size_t node = 0; node < file.root()["nodes"].size(); ++node) {
        if (scale_at(file, node, time) == 1) names.push_back(file.root()["nodes"][node]["name"]);
    }
    return names;
}

class GlbOfARun : public ViewOfARun {
  protected:
    geo::GltfFile open() {
        const Status status = write({"gltf"});
        EXPECT_TRUE(status.ok()) << status.error().message;
        return test::value_of(geo::GltfFile::open(file("run.glb")));
    }
    static geo::GltfAccessor attribute(const geo::GltfFile& file, std::size_t mesh, const char* name) {
        return *file.accessor(file.root()["meshes"][mesh]["primitives"][0]["attributes"][name]);
    }
};

TEST_F(GlbOfARun, shows_one_frame_of_the_debris_at_a_time_and_the_deposit_last) {
    const geo::GltfFile glb = open();
    const auto with = [](const char* frame) { return std::vector<std::string>{"terrain", "structures", frame}; };
    EXPECT_EQ(seen_at(glb, 0), with("debris at 0 s"));
    EXPECT_EQ(seen_at(glb, 0.99), with("debris at 0 s"));
    EXPECT_EQ(seen_at(glb, 1), with("debris at 1 s"));
    EXPECT_EQ(seen_at(glb, 2.4), with("debris at 1 s"));
    EXPECT_EQ(seen_at(glb, 2.5), with("debris at 2.5 s"));
    EXPECT_EQ(seen_at(glb, 4.4), with("debris at 2.5 s")) << "held before the animation begins again";
    std::vector<std::string> at_rest;
    for (const Json& node : glb.root()["nodes"]) {
        if (!node.contains("scale") || node["scale"][0] == 1) at_rest.push_back(node["name"]);
    }
    EXPECT_EQ(at_rest, with("debris at 2.5 s")) << "programs that play no animation show the deposit";
}

TEST_F(GlbOfARun, lays_debris_on_the_ground_and_houses_in_it) {
    const geo::GltfFile glb = open();
    const LocalFrame& frame = scene.terrain.frame();
    const auto ground_below = [&](double x, double z) {
        return scene.terrain.elevation_at({frame.origin.x + x, frame.origin.y - z}) - frame.origin.z;
    };
    const auto ground = attribute(glb, 0, "POSITION");
    for (std::size_t i = 0; i < ground.count; i += 997) {
        EXPECT_NEAR(ground.at(i, 1), ground_below(ground.at(i, 0), ground.at(i, 2)), 1e-3) << "y is up, z south";
    }
    const auto debris = attribute(glb, 2, "POSITION");
    std::size_t deep = 0;
    for (std::size_t i = 0; i < debris.count; ++i) {
        const double above = debris.at(i, 1) - ground_below(debris.at(i, 0), debris.at(i, 2));
        EXPECT_TRUE(std::abs(above) < 1e-3 || std::abs(above - 2.05) < 1e-3) << above;
        deep += above > 1 ? 1 : 0;
    }
    EXPECT_EQ(deep, 16U) << "4 x 4 cells";
    const auto colours = attribute(glb, 2, "COLOR_0");
    EXPECT_EQ(colours.count, debris.count);

    const auto normals = attribute(glb, 1, "NORMAL");
    double highest = -1e9;
    const auto walls = attribute(glb, 1, "POSITION");
    for (std::size_t i = 0; i < walls.count; ++i) {
        EXPECT_NEAR(std::hypot(normals.at(i, 0), normals.at(i, 1), normals.at(i, 2)), 1, 1e-5);
        highest = std::max(highest, walls.at(i, 1));
    }
    double roof = -1e9;
    for (const terrain::Building& building : scene.buildings) roof = std::max(roof, building.roof_elevation);
    EXPECT_NEAR(highest, roof - frame.origin.z, 1e-3);
    EXPECT_EQ(walls.count, 5 * (4 * 6 + 6)) << "five houses of four walls and a roof";
}

TEST_F(GlbOfARun, faces_are_seen_from_outside) {
    const geo::GltfFile glb = open();
    for (std::size_t mesh = 0; mesh < glb.root()["meshes"].size(); ++mesh) {
        const auto points = attribute(glb, mesh, "POSITION"), normals = attribute(glb, mesh, "NORMAL");
        const auto corners = *glb.accessor(glb.root()["meshes"][mesh]["primitives"][0]["indices"]);
        ASSERT_EQ(corners.count % 3, 0U);
        for (std::size_t c = 0; c < corners.count; c += 3) {
            std::array<Vec3<double>, 3> p;
            Vec3<double> normal{};
            for (std::size_t k = 0; k < 3; ++k) {
                const auto i = static_cast<std::size_t>(corners.at(c + k, 0));
                ASSERT_LT(i, points.count);
                p[k] = {points.at(i, 0), points.at(i, 1), points.at(i, 2)};
                normal += Vec3<double>{normals.at(i, 0), normals.at(i, 1), normals.at(i, 2)};
            }
            const Vec3<double> a = p[1] - p[0], b = p[2] - p[0];
            const Vec3<double> turn{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
            ASSERT_GT(dot(turn, normal), 0) << "mesh " << mesh << ", corner " << c;
            if (mesh != 1) continue;
            const WorldPoint& origin = scene.terrain.frame().origin;
            const Vec3<double> out = (p[0] + p[1] + p[2]) + 0.1 * normal;  // three times a place before the wall
            for (const terrain::Building& building : scene.buildings) {
                if (normals.at(static_cast<std::size_t>(corners.at(c, 0)), 1) > 0.5) break;  // a roof
                ASSERT_FALSE(contains(building.footprint[0], {origin.x + out.x / 3, origin.y - out.z / 3}));
            }
        }
    }
}

TEST_F(GlbOfARun, states_its_shift_and_its_bounds) {
    const geo::GltfFile glb = open();
    const Json& about = glb.root()["asset"]["extras"];
    EXPECT_DOUBLE_EQ(about["origin_m"][0], scene.terrain.frame().origin.x);
    EXPECT_EQ(about["reference_system"], scene.crs.label());
    EXPECT_EQ(about["title"], scene.spec.scene.title);
    for (const Json& accessor : glb.root()["accessors"]) {
        if (!accessor.contains("min")) continue;
        const auto values = *glb.accessor(static_cast<std::size_t>(&accessor - &glb.root()["accessors"][0]));
        for (std::size_t k = 0; k < values.width; ++k) {
            double low = 1e9, high = -1e9;
            for (std::size_t i = 0; i < values.count; ++i) {
                low = std::min(low, values.at(i, k));
                high = std::max(high, values.at(i, k));
            }
            EXPECT_FLOAT_EQ(accessor["min"][k].get<float>(), static_cast<float>(low));
            EXPECT_FLOAT_EQ(accessor["max"][k].get<float>(), static_cast<float>(high));
        }
    }
}

TEST_F(GlbOfARun, tileset_places_it_on_the_globe) {
    scene.spec.outputs.geoid_height = -2.5;
    const Status status = write({"3dtiles"});
    ASSERT_TRUE(status.ok()) << status.error().message;
    const Json root = Json::parse(test::read_text(file("tileset.json")))["root"];
    EXPECT_TRUE(std::filesystem::exists(file(root["content"]["uri"])));
    const Json& m = root["transform"];
    ASSERT_EQ(m.size(), 16U);
    for (const std::size_t k : {3U, 7U, 11U}) EXPECT_EQ(m[k], 0);
    EXPECT_EQ(m[15], 1);
    // The valley lies in Hong Kong: 114.06 degrees east, 22.37 north.
    const double x = m[12], y = m[13], z = m[14], degree = std::acos(-1.0) / 180;
    EXPECT_NEAR(std::atan2(y, x) / degree, 114.06, 0.01);
    EXPECT_NEAR(std::asin(m[10].get<double>()) / degree, 22.37, 0.01);
    // Its height above the ellipsoid, from the point below on the equatorial radius (TR8350.2).
    const double latitude = std::asin(m[10].get<double>()), s = std::sin(latitude);
    const double height = std::hypot(x, y) / std::cos(latitude) - 6378137.0 / std::sqrt(1 - 6.69437999014e-3 * s * s);
    EXPECT_NEAR(height, scene.terrain.frame().origin.z - 2.5, 1e-3);
    (void)z;

    const auto glb = geo::GltfFile::open(file("run.glb"));
    ASSERT_TRUE(glb);
    const Json& box = root["boundingVolume"]["box"];
    for (const Json& accessor : glb->root()["accessors"]) {
        if (!accessor.contains("min") || accessor["type"] != "VEC3") continue;
        // y up turned to z up.
        EXPECT_LE(box[0].get<double>() - box[3].get<double>(), accessor["min"][0].get<double>());
        EXPECT_GE(box[0].get<double>() + box[3].get<double>(), accessor["max"][0].get<double>());
        EXPECT_LE(box[1].get<double>() - box[7].get<double>(), -accessor["max"][2].get<double>());
        EXPECT_GE(box[1].get<double>() + box[7].get<double>(), -accessor["min"][2].get<double>());
        EXPECT_LE(box[2].get<double>() - box[11].get<double>(), accessor["min"][1].get<double>() + 1e-3);
        EXPECT_GE(box[2].get<double>() + box[11].get<double>(), accessor["max"][1].get<double>() - 1e-3);
    }
}

}  // namespace
}  // namespace talus::products
