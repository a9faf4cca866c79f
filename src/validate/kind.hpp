#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "params/spec.hpp"
#include "validate/case.hpp"
#include "validate/parameters.hpp"

namespace talus::validate {

/// Settings of a case file in addition to the parameters of its kind.
struct Setting {
    params::MaterialSpec material;
    params::SolverSpec solver;
    std::vector<std::string> overrides;  ///< what of both was given, as "section.key=value"
    std::vector<Expectation> expectations;
};

/// A kind of case: a set-up, its measured quantities, and the law for comparison.
struct Kind {
    std::string_view name;
    std::string_view summary;
    std::span<const Quantity> quantities;
    /// Reads the parameters (which keep any problem) and returns the computation of the case.
    Computation (*prepare)(Parameters& parameters, const Setting& setting);

    [[nodiscard]] const Quantity* find(std::string_view quantity) const;
};

[[nodiscard]] std::span<const Kind> kinds();

}  // namespace talus::validate
