#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "scene/new_scene.hpp"

/// The program's commands. Each returns an exit code and has said on stderr, in one line, what went wrong.
namespace talus {

struct RunArguments {
    std::string scene;   ///< a scene file; empty: the built-in scene
    std::string output;  ///< a folder; empty: talus_out/<scene name>
    bool force = false;
    std::optional<int> threads;
    std::vector<std::string> overrides;  ///< "section.key=value"
    std::string data;                    ///< value of TALUS_DATA; empty: as in the environment
    bool quiet = false, json = false;
    bool convergence = false;             ///< run three refinements too and compare
    std::vector<std::string> variations;  ///< "section.key=value,value": run with each value too and compare
};
int run_command(const RunArguments& arguments);

struct ReplayArguments {
    std::string journal;
    std::string scene;  ///< in place of the journal's; empty: that one
    std::optional<int> threads;
    std::string data;
    bool quiet = false;
};
int replay_command(const ReplayArguments& arguments);

struct ServeArguments {
    std::string scene;  ///< a scene file; empty: the built-in scene
    std::string host = "127.0.0.1";
    int port = 8123;
    std::vector<std::string> allowed_hosts;
    std::vector<std::string> tokens;  ///< the controllers', then the viewers'; left out: random ones
    std::optional<int> threads;
    std::vector<std::string> overrides;  ///< "section.key=value"
    std::string data;                    ///< value of TALUS_DATA; empty: as in the environment
    std::string calibrations;            ///< a folder that keeps calibrations; empty: they are not kept
    std::vector<std::string> ensembles;  ///< folders of finished ensembles whose maps are shown
    bool run = false;                    ///< begin at once
    bool quiet = false, json = false;
};
int serve_command(const ServeArguments& arguments);

struct CheckArguments {
    std::string scene;
    std::vector<std::string> overrides;
    std::string data;
};
int check_command(const CheckArguments& arguments);

int new_command(const NewSceneOptions& options);

int export_builtin_command(const std::string& folder, bool force);

struct ValidateArguments {
    std::vector<std::string> cases;    ///< names or folders; empty: all cases of the program
    bool quick = false, list = false;  ///< quick: only the cases that say so
    bool known = false;                ///< failures that the case files announce are no reason to fail
    std::string json, html, markdown;  ///< files to write; empty: none
    std::optional<int> threads;
    std::string data;  ///< value of TALUS_DATA; empty: as in the environment
};
int validate_command(const ValidateArguments& arguments);

struct BenchArguments {
    std::vector<std::string> scenes, methods;  ///< empty: all
    std::vector<int> particles, threads;       ///< empty: the usual ones; all cores
    bool full = false;                         ///< particles up to a million
    int iterations = 4, repeats = 7;
    std::optional<int> steps, warm_up;  ///< left out: by the number of particles
    std::string json, svg;              ///< files to write; empty: none
};
int bench_command(const BenchArguments& arguments);

struct EnsembleArguments {
    std::string scene;                 ///< a scene file; empty: the built-in scene
    std::string output;                ///< a folder; empty: talus_out/<scene name>_ensemble
    std::string plan;                  ///< a plan file; empty: options alone
    std::vector<std::string> factors;  ///< "section.key=distribution"
    std::optional<std::string> design;
    std::optional<std::size_t> runs, levels;
    std::optional<std::uint64_t> seed;
    std::string depths, speeds, pressures;  ///< thresholds "0.5,1"; empty: the plan's
    std::vector<std::string> overrides;     ///< "section.key=value"
    std::string data;                       ///< value of TALUS_DATA; empty: as in the environment
    std::optional<int> threads;
    std::string shard;  ///< "i/n"; empty: all runs
    bool retry_failed = false, quiet = false, json = false;
};
int ensemble_command(const EnsembleArguments& arguments);

struct MergeArguments {
    std::vector<std::string> folders;
    std::string output;  ///< empty: the only folder itself
    std::string scene;   ///< where the scene lies now; empty: where it lay
    std::string depths, speeds, pressures;
    std::string data;
    bool quiet = false, json = false;
};
int merge_command(const MergeArguments& arguments);

/// The reference of scene files on stdout: for the terminal, or as Markdown.
int reference_command(bool markdown);

/// Prints "talus: error: MESSAGE" as exactly one line on stderr and returns `code`.
int fail(int code, const std::string& message);

/// Whether `file` (empty: none) can be written as far as one sees beforehand: it must not come up after half an hour.
[[nodiscard]] Status check_output_file(const std::string& file);

/// Makes `${TALUS_DATA}` in scene paths mean `folder`. Call before any thread starts.
void set_data_folder(const std::string& folder);

}  // namespace talus
