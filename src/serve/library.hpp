#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/result.hpp"

namespace talus::serve {

/// A scene that can be opened by its id: a path never comes from a request.
struct KnownScene {
    enum class Kind { recent, own, builtin };
    std::string id, title;
    Kind kind = Kind::recent;
    std::filesystem::path file;  ///< empty: built into the program
    std::string opened_at;       ///< UTC; empty: not opened yet
    bool missing = false;        ///< the file is no longer there
};

struct SavedSession {
    std::string id, name, title, saved_at;
    int scenarios = 0;
    std::filesystem::path file;
};

/// The folder of the start page: `recent.json`, `scenes/NAME/scene.toml`, `sessions/NAME.json`. One caller at a time.
/// What cannot be read is left out.
class Library {
  public:
    static constexpr std::uintmax_t longest_session = 64'000'000;  ///< bytes of a saved session
    static constexpr std::size_t most_session_values = 2'000'000;  ///< of its geo::json_values()

    explicit Library(std::filesystem::path folder) : folder_(std::move(folder)) {}

    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
    [[nodiscard]] std::filesystem::path scenes_folder() const { return folder_ / "scenes"; }
    /// Of a scene file.
    [[nodiscard]] static std::string id_of(const std::filesystem::path& file);
    /// The recent ones first, newest first; then those of the folder, then the built-in one.
    [[nodiscard]] std::vector<KnownScene> scenes() const;
    /// Newest first.
    [[nodiscard]] std::vector<SavedSession> sessions() const;

    /// Puts a scene first among the recent ones.
    [[nodiscard]] Status remember(const std::filesystem::path& file, const std::string& title) const;
    /// Takes it out of the recent ones; the file stays.
    [[nodiscard]] Status forget(const std::string& id) const;
    /// Deletes a scene of the folder `scenes`, with its files.
    [[nodiscard]] Status remove_scene(const std::string& id) const;
    /// Writes a session under `name`; the same name again replaces it. Returns its id. Errors: no name, disk full.
    [[nodiscard]] Result<std::string> save_session(const std::string& name, const std::string& text) const;
    [[nodiscard]] Status remove_session(const std::string& id) const;

  private:
    std::filesystem::path folder_;
};

/// As a name of a file or folder: lower-case letters, digits and hyphens; empty where nothing of it is left.
[[nodiscard]] std::string file_name_of(const std::string& name);

/// A sentence with a name in place of a path: that of an upload, by which its user knows it.
[[nodiscard]] std::string with_name(std::string sentence, const std::filesystem::path& path, const std::string& name);
/// The same for all files of a folder, by their own names.
[[nodiscard]] std::string without_folder(const std::string& sentence, const std::filesystem::path& folder);

/// `2026-11-24T03:40:00Z`
[[nodiscard]] std::string utc_now();

/// Writes a file under another name first, so that it is never there in part. Error: disk full.
[[nodiscard]] Status write_whole(const std::filesystem::path& file, const std::string& text);

/// Error: it cannot be read, or is longer than `longest` bytes.
[[nodiscard]] Result<std::string> read_whole(const std::filesystem::path& file, std::uintmax_t longest);

}  // namespace talus::serve
