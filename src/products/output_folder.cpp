#include <fstream>
#include <system_error>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/try.hpp"
#include "products/products.hpp"

namespace talus::products {

namespace fs = std::filesystem;

namespace {

/// Whether a folder was written by this program; only such a folder may ever be replaced.
bool is_result_folder(const fs::path& folder) {
    std::ifstream in(folder / "manifest.json");
    const auto manifest = nlohmann::json::parse(in, nullptr, false);
    return manifest.is_object() && manifest.value("program", nlohmann::json()) == "talus";
}

/// Why `path` may not be replaced; OK if it may, or if nothing is there.
Status check_replaceable(const fs::path& path, bool force) {
    std::error_code failed;
    const fs::file_status status = fs::status(path, failed);
    if (status.type() == fs::file_type::not_found) return {};
    if (failed) return Error{fmt::format("{}: {}", path.string(), failed.message())};
    if (!fs::is_directory(status)) {
        return Error{fmt::format("{}: is a file, not a folder; name another output folder", path.string())};
    }
    if (!force) {
        return Error{
            fmt::format("{}: is already there; name another output folder, or replace an earlier result with --force",
                        path.string())};
    }
    if (fs::is_empty(path, failed) && !failed) return {};
    if (is_result_folder(path)) return {};
    return Error{
        fmt::format("{}: is not a result of talus (it has no manifest.json) and is not replaced; name another "
                    "output folder",
                    path.string())};
}

/// Absolute, without "." and trailing slashes, and through a link to what it points to.
fs::path resolved(const fs::path& path) {
    fs::path result = fs::absolute(path).lexically_normal();
    if (!result.has_filename()) result = result.parent_path();
    std::error_code failed;
    if (fs::is_symlink(result, failed)) {
        fs::path target = fs::weakly_canonical(result, failed);
        if (!failed) return target;
    }
    return result;
}

/// A hidden name beside the final one, so that renaming never crosses file systems.
fs::path hidden_sibling(const fs::path& path, const char* purpose, int attempt) {
    return path.parent_path() / fmt::format(".{}.{}-{}-{}", path.filename().string(), purpose, getpid(), attempt);
}

}  // namespace

Result<OutputFolder> OutputFolder::create(const fs::path& final_path, bool force) {
    if (final_path.empty()) return Error{"no output folder given"};
    OutputFolder folder;
    folder.final_ = resolved(final_path);
    folder.force_ = force;
    TALUS_TRY(check_replaceable(folder.final_, force));

    const fs::path parent = folder.final_.parent_path();
    std::error_code failed;
    if (!fs::is_directory(parent, failed)) {
        return Error{fmt::format("{}: the folder to put it in does not exist: {}", folder.final_.string(),
                                 failed ? failed.message() : parent.string())};
    }
    constexpr int max_attempts = 1000;
    for (int attempt = 0; attempt < max_attempts; ++attempt) {
        const fs::path candidate = hidden_sibling(folder.final_, "unfinished", attempt);
        if (fs::create_directory(candidate, failed)) {
            folder.temporary_ = candidate;
            return Result<OutputFolder>(std::move(folder));
        }
        if (failed) break;
    }
    return Error{fmt::format("{}: cannot be made in {}: {}", folder.final_.string(), parent.string(),
                             failed ? failed.message() : "too many unfinished ones there")};
}

OutputFolder::OutputFolder(OutputFolder&& other) noexcept
    : temporary_(std::exchange(other.temporary_, {})), final_(std::move(other.final_)), force_(other.force_) {}

OutputFolder::~OutputFolder() {
    std::error_code ignored;
    if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
}

Status OutputFolder::commit() {
    // Checked again: the folder may have changed during the run.
    TALUS_TRY(check_replaceable(final_, force_));
    const auto failure = [&](const std::error_code& cause) {
        return Error{fmt::format("{}: cannot be given its name: {}", final_.string(), cause.message())};
    };
    std::error_code failed;
    fs::path aside;
    if (fs::is_directory(final_, failed)) {
        int attempt = 0;
        do {
            aside = hidden_sibling(final_, "replaced", attempt++);
        } while (fs::exists(aside, failed));
        fs::rename(final_, aside, failed);
        if (failed) return failure(failed);
    }
    fs::rename(temporary_, final_, failed);
    if (failed) {
        std::error_code ignored;
        if (!aside.empty()) fs::rename(aside, final_, ignored);
        return failure(failed);
    }
    temporary_.clear();
    if (!aside.empty()) {
        fs::remove_all(aside, failed);
        if (failed) {
            return Error{fmt::format("{}: is complete, but the earlier result cannot be deleted: {}: {}",
                                     final_.string(), aside.string(), failed.message())};
        }
    }
    return {};
}

}  // namespace talus::products
