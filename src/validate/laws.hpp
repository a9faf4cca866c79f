#pragma once

#include <vector>

/// Exact solutions and laboratory laws that cases are compared with. SI units, angles in radians.
namespace talus::validate {

/// Run-out of a collapsing column of granular material, (final - initial extent) / initial extent, by its aspect ratio
/// a = height / extent.
/// Axisymmetric (Lube, Huppert, Sparks, Hallworth 2004): 1.24 a for a < 1.7, 1.6 sqrt(a) above.
[[nodiscard]] double column_run_out_axisymmetric(double aspect);
/// Planar (Lube, Huppert, Sparks, Freundt 2005): 1.2 a up to 2.3, 1.9 a^(2/3) above; the source leaves open where
/// between 1.8 and 2.8 the transition is.
[[nodiscard]] double column_run_out_planar(double aspect);

/// Final height of such a column over its initial extent, as measured by two laboratories; equal up to 1.7.
struct ColumnHeights {
    double lajeunesse;  ///< min(a, 0.74) (Lajeunesse, Mangeney-Castelnau, Vilotte 2004)
    double lube;        ///< 0.88 a^(1/6) above 1.7 (Lube 2004)
};
[[nodiscard]] ColumnHeights column_heights_axisymmetric(double aspect);
/// Planar: min(a, a^0.4) (Lube 2005: a^0.4 above 1.15, unchanged below).
[[nodiscard]] double column_height_planar(double aspect);

/// A dam of infinite length breaks on a slope with Coulomb friction (Mangeney, Heinrich, Roche 2000, in the form of
/// Faccanoni & Mangeney 2013, test 2): the debris lies at x < 0 along the slope, `depth` thick, and is released at t =
/// 0. Without slope and friction it is Ritter's (1892).
class DamBreak {
  public:
    DamBreak(double slope, double friction_angle, double depth, double gravity);

    [[nodiscard]] double thickness(double x, double time) const;
    [[nodiscard]] double velocity(double x, double time) const;
    /// End of the undisturbed debris, and end of the debris.
    [[nodiscard]] double back(double time) const;
    [[nodiscard]] double front(double time) const;
    /// Speed of a small wave in the undisturbed debris.
    [[nodiscard]] double wave_speed() const { return wave_speed_; }

  private:
    double depth_, normal_gravity_, acceleration_, wave_speed_;
};

/// A parabolic cap of thickness H (1 - x^2/L^2 - y^2/L^2) slides and spreads on a plane (Savage & Hutter 1989; Hutter,
/// Siegel, Savage, Nohguchi 1993, similarity solution), with earth pressure coefficient 1: no internal friction.
class SpreadingCap {
  public:
    /// `end`: the latest valid time.
    SpreadingCap(double slope, double friction_angle, double length, double height, double gravity, double end);

    /// Thickness at a place along and across the slope, from the cap's centre at t = 0.
    [[nodiscard]] double thickness(double along, double across, double time) const;
    /// Distance that the centre has slid.
    [[nodiscard]] double travelled(double time) const;
    /// Half lengths along and across.
    [[nodiscard]] double half_length(double time) const;
    [[nodiscard]] double half_width(double time) const;

  private:
    struct Shape {
        double along, across;  // g, f: half lengths over the initial ones
    };
    [[nodiscard]] Shape shape_at(double time) const;

    double length_, height_, acceleration_, time_unit_, step_;
    std::vector<Shape> shapes_;
};

/// Thickness over that of the flow when a stream of this Froude number is reflected: the root above 1 of the momentum
/// balance of the jump, (x - 1)(x^2 - 1) = 2 Fr^2 x.
[[nodiscard]] double momentum_jump(double froude);

/// A sheet of uniform thickness in steady flow down a plane: velocity by the height above the ground.
struct SheetFlow {
    double slope, thickness, gravity;

    /// With Coulomb friction, turbulent drag g v^2 / (xi h) (Voellmy 1955; xi = 0: none) and laminar drag 3 nu v / h^2
    /// (Nusselt 1916), the same at every height; 0 where friction holds it.
    [[nodiscard]] double with_drag(double friction, double turbulent_friction, double viscosity) const;
    /// With the friction of samosAT (sim/physics/samosat.hpp), the same at every height: the faster of the two speeds
    /// at which it balances gravity, or the only one; 0 where there is none. `drag`: its stress over rho v^2.
    [[nodiscard]] double with_samosat(double friction, double fluidization, double drag) const;
    /// Of a Bingham fluid that sticks to the ground: sheared below the height at which the shear stress falls to the
    /// yield stress, a plug above. `yield`: stress over density, m2/s2; `viscosity`: kinematic, m2/s.
    [[nodiscard]] double bingham(double height, double yield, double viscosity) const;
    /// Of grains with the mu(I) law on a rough bed (Bagnold's profile in the form of GDR MiDi 2004): constant inertial
    /// number I with mu(I) = tan(slope). `grain`: m; `solid_share`: volume of grains in that of the debris. NaN where
    /// there is no such I: too gentle (no flow) or too steep (never steady).
    [[nodiscard]] double bagnold(double height, double slow_friction, double fast_friction, double half_number,
                                 double grain, double solid_share) const;
};

}  // namespace talus::validate
