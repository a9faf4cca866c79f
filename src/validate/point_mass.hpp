#pragma once

#include <functional>

/// A point mass that slides along a profile of the ground under gravity and Coulomb friction.
namespace talus::validate {

/// The ground in a vertical plane: elevation, m, and its first and second derivative by the horizontal distance x.
struct ProfilePoint {
    double elevation = 0, slope = 0, bend = 0;
};
using Profile = std::function<ProfilePoint(double x)>;

/// It presses on the ground with g cos t + kappa v^2 (per mass). Where that would be less than 0 it flies, and where it
/// comes down it loses the part of its velocity normal to the ground, and f times as much of the part along the ground:
/// an inelastic impact with Coulomb friction.
class PointMass {
  public:
    /// On the ground at `x`, with `speed` along it towards greater x.
    PointMass(Profile profile, double friction, double gravity, double x, double speed);

    /// Fourth-order Runge-Kutta steps of at most 0.5 ms until `time`, s.
    void advance_to(double time);

    [[nodiscard]] double x() const { return x_; }
    [[nodiscard]] double elevation() const { return z_; }
    [[nodiscard]] double speed() const;
    [[nodiscard]] bool flies() const { return flies_; }
    /// J/kg, lost so far where it came down from flights.
    [[nodiscard]] double landing_loss() const { return landing_loss_; }

  private:
    struct Rates {
        double way, speed;  ///< of x and of the speed along the ground
    };
    [[nodiscard]] double pressing(const ProfilePoint& ground, double speed) const;
    /// `direction`: of the motion that friction opposes, the sign of the speed when the step began.
    [[nodiscard]] Rates rates(double x, double speed, double direction) const;
    void slide(double step);
    void fly(double step);
    void land();

    Profile profile_;
    double friction_, gravity_;
    double time_ = 0, x_, z_, along_, vx_ = 0, vz_ = 0;  // along_ while it slides, vx_ and vz_ while it flies
    double landing_loss_ = 0;
    bool flies_ = false;
};

}  // namespace talus::validate
