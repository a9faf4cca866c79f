#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "products/triangle_mesh.hpp"

namespace talus::products {

/// A glTF 2.0 file in the binary container (Khronos Group 2021, ISO/IEC 12113): y up, and so x east, z south.
class Glb {
  public:
    /// `about`: what a reader finds in the file's asset.
    Glb(const std::string& title, const std::string& program, nlohmann::ordered_json about);

    struct Material {
        std::string name;
        report::Colour colour;  ///< multiplied with those of the mesh
        double roughness = 1;
        bool double_sided = false;
    };
    /// Its number.
    std::size_t add(const Material& material);

    /// A node with a mesh; an empty mesh gives none. Colours are sRGB.
    void add(const std::string& name, const TriangleMesh& mesh, std::size_t material);

    /// A node that is seen from one time to another, s, of an animation that runs from 0 to `end`. `at_rest`: also seen
    /// by programs that play none.
    struct Showing {
        double from = 0, to = 0, end = 0;
        bool at_rest = false;
    };
    void add(const std::string& name, const TriangleMesh& mesh, std::size_t material, const Showing& showing);

    [[nodiscard]] Status write(const std::filesystem::path& file) const;

  private:
    template <class T>
    std::size_t add_accessor(const std::vector<T>& values, int component, const char* type, int target);
    void animate(std::size_t node, const Showing& showing);

    nlohmann::ordered_json root_;
    std::string bytes_;
};

}  // namespace talus::products
