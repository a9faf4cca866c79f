#include <cerrno>
#include <fcntl.h>
#include <fstream>
#include <sys/file.h>
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

bool says(const fs::path& file, const char* key, const char* value) {
    std::ifstream in(file);
    const auto content = nlohmann::json::parse(in, nullptr, false);
    return content.is_object() && content.value(key, nlohmann::json()) == value;
}

/// Whether a folder was written by this program, as the result of a run or of `talus compare`; only such a folder may
/// ever be replaced.
bool is_result_folder(const fs::path& folder) {
    return says(folder / "manifest.json", "program", "talus") ||
           says(folder / "results.json", "format", "talus comparison");
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

/// The folders to make before one can be made in `parent`, from the top.
std::vector<fs::path> missing_folders(fs::path parent) {
    std::vector<fs::path> missing;
    std::error_code failed;
    for (; !parent.empty() && fs::status(parent, failed).type() == fs::file_type::not_found;
         parent = parent.parent_path()) {
        missing.insert(missing.begin(), parent);
    }
    return missing;
}

/// A hidden name beside the final one, so that renaming never crosses file systems.
fs::path hidden_sibling(const fs::path& path, const char* purpose, int attempt) {
    return path.parent_path() / fmt::format(".{}.{}-{}-{}", path.filename().string(), purpose, getpid(), attempt);
}

/// Locks a folder until the file is closed, at the latest when the process ends, however it does. -1, with errno: it
/// is locked already, it is not there, or the file system has no locks.
int lock(const fs::path& folder) {
    const int file = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (file < 0 || flock(file, LOCK_EX | LOCK_NB) == 0) return file;
    const int cause = errno;
    close(file);
    errno = cause;
    return -1;
}

/// Deletes the temporary folders of this output that no process locks.
void remove_leftovers(const fs::path& final_path) {
    const std::string prefix = fmt::format(".{}.unfinished-", final_path.filename().string());
    std::error_code ignored;
    std::vector<fs::path> leftovers;
    for (const fs::directory_entry& entry : fs::directory_iterator(final_path.parent_path(), ignored)) {
        const std::string name = entry.path().filename().string();
        const bool ours =
            name.starts_with(prefix) && name.find_first_not_of("0123456789-", prefix.size()) == std::string::npos;
        if (ours) leftovers.push_back(entry.path());
    }
    for (const fs::path& leftover : leftovers) {
        const int locked = lock(leftover);
        if (locked < 0) continue;
        fs::remove_all(leftover, ignored);
        close(locked);
    }
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
    for (fs::path& missing : missing_folders(parent)) {
        if (!fs::create_directory(missing, failed) && failed) {
            return Error{fmt::format("{}: cannot be made: {}", missing.string(), failed.message())};
        }
        folder.made_above_.insert(folder.made_above_.begin(), std::move(missing));
    }
    if (!fs::is_directory(parent, failed)) {
        return Error{fmt::format("{}: cannot be made in {}: {}", folder.final_.string(), parent.string(),
                                 failed ? failed.message() : "that is a file, not a folder")};
    }
    remove_leftovers(folder.final_);
    constexpr int max_attempts = 1000;
    for (int attempt = 0; attempt < max_attempts; ++attempt) {
        const fs::path candidate = hidden_sibling(folder.final_, "unfinished", attempt);
        if (fs::create_directory(candidate, failed)) {
            folder.lock_ = lock(candidate);
            // Another run may take it for a leftover before it is locked.
            if (folder.lock_ < 0 && (errno == EWOULDBLOCK || errno == ENOENT)) continue;
            folder.temporary_ = candidate;
            return Result<OutputFolder>(std::move(folder));
        }
        if (failed) break;
    }
    return Error{fmt::format("{}: cannot be made in {}: {}", folder.final_.string(), parent.string(),
                             failed ? failed.message() : "too many unfinished ones there")};
}

OutputFolder::OutputFolder(OutputFolder&& other) noexcept
    : temporary_(std::exchange(other.temporary_, {})),
      final_(std::move(other.final_)),
      made_above_(std::exchange(other.made_above_, {})),
      force_(other.force_),
      lock_(std::exchange(other.lock_, -1)) {}

OutputFolder::~OutputFolder() {
    std::error_code ignored;
    if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
    if (lock_ >= 0) close(lock_);
    // What another run has put into them meanwhile keeps them.
    for (const fs::path& made : made_above_) fs::remove(made, ignored);
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
    made_above_.clear();
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
