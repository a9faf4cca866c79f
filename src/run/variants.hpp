#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "observe/peaks.hpp"
#include "run/run_scene.hpp"
#include "run/time_left.hpp"
#include "scene/scene.hpp"

/// Runs of a scene with some of its values set differently, beside its run as given (the base).
namespace talus::run {

struct Variant {
    std::string name;                    ///< "half the time step", "material.friction_coefficient = 0.3"
    std::vector<std::string> overrides;  ///< "section.key=value", applied after those of the base
    double effort = 1;                   ///< wall time of its run over that of the base, an estimate
    std::string about{};                 ///< what a named variant stands for and its author
};

/// A variant's run, or why there is none.
struct VariantRun {
    Variant variant;
    std::optional<RunResult> result;  ///< of a complete run, without maps and time series
    std::string missing;              ///< "interrupted at t = 3.2 s", an error; empty where there is a result
    observe::Peaks peaks{};           ///< of its maps
};

/// Where the base comes from, to load it again with other values.
struct SceneSource {
    std::filesystem::path file;
    std::vector<std::string> overrides;  ///< as for load_scene
};

/// Half the time step at every moment, double the iterations, three times the particles.
[[nodiscard]] std::vector<Variant> refinements(const scene::Scene& base);

/// A variant per value of "section.key=value,value,...", or "section[index].key=..."; commas in brackets or quotes do
/// not separate. Errors: no key, no value.
[[nodiscard]] Result<std::vector<Variant>> variations(std::string_view text);

/// The named variants of the scene file.
[[nodiscard]] std::vector<Variant> named_variants(const params::SceneSpec& scene);

/// Loads every variant once, so that an invalid one is refused before a long run of the base, and fills in `effort`.
/// Errors: as load_scene, and more particles than the limit.
[[nodiscard]] Result<std::vector<Variant>> prepare_variants(const SceneSource& source, const scene::Scene& base,
                                                            std::vector<Variant> variants);

/// Loads and runs one. A failure is not an error: `missing` gives the reason.
[[nodiscard]] VariantRun run_variant(const SceneSource& source, const Variant& variant, const RunOptions& options);

/// Progress of the base and its variants together.
struct SeriesProgress {
    std::size_t run, count;  ///< the current run, from 1 (the base), and their number
    std::string_view name;   ///< of the variant; "as given" for the base
    double share_done;       ///< 0 to 1, of all runs
    double wall_remaining;   ///< s, of all runs, an estimate; NaN: too little is done to say
};

/// Estimates the total time of the base and its variants.
class SeriesClock {
  public:
    explicit SeriesClock(std::vector<Variant> variants);

    /// `now`: of the current run.
    [[nodiscard]] SeriesProgress at(const Progress& now);
    /// Call when the current run has ended and the next begins.
    void base_ended(const RunResult& result);
    void variant_ended();

  private:
    void next_begins();

    std::vector<Variant> variants_;
    WorkClock work_;
    std::size_t run_ = 0;          // 0: the base
    double before_ = 0, now_ = 0;  // s of wall time: of the runs before, and of all so far
};

}  // namespace talus::run
