#include "products/glb.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/try.hpp"
#include "products/text_file.hpp"

namespace talus::products {
namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "glTF is little-endian");

// As glTF numbers them.
constexpr int type_u8 = 5121, type_u32 = 5125, type_float = 5126;
constexpr int target_points = 34962, target_corners = 34963, no_target = 0;

using Three = std::array<float, 3>;
using Rgba = std::array<std::uint8_t, 4>;

/// Turns z up into y up.
std::vector<Three> y_up(const std::vector<LocalPoint>& points) {
    std::vector<Three> turned(points.size());
    std::transform(points.begin(), points.end(), turned.begin(), [](const LocalPoint& p) {
        return Three{p.x, p.z, -p.y};
    });
    return turned;
}

/// From sRGB (IEC 61966-2-1) to the linear values that glTF wants.
double linear(std::uint8_t value) {
    const double v = value / 255.0;
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

Rgba linear(const report::Colour& colour) {
    const auto byte = [](std::uint8_t value) { return static_cast<std::uint8_t>(std::lround(255 * linear(value))); };
    return {byte(colour.red), byte(colour.green), byte(colour.blue), 255};
}

void append(std::string& bytes, std::uint32_t number) {
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

}  // namespace

Glb::Glb(const std::string& title, const std::string& program, Json about) {
    root_["asset"] = {{"version", "2.0"}, {"generator", program}, {"extras", std::move(about)}};
    root_["scene"] = 0;
    root_["scenes"] = {{{"name", title}, {"nodes", Json::array()}}};
}

std::size_t Glb::add(const Material& material) {
    Json& all = root_["materials"];
    all.push_back({{"name", material.name},
                   {"doubleSided", material.double_sided},
                   {"pbrMetallicRoughness",
                    {{"baseColorFactor",
                      {linear(material.colour.red), linear(material.colour.green), linear(material.colour.blue), 1.0}},
                     {"metallicFactor", 0.0},
                     {"roughnessFactor", material.roughness}}}});
    return all.size() - 1;
}

template <class T>
std::size_t Glb::add_accessor(const std::vector<T>& values, int component, const char* type, int target) {
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    Json view = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", values.size() * sizeof(T)}};
    if (target != no_target) view["target"] = target;
    root_["bufferViews"].push_back(std::move(view));
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    Json& all = root_["accessors"];
    all.push_back({{"bufferView", root_["bufferViews"].size() - 1},
                   {"componentType", component},
                   {"count", values.size()},
                   {"type", type}});
    return all.size() - 1;
}

void Glb::add(const std::string& name, const TriangleMesh& mesh, std::size_t material) {
    if (mesh.corners.empty()) return;
    const std::vector<Three> points = y_up(mesh.points);
    Three low = points.front(), high = low;
    for (const Three& p : points) {
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    }
    Json attributes = {{"POSITION", add_accessor(points, type_float, "VEC3", target_points)}};
    root_["accessors"].back()["min"] = low;
    root_["accessors"].back()["max"] = high;
    attributes["NORMAL"] = add_accessor(y_up(mesh.normals), type_float, "VEC3", target_points);
    if (!mesh.colours.empty()) {
        std::vector<Rgba> colours(mesh.colours.size());
        std::transform(mesh.colours.begin(), mesh.colours.end(), colours.begin(),
                       [](const report::Colour& colour) { return linear(colour); });
        attributes["COLOR_0"] = add_accessor(colours, type_u8, "VEC4", target_points);
        root_["accessors"].back()["normalized"] = true;
    }
    const std::size_t corners = add_accessor(mesh.corners, type_u32, "SCALAR", target_corners);
    root_["meshes"].push_back(
        {{"name", name},
         {"primitives", Json::array({{{"attributes", attributes}, {"indices", corners}, {"material", material}}})}});
    root_["nodes"].push_back({{"name", name}, {"mesh", root_["meshes"].size() - 1}});
    root_["scenes"][0]["nodes"].push_back(root_["nodes"].size() - 1);
}

void Glb::add(const std::string& name, const TriangleMesh& mesh, std::size_t material, const Showing& showing) {
    if (mesh.corners.empty()) return;
    add(name, mesh, material);
    const double size = showing.at_rest ? 1 : 0;
    root_["nodes"].back()["scale"] = {size, size, size};
    animate(root_["nodes"].size() - 1, showing);
}

void Glb::animate(std::size_t node, const Showing& showing) {
    std::vector<float> times;
    std::vector<Three> scales;
    const auto key = [&](double time, float size) {
        // Times rise: a later state at the same time takes the place of the earlier one.
        if (!times.empty() && static_cast<float>(time) <= times.back()) {
            scales.back() = {size, size, size};
            return;
        }
        times.push_back(static_cast<float>(time));
        scales.push_back({size, size, size});
    };
    key(0, 0);
    key(showing.from, 1);
    if (showing.to < showing.end) key(showing.to, 0);
    key(showing.end, showing.to < showing.end ? 0.F : 1.F);
    Json& animations = root_["animations"];
    if (animations.empty()) {
        animations.push_back({{"name", "run"}, {"channels", Json::array()}, {"samplers", Json::array()}});
    }
    const std::size_t input = add_accessor(times, type_float, "SCALAR", no_target);
    root_["accessors"].back()["min"] = {times.front()};
    root_["accessors"].back()["max"] = {times.back()};
    const std::size_t output = add_accessor(scales, type_float, "VEC3", no_target);
    Json& animation = root_["animations"][0];
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size()}, {"target", {{"node", node}, {"path", "scale"}}}});
    animation["samplers"].push_back({{"input", input}, {"interpolation", "STEP"}, {"output", output}});
}

Status Glb::write(const std::filesystem::path& file) const {
    Json root = root_;
    std::string binary = bytes_;
    binary.resize((binary.size() + 3) / 4 * 4);
    if (!binary.empty()) root["buffers"] = {{{"byteLength", binary.size()}}};
    // Titles come from scene files, which need not be valid UTF-8; JSON is.
    std::string json = root.dump(-1, ' ', false, Json::error_handler_t::replace);
    json.resize((json.size() + 3) / 4 * 4, ' ');
    constexpr std::uint32_t magic = 0x46546C67, version = 2, json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;
    const std::size_t size = 12 + 8 + json.size() + (binary.empty() ? 0 : 8 + binary.size());
    std::string text;
    text.reserve(size);
    for (const std::uint32_t number : {magic, version, static_cast<std::uint32_t>(size)}) append(text, number);
    append(text, static_cast<std::uint32_t>(json.size()));
    append(text, json_chunk);
    text += json;
    if (!binary.empty()) {
        append(text, static_cast<std::uint32_t>(binary.size()));
        append(text, binary_chunk);
        text += binary;
    }
    return write_text_file(file, text);
}

}  // namespace talus::products
