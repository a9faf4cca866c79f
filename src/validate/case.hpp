#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "params/spec.hpp"

/// A validation case: a folder of data that defines a computation and its expected results.
namespace talus::validate {

inline constexpr double not_computed = std::numeric_limits<double>::quiet_NaN();

/// How a computed value is compared with the expected one.
enum class Comparison { near, at_most, at_least };

/// `[[expect]]` of a case file.
struct Expectation {
    std::string quantity;
    std::string where;               ///< the variant it refers to; empty: every one that no other entry names
    std::optional<double> expected;  ///< absent: the value of the kind's law
    /// Largest deviation as a share of the expected value, or in the quantity's unit where the expected value is 0.
    std::optional<double> tolerance;
    Comparison comparison = Comparison::near;
    bool gate = true;           ///< false: shown with the others, but not judged
    std::string source;         ///< publication of the expected value or law
    std::string known_failure;  ///< why this fails today; empty: it passes

    // Where on a scene the quantity is taken; the quantity determines which are needed.
    std::optional<double> chainage;      ///< m
    std::optional<double> x, y, radius;  ///< world plan position and distance around it, m
    std::string building;
};

/// A value computed by a case.
struct Measurement {
    std::string quantity;       ///< as in [[expect]]
    std::string where;          ///< the variant: "slope 30 degrees, f = 0.4"; empty where there is only one
    double computed = 0;        ///< not_computed: the run did not get there
    std::optional<double> law;  ///< the value of the kind's law
    bool coarse = false;        ///< of a coarser resolution than the finest: shows the trend, is not judged
};

/// A curve of a chart.
struct Series {
    enum class Style { line, dashed, marks };
    std::string name;
    Style style = Style::line;
    std::vector<double> x, y;
};

struct Chart {
    std::string name;   ///< short, for file names: "profile"
    std::string title;  ///< what is shown, a sentence without its full stop
    std::string x_title, y_title;
    std::vector<Series> series;
};

struct Outcome {
    std::vector<Measurement> measurements;
    std::vector<Chart> charts;
    std::vector<std::string> notes;  ///< remarks on the numbers: a fault, the number of particles
};

/// Options and callbacks of a running case.
struct Watch {
    std::function<void(const std::string&)> on_progress;  ///< called with the current computation
    const std::atomic<bool>* stop_requested = nullptr;
    int thread_count = 0;  ///< 0: all cores
    params::BackendChoice backend = params::BackendChoice::cpu;

    void say(const std::string& what) const {
        if (on_progress) on_progress(what);
    }
    [[nodiscard]] bool stopped() const { return stop_requested != nullptr && stop_requested->load(); }
};

/// Computes a case. Errors: an input that cannot be used. A step that cannot be trusted is not an error: its values are
/// `not_computed`, with a note.
using Computation = std::function<Result<Outcome>(const Watch&)>;

struct Case {
    std::string name;  ///< of its folder
    std::filesystem::path folder;
    std::string title, kind, description;
    bool quick = false;
    std::string needs_data;  ///< a path below TALUS_DATA without which the case is skipped; empty: none
    std::vector<Expectation> expectations;
    Computation compute;
};

/// A quantity measured by a kind of case.
struct Quantity {
    enum class Site { none, chainage, building, place };
    std::string_view name;
    std::string_view unit;
    bool has_law = false;  ///< the kind computes the expected value
    Site site = Site::none;
    std::string_view help;
};

/// Reads a case folder: its case.toml, checked down to every key and value. Errors are one line with file, line, key,
/// value and allowed values.
[[nodiscard]] Result<Case> load_case(const std::filesystem::path& folder);

}  // namespace talus::validate
