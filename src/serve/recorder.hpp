#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "publish/page.hpp"
#include "publish/tape.hpp"
#include "serve/open_session.hpp"

namespace talus::serve {

/// Told what is being done and which share of it; false stops.
using SayShare = std::function<bool(const std::string& what, double share)>;

struct RecordOptions {
    std::optional<double> frame_interval = {};  ///< s; empty: as many as `frame_bytes` takes
    std::size_t frame_bytes = 4'000'000;        ///< of all frames of a scenario
    bool files = true;                          ///< with the report, tables and maps of each run as files
};

/// Runs scenario A to its end. Not for the server's thread. Errors: stopped; a fault.
[[nodiscard]] Status run_to_end(OpenSession& open, const SayShare& say);

/// A run on a tape.
struct RecordedRun {
    std::string name;  ///< "A"
    double end = 0;    ///< s
    std::size_t frames = 0;
    std::string hash;  ///< of its last step, hexadecimal
};

struct Recorded {
    publish::Tape tape;
    std::vector<RecordedRun> runs;
};

/// What a page is told and may ask of a session as it is now. Not for the server's thread. Errors: stopped.
[[nodiscard]] Result<Recorded> record(OpenSession& open, const RecordOptions& options, const SayShare& say);

/// The page of published twins that this program carries. Error: it was built without the page.
[[nodiscard]] Result<publish::PageFiles> published_page();

}  // namespace talus::serve
