#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace talus::bench {

/// The calibration loop: current speed of this machine, under its current load, at work of the solver's kind. Rates of
/// the solver relative to it can be compared over time, and roughly between machines of one instruction set.
///
/// A unit gathers 48 rows of 16 bytes by an index list and adds up products of them, from arrays that fit into a core's
/// second-level cache. It has its own kernels: shared ones would become faster together with the solver.
class Calibration {
  public:
    Calibration();

    /// Units per second, over about 15 ms on all threads of the present arena.
    [[nodiscard]] double measure();

    [[nodiscard]] std::string_view instruction_set() const { return kernel_.instruction_set; }
    /// Sum over all units, so that the compiler cannot remove any work.
    [[nodiscard]] double total() const;

    static constexpr std::size_t rows_per_unit = 48;  // whole vectors of up to 16 lanes

    using Row = std::array<float, 4>;
    /// The loop for one instruction set: units [first, last), a sum each.
    struct Kernel {
        void (*sum_units)(const Row* rows, const std::uint32_t* index, std::size_t first, std::size_t last,
                          float* sums);
        std::string_view instruction_set;
    };

  private:
    Kernel kernel_;
    std::vector<Row> rows_;
    std::vector<std::uint32_t> index_;  // rows_per_unit for every unit
    std::vector<float> sums_;           // by unit
};

}  // namespace talus::bench
