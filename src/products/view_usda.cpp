#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "core/visible_text.hpp"
#include "products/text_file.hpp"
#include "products/view.hpp"
#include "products/writers.hpp"

namespace talus::products {
namespace {

constexpr std::size_t max_points = 1000000;  // of all frames together
constexpr double frames_per_second = 24;

/// Text in quotes; nothing in it ends them.
std::string quoted(const std::string& text) {
    std::string all = "\"";
    for (const char c : visible(text)) {
        if (c == '"' || c == '\\') all += '\\';
        all += c == '\n' || c == '\r' ? ' ' : c;
    }
    return all + '"';
}

/// A name that a prim may have: letters, digits and underscores, not a digit first, none twice.
std::string prim_name(const std::string& name, std::set<std::string>& taken) {
    std::string plain;
    for (const unsigned char c : name) plain += c < 128 && std::isalnum(c) != 0 ? static_cast<char>(c) : '_';
    if (plain.empty() || std::isdigit(static_cast<unsigned char>(plain.front())) != 0) plain.insert(0, "_");
    std::string free = plain;
    for (int k = 2; !taken.insert(free).second; ++k) free = fmt::format("{}_{}", plain, k);
    return free;
}

template <class List, class Write>
std::string list_text(const List& list, const Write& write) {
    std::string text = "[";
    bool first = true;
    for (const auto& entry : list) {
        if (!std::exchange(first, false)) text += ", ";
        write(text, entry);
    }
    return text + "]";
}

void write_point(std::string& text, const LocalPoint& p) {
    fmt::format_to(std::back_inserter(text), "({:.2f}, {:.2f}, {:.2f})", p.x, p.y, p.z);
}

/// displayColor is linear; what is written is near enough to it for a ramp: the square of sRGB.
void write_colour(std::string& text, const report::Colour& colour) {
    const auto value = [](std::uint8_t v) { return (v / 255.0) * (v / 255.0); };
    fmt::format_to(std::back_inserter(text), "({:.3g}, {:.3g}, {:.3g})", value(colour.red), value(colour.green),
                   value(colour.blue));
}

template <class Number>
void write_number(std::string& text, const Number& number) {
    fmt::format_to(std::back_inserter(text), "{}", number);
}

std::string mesh_text(const TriangleMesh& mesh, const report::Colour& colour, const std::string& indent) {
    LocalPoint low = mesh.points.empty() ? LocalPoint{} : mesh.points.front(), high = low;
    for (const LocalPoint& p : mesh.points) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    std::string colour_text;
    write_colour(colour_text, colour);
    const std::vector<int> threes(mesh.corners.size() / 3, 3);
    std::string text;
    for (const std::string& line :
         {std::string("uniform token subdivisionScheme = \"none\""), std::string("uniform bool doubleSided = 1"),
          "float3[] extent = " + list_text(std::array{low, high}, write_point),
          "int[] faceVertexCounts = " + list_text(threes, write_number<int>),
          "int[] faceVertexIndices = " + list_text(mesh.corners, write_number<std::uint32_t>),
          "point3f[] points = " + list_text(mesh.points, write_point),
          "color3f[] primvars:displayColor = [" + colour_text + "]"}) {
        text += indent + line + "\n";
    }
    return text;
}

std::string structures_text(const View& view) {
    std::set<std::string> names;
    std::string text;
    for (const View::Structure& structure : view.structures()) {
        const std::string& name = view.scene.buildings[structure.index].name;
        text += fmt::format("        def Mesh \"{}\"\n        {{\n", prim_name(name, names));
        text += fmt::format("            custom string talus:name = {}\n", quoted(name));
        if (structure.index < view.result.observation.buildings.size()) {
            const observe::BuildingImpact& impact = view.result.observation.buildings[structure.index];
            text += fmt::format("            custom bool talus:hit = {}\n", impact.hit ? 1 : 0);
            text += fmt::format("            custom double talus:peak_impact_pressure_kPa = {:.4g}\n",
                                impact.peak_impact_pressure / 1e3);
        }
        text += mesh_text(structure.mesh, structure.colour, "            ") + "        }\n";
    }
    return text;
}

/// The debris of a frame.
struct Points {
    std::vector<LocalPoint> positions;
    std::vector<float> speeds;
    std::vector<std::uint32_t> ids;  ///< empty: points of a lattice
};

/// Every `nth` particle by its number, so that those of all frames are the same.
Result<Points> particles_of(const ParticleFrames& particles, std::size_t frame, std::size_t nth) {
    TALUS_ASSIGN(auto all, particles.read(frame));
    // Programs pass from one frame to the next point by point.
    std::sort(all.begin(), all.end(), [](const StoredParticle& a, const StoredParticle& b) { return a.id < b.id; });
    Points points;
    for (const StoredParticle& particle : all) {
        if (particle.id % nth != 0) continue;
        points.positions.push_back(particle.position);
        points.speeds.push_back(particle.speed);
        points.ids.push_back(particle.id);
    }
    return points;
}

Result<Points> points_on_surface(const DebrisSurface& surface, std::size_t frame) {
    TALUS_ASSIGN(const DebrisMesh mesh, surface.debris(frame));
    Points points;
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        if (!(mesh.depth[i] > 0)) continue;
        points.positions.push_back(mesh.points[i]);
        points.speeds.push_back(mesh.speed[i]);
    }
    return points;
}

struct Debris {
    std::string positions, colours, ids;  ///< time samples
    std::size_t nth = 1;
};

Result<Debris> debris_samples(const View& view, const ParticleFrames* particles) {
    Debris debris;
    std::size_t all = 0;
    if (particles != nullptr) {
        for (const std::size_t frame : view.surface.animated()) all += particles->count(frame);
        debris.nth = std::max<std::size_t>(1, (all + max_points - 1) / max_points);
    }
    for (const std::size_t frame : view.surface.animated()) {
        TALUS_ASSIGN(const Points points, particles != nullptr ? particles_of(*particles, frame, debris.nth)
                                                               : points_on_surface(view.surface, frame));
        const std::string start = fmt::format("            {:.6g}: ", frames_per_second * view.times[frame]);
        debris.positions += start + list_text(points.positions, write_point) + ",\n";
        debris.colours += start + list_text(view.speed_colours(points.speeds), write_colour) + ",\n";
        if (particles != nullptr) {
            debris.ids += start + list_text(points.ids, write_number<std::uint32_t>) + ",\n";
        }
    }
    return debris;
}

std::string header_text(const View& view) {
    const WorldPoint origin = view.scene.terrain.frame().origin;
    std::string data;
    for (const auto& [key, value] : plain_origin_of(view.scene, view.result)) {
        data += fmt::format("        string {} = {}\n", key, quoted(value));
    }
    data += fmt::format("        string reference_system = {}\n", quoted(view.scene.crs.label()));
    data += fmt::format("        double3 origin_m = ({:.10g}, {:.10g}, {:.10g})\n", origin.x, origin.y, origin.z);
    return fmt::format(
        "#usda 1.0\n(\n    {}\n    customLayerData = {{\n{}    }}\n    defaultPrim = \"Run\"\n"
        "    endTimeCode = {:.6g}\n    framesPerSecond = {}\n    metersPerUnit = 1\n    startTimeCode = 0\n"
        "    timeCodesPerSecond = {}\n    upAxis = \"Z\"\n)\n\n",
        quoted(title_of(view.scene, view.result)), data, frames_per_second * view.times.back(), frames_per_second,
        frames_per_second);
}

}  // namespace

Status write_usda(const View& view, const ParticleFrames* particles, const std::filesystem::path& file) {
    TALUS_ASSIGN(const Debris debris, debris_samples(view, particles));
    // A sphere of a particle's volume; of the grid, what covers a cell.
    const double width = particles != nullptr ? 1.24 * view.result.particle_spacing : view.surface.lattice().cell;
    std::string text = header_text(view) + "def Xform \"Run\" (\n    kind = \"assembly\"\n)\n{\n";
    text +=
        "    def Mesh \"Terrain\"\n    {\n" + mesh_text(view.surface.ground(), ground_colour, "        ") + "    }\n\n";
    text += "    def Xform \"Structures\"\n    {\n" + structures_text(view) + "    }\n\n";
    text += "    def Points \"Debris\"\n    {\n";
    text += fmt::format("        custom double talus:greatest_speed_mps = {:.4g}\n", view.greatest_speed());
    if (particles != nullptr) text += fmt::format("        custom int talus:every_nth_particle = {}\n", debris.nth);
    text += "        point3f[] points.timeSamples = {\n" + debris.positions + "        }\n";
    if (particles != nullptr) text += "        int64[] ids.timeSamples = {\n" + debris.ids + "        }\n";
    text += fmt::format("        float[] widths = [{:.3g}] (\n            interpolation = \"constant\"\n        )\n",
                        width);
    text += "        color3f[] primvars:displayColor (\n            interpolation = \"vertex\"\n        )\n";
    text += "        color3f[] primvars:displayColor.timeSamples = {\n" + debris.colours + "        }\n    }\n}\n";
    return write_text_file(file, text);
}

}  // namespace talus::products
