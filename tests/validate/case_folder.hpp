#pragma once

#include <fstream>
#include <string>

#include "support/fixtures.hpp"
#include "validate/case.hpp"

namespace talus::validate {

/// A slab so small that it is computed in a moment.
inline const std::string small_case = R"([case]
title = "A small slab"
kind = "sliding_slab"
description = "For tests."

[parameters]
slopes_deg = [30]
friction_coefficients = [0.4]
particle_spacing_m = 0.6
length_m = 6
layers = 2
end_s = 0.4

[material]
viscosity = 0

[[expect]]
quantity = "clearance"
expected = 0
tolerance = 0.5
source = "by construction"
)";

/// A case folder that is gone after the test.
class CaseFolder {
  public:
    explicit CaseFolder(const std::string& text) { std::ofstream(folder_.path() / "case.toml") << text; }

    [[nodiscard]] Result<Case> load() const { return load_case(folder_.path()); }
    [[nodiscard]] const std::filesystem::path& path() const { return folder_.path(); }

  private:
    test::TemporaryFolder folder_;
};

/// The small case with a part of its text replaced.
inline std::string changed_case(const std::string& from, const std::string& to) {
    std::string text = small_case;
    const std::size_t at = text.find(from);
    return at == std::string::npos ? std::string() : text.replace(at, from.size(), to);
}

}  // namespace talus::validate
