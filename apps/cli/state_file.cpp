#include "state_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>
#include <unistd.h>

#include <fmt/format.h>

#include "core/try.hpp"
#include "products/checked_file.hpp"
#include "run/saved_state.hpp"

namespace talus::cli {
namespace {

namespace fs = std::filesystem;

constexpr products::CheckedFileKind state_file_kind{"talus state 1 ", "state of a run"};

/// A time, s, of at least 0.
std::optional<double> time_of(std::string_view text) {
    double time = 0;
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), time);
    const bool whole = failed == std::errc() && end == text.data() + text.size();
    if (!whole || !std::isfinite(time) || time < 0) return {};
    return time;
}

/// Whether a file is in a folder, or would be if it existed.
bool lies_in(const fs::path& file, const fs::path& folder) {
    const fs::path inner = fs::absolute(file).lexically_normal();
    fs::path outer = fs::absolute(folder).lexically_normal();
    if (!outer.has_filename()) outer = outer.parent_path();  // "results/"
    return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

}  // namespace

Result<SavedState> read_save_option(const std::string& option, const scene::Scene& scene, const fs::path& results) {
    SavedState saved{option};
    if (const std::size_t at = option.rfind('@'); at != std::string::npos) {
        saved.time = time_of(std::string_view(option).substr(at + 1));
        if (saved.time) saved.file = option.substr(0, at);
    }
    const auto refused = [&](const std::string& why) {
        return Error{fmt::format("--save-state {} is refused; {}", option, why)};
    };
    if (const Status can = run::check_state_can_be_saved(scene); !can) return refused(can.error().message);
    const fs::path parent = fs::absolute(saved.file).parent_path();
    std::error_code failed;
    if (saved.file.filename().empty()) return refused("it names no file: give FILE, or FILE@TIME with TIME in seconds");
    if (!fs::is_directory(parent, failed)) return refused(parent.string() + " is no folder");
    if (access(parent.c_str(), W_OK) != 0) return refused(parent.string() + " cannot be written to");
    if (fs::is_directory(saved.file, failed)) return refused(saved.file.string() + " is a folder");
    if (lies_in(saved.file, results)) return refused("the file is in the result folder, which is replaced as a whole");
    return saved;
}

Result<std::string> read_state_file(const fs::path& file, const scene::Scene& scene) {
    if (const Status can = run::check_state_can_be_saved(scene); !can) {
        return Error{fmt::format("--from-state {} is refused; {}", file.string(), can.error().message)};
    }
    return read_checked_file(file, state_file_kind);
}

Status write_state_file(const fs::path& file, const std::string& state) {
    return write_checked_file(file, state_file_kind, state);
}

}  // namespace talus::cli
