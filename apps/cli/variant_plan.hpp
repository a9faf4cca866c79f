#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "progress.hpp"
#include "run/comparison.hpp"
#include "run/variants.hpp"

namespace talus::cli {

struct RunArguments {
    std::string scene;   ///< a scene file; empty: the built-in scene
    std::string output;  ///< a folder; empty: talus_out/<scene name>
    bool force = false;
    std::optional<int> threads;
    std::vector<std::string> overrides;   ///< "section.key=value"
    std::string layers;                   ///< of --layers; empty: not given
    std::string model{};                  ///< of --model; empty: the scene's
    std::vector<std::string> series{};    ///< of --series; empty: the scene's
    std::vector<std::string> contours{};  ///< of --contours; empty: the scene's
    std::optional<int> tracks{};          ///< of --tracks; absent: the scene's
    std::string zoom{};                   ///< of --zoom: a structure; empty: not given
    std::string zoom_polygon{};           ///< of --zoom-polygon: a file; empty: not given
    std::optional<double> zoom_margin{};  ///< m
    std::string save_state{};             ///< of --save-state: FILE[@TIME]; empty: not given
    std::string from_state{};             ///< of --from-state: a file; empty: not given
    std::string data;                     ///< value of TALUS_DATA; empty: as in the environment
    bool quiet = false, json = false;
    bool publish = false;                 ///< with twin.html beside the report
    bool convergence = false;             ///< run three refinements too and compare
    bool named_variants = false;          ///< run every [[variant]] of the scene too and compare
    std::vector<std::string> variations;  ///< "section.key=value,value": run with each value too and compare
};

/// The runs requested on the command line in addition to the base.
class VariantPlan {
  public:
    /// Errors: a variant that cannot be run, before any run starts.
    [[nodiscard]] static Result<VariantPlan> make(const RunArguments& arguments, const run::SceneSource& source,
                                                  const scene::Scene& scene);

    [[nodiscard]] bool empty() const { return variants_.empty(); }

    /// Reports the progress of the base; with variants, that of all runs together.
    void report_base(ProgressReporter& reporter, const run::Progress& now);

    /// Runs the variants one after the other and compares them with the base. After a stop request or a fault of the
    /// base the rest are listed as missing.
    [[nodiscard]] std::vector<run::Comparison> run(const scene::Scene& scene, const run::RunResult& base,
                                                   ProgressReporter& reporter, const std::atomic<bool>& stop_requested);

  private:
    VariantPlan(run::SceneSource source, std::vector<run::Variant> variants, std::size_t refinement_count);

    run::SceneSource source_;
    std::vector<run::Variant> variants_;  // refinements, then named ones and variations
    std::size_t refinement_count_;
    run::SeriesClock clock_;
};

/// Tables for a terminal: values and changes of every variant.
[[nodiscard]] std::string comparison_text(const run::Comparison& comparison, const run::RunResult& base);

}  // namespace talus::cli
