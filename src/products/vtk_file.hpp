#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry.hpp"
#include "core/result.hpp"

namespace talus::products {

/// Points, or triangles between them, with values on them: a file of ParaView's polygonal data (.vtp, VTK XML 1.0).
class VtkPolyData {
  public:
    explicit VtkPolyData(std::vector<float> coordinates) : coordinates_(std::move(coordinates)) {}
    explicit VtkPolyData(const std::vector<LocalPoint>& points);

    /// Values on the points; of several components one point after another.
    template <class T>
    VtkPolyData& on_points(std::string_view name, const std::vector<T>& values, int components = 1) {
        add(on_points_, name, values, components);
        return *this;
    }
    /// Values on the points' cells or the triangles.
    template <class T>
    VtkPolyData& on_cells(std::string_view name, const std::vector<T>& values, int components = 1) {
        add(on_cells_, name, values, components);
        return *this;
    }

    /// The points by themselves. `time`, s, where there is one. `origin`: the file states it as the shift of its
    /// points.
    [[nodiscard]] Status write_points(const std::filesystem::path& file, const WorldPoint& origin,
                                      std::optional<double> time);
    /// Triangles between them.
    [[nodiscard]] Status write_triangles(const std::filesystem::path& file, const WorldPoint& origin,
                                         std::optional<double> time, const std::vector<std::uint32_t>& corners);

  private:
    template <class T>
    void add(std::string& elements, std::string_view name, const std::vector<T>& values, int components);
    [[nodiscard]] Status write(const std::filesystem::path& file, const WorldPoint& origin, std::optional<double> time,
                               const std::string& counts, const std::string& cells);

    std::vector<float> coordinates_;
    std::string on_points_, on_cells_;  ///< elements
    std::string bytes_;                 ///< each array after a 64-bit count of its bytes
};

/// A .pvd: which files of its folder show which times, s.
struct VtkFrame {
    double time = 0;
    std::string file;
};
[[nodiscard]] Status write_vtk_collection(const std::filesystem::path& file, const std::vector<VtkFrame>& frames);

}  // namespace talus::products
