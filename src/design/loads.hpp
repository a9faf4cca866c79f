#pragma once

#include <optional>
#include <string>
#include <vector>

/// Loads of debris on a barrier by published methods, as data (loads.toml).
namespace talus::design {

enum class LoadKind { hydrodynamic, hydrostatic, mixed, run_up, boulder };

struct LoadMethod {
    std::string name, title;
    LoadKind kind = LoadKind::hydrodynamic;
    double coefficient = 0;
    std::string source, note;
    bool checked = false;  ///< against the text of the source; else as from memory

    /// "2.5 ρ v²"
    [[nodiscard]] std::string formula() const;
};

/// The flow that comes to a barrier.
struct Approach {
    double density = 0;                      ///< kg/m3
    double speed = 0;                        ///< m/s
    double depth = 0;                        ///< m
    std::optional<double> boulder_diameter;  ///< m; absent: nobody said
};

/// NaN: not what the method gives.
struct Load {
    double pressure = 0;         ///< Pa, the highest
    double force_per_metre = 0;  ///< N/m of the barrier
    double height = 0;           ///< m, of a run-up
    double force = 0;            ///< N, of a boulder
};
[[nodiscard]] Load load_of(const LoadMethod& method, const Approach& approach);

/// Those of the program, in their order.
[[nodiscard]] const std::vector<LoadMethod>& load_methods();

}  // namespace talus::design
