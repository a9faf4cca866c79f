#pragma once

#include <cmath>
#include <vector>

#include "core/number.hpp"

namespace talus {

/// Three numbers with the usual arithmetic; `Real` is float or Lanes in the solver and double in the reference.
template <class Real>
struct Vec3 {
    Real x{}, y{}, z{};

    TALUS_DEVICE Vec3& operator+=(const Vec3& o) { return *this = *this + o; }
    TALUS_DEVICE Vec3& operator-=(const Vec3& o) { return *this = *this - o; }
    TALUS_DEVICE friend Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    TALUS_DEVICE friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    TALUS_DEVICE friend Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
    TALUS_DEVICE friend Vec3 operator*(Real s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
    TALUS_DEVICE friend Vec3 operator*(const Vec3& a, Real s) { return s * a; }
};

template <class Real>
TALUS_DEVICE Real dot(const Vec3<Real>& a, const Vec3<Real>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class Real>
TALUS_DEVICE Real length(const Vec3<Real>& a) {
    using std::sqrt;
    return sqrt(dot(a, a));
}
template <class Mask, class Real>
TALUS_DEVICE Vec3<Real> select(const Mask& mask, const Vec3<Real>& yes, const Vec3<Real>& no) {
    return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}

/// A position in the solver's frame: metres, float, relative to a LocalFrame.
using LocalPoint = Vec3<float>;

/// A position in the terrain's coordinate reference system: metres east, north and up.
struct WorldPoint {
    double x{}, y{}, z{};
};

/// A plan position in the terrain's coordinate reference system: metres east and north.
struct PlanPoint {
    double x{}, y{};
    bool operator==(const PlanPoint&) const = default;
};

/// Ties the solver's float frame to the world: one double-precision origin, no rotation, no scale.
/// Float coordinates at national-grid magnitudes jitter by centimetres; relative to this origin they do not.
struct LocalFrame {
    WorldPoint origin;

    [[nodiscard]] LocalPoint to_local(const WorldPoint& p) const {
        return {static_cast<float>(p.x - origin.x), static_cast<float>(p.y - origin.y),
                static_cast<float>(p.z - origin.z)};
    }
    [[nodiscard]] WorldPoint to_world(const LocalPoint& p) const {
        return {origin.x + p.x, origin.y + p.y, origin.z + p.z};
    }
};

/// A closed ring without the repeated last point.
using Ring = std::vector<PlanPoint>;

/// An outer ring and its holes, in world plan coordinates.
struct Polygon {
    Ring outer;
    std::vector<Ring> holes;
    bool operator==(const Polygon&) const = default;
};

/// Even-odd test over all rings. A point exactly on an edge may count as inside or outside.
[[nodiscard]] bool contains(const Polygon& polygon, const PlanPoint& point);

/// Plan area in m2, holes subtracted; independent of ring orientation.
[[nodiscard]] double plan_area(const Polygon& polygon);

/// An axis-parallel rectangle in world plan coordinates.
struct Extent {
    double x_min{}, y_min{}, x_max{}, y_max{};

    [[nodiscard]] double width() const { return x_max - x_min; }
    [[nodiscard]] double height() const { return y_max - y_min; }
    [[nodiscard]] bool contains(const PlanPoint& p) const {
        return p.x >= x_min && p.x <= x_max && p.y >= y_min && p.y <= y_max;
    }
    void include(const PlanPoint& p);
    [[nodiscard]] Extent grown(double margin) const {
        return {x_min - margin, y_min - margin, x_max + margin, y_max + margin};
    }
};

[[nodiscard]] Extent extent_of(const Polygon& polygon);

}  // namespace talus
