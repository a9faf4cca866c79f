#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "core/try.hpp"
#include "core/utf8.hpp"
#include "geo/mesh_faces.hpp"

namespace talus::geo {
namespace {

class ObjReader {
  public:
    explicit ObjReader(std::string file) : file_(std::move(file)) {}

    Result<std::vector<MeshBuilding>> read(const std::string& text) {
        std::istringstream in(text);
        for (std::string line; std::getline(in, line);) {
            ++line_;
            std::istringstream words(line);
            std::string word;
            if (!(words >> word)) continue;
            if (word == "v") {
                TALUS_TRY(read_vertex(words));
            } else if (word == "f") {
                TALUS_TRY(read_face(words));
            } else if (word == "o" || word == "g") {
                TALUS_TRY(close_building());
                name_.clear();
                std::getline(words >> std::ws, name_);
                name_ = to_utf8(name_);
                while (!name_.empty() && (name_.back() == '\r' || name_.back() == ' ')) name_.pop_back();
            }
        }
        TALUS_TRY(close_building());
        if (buildings_.empty()) return Error{file_ + ": has no faces; it is no OBJ file, or an empty one"};
        return std::move(buildings_);
    }

  private:
    [[nodiscard]] Error at_line(const std::string& what) const {
        return Error{fmt::format("{}:{}: {}", file_, line_, what)};
    }

    Status read_vertex(std::istringstream& words) {
        WorldPoint p;
        if (!(words >> p.x >> p.y >> p.z) || !std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
            return at_line("a vertex needs three finite numbers");
        }
        vertices_.push_back(p);
        return {};
    }

    Status read_face(std::istringstream& words) {
        std::vector<WorldPoint> ring;
        for (std::string corner; words >> corner;) {
            std::istringstream number(corner.substr(0, corner.find('/')));
            long long index = 0;
            const auto count = static_cast<long long>(vertices_.size());
            if (!(number >> index) || !number.eof() || index == 0 || index > count || index < -count) {
                return at_line(fmt::format("a face names vertex {}; there are {} so far", corner.substr(0, 40), count));
            }
            ring.push_back(vertices_[static_cast<std::size_t>(index > 0 ? index - 1 : count + index)]);
            if (ring.size() > max_face_corners) {
                return at_line(fmt::format("a face has more than {} corners", max_face_corners));
            }
        }
        if (ring.size() < 3) return at_line("a face needs three vertices or more");
        if (++face_count_ > max_mesh_faces) {
            return at_line(fmt::format(
                "there are more than {} faces; simplify the mesh or cut out what the terrain covers", max_mesh_faces));
        }
        faces_.push_back({std::move(ring)});
        return {};
    }

    Status close_building() {
        if (faces_.empty()) return {};
        MeshBuilding building;
        building.name = name_.empty() ? fmt::format("building {}", buildings_.size() + 1) : name_;
        auto roofs = find_roofs(faces_);
        if (!roofs) return Error{fmt::format("{}: \"{}\" {}", file_, building.name, roofs.error().message)};
        building.roofs = std::move(*roofs);
        buildings_.push_back(std::move(building));
        faces_.clear();
        return {};
    }

    std::string file_, name_;
    std::size_t line_ = 0, face_count_ = 0;
    std::vector<WorldPoint> vertices_;
    std::vector<MeshFace> faces_;
    std::vector<MeshBuilding> buildings_;
};

}  // namespace

Result<std::vector<MeshBuilding>> read_obj(const std::string& file) {
    TALUS_ASSIGN(const std::string text, read_mesh_text(file));
    return ObjReader(file).read(text);
}

}  // namespace talus::geo
