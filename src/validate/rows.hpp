#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "validate/case.hpp"

namespace talus::validate {

/// What one computation of a case puts into the outcome: rows of the table and notes, all under its name. Most cases
/// are a loop over resolutions or values of such computations.
class Rows {
  public:
    /// Says that the computation comes. `coarse`: as in Measurement.
    Rows(const Watch& watch, Outcome& outcome, std::string name, bool coarse = false)
        : Rows(outcome, std::move(name), coarse) {
        watch.say(name_);
    }
    /// For more rows of a computation that was said.
    Rows(Outcome& outcome, std::string name, bool coarse = false)
        : outcome_(outcome), name_(std::move(name)), coarse_(coarse) {}

    [[nodiscard]] const std::string& name() const { return name_; }
    void add(std::string_view quantity, double computed, std::optional<double> law = {}) {
        outcome_.measurements.push_back({std::string(quantity), name_, computed, law, coarse_});
    }
    void note(const std::string& remark) { outcome_.notes.push_back(name_ + ": " + remark); }
    /// What was measured, after a note of its `problem`: why the run did not get to its end; empty: it did.
    template <class Measured>
    [[nodiscard]] Measured noted(Measured measured) {
        if (!measured.problem.empty()) note(measured.problem);
        return measured;
    }

  private:
    Outcome& outcome_;
    std::string name_;
    bool coarse_;
};

}  // namespace talus::validate
