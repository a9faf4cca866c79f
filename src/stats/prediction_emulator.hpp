#pragma once

#include <optional>
#include <vector>

#include "stats/emulator.hpp"

namespace talus::stats {

/// Predictions of runs for one observation: whether debris reaches the place at all, and the value if it does. A front
/// that stops in a bend gives no value, not a small one, so a single smooth function over both would invent values in
/// between.
class PredictionEmulator {
  public:
    struct Estimate {
        double reached = 1;  ///< probability
        Emulator::Estimate value;
    };

    /// `values`: one per point, NaN where the run gives none; `unreached` replaces those.
    [[nodiscard]] static PredictionEmulator fit(const Points& points, const std::vector<double>& values,
                                                double unreached);
    /// The same, with the emulator of a faster model's predictions, as Emulator::fit_beside; points may be none.
    [[nodiscard]] static PredictionEmulator fit_beside(const PredictionEmulator& fast, const Points& points,
                                                       const std::vector<double>& values);

    [[nodiscard]] Estimate at(const std::vector<double>& point) const;
    /// Mean of the value, if there is one.
    [[nodiscard]] double mean_at(const std::vector<double>& point) const;
    [[nodiscard]] double reached_at(const std::vector<double>& point) const;
    /// The emulator after an assumed run at this point with the expected result.
    [[nodiscard]] PredictionEmulator believing(const std::vector<double>& point) const;

    [[nodiscard]] double unreached() const { return unreached_; }
    /// Of runs that give a value; none where no run does.
    [[nodiscard]] const std::optional<Emulator>& value() const { return value_; }
    /// The share of runs for which the others predict correctly whether they give a value.
    [[nodiscard]] double reach_told() const;

  private:
    PredictionEmulator() = default;
    [[nodiscard]] static PredictionEmulator fit(const PredictionEmulator* fast, const Points& points,
                                                const std::vector<double>& values, double unreached);
    std::optional<Emulator> value_;
    std::optional<Emulator> reach_;  // of 1 and -1; none where all or no runs give a value
    double unreached_ = 0;
};

}  // namespace talus::stats
