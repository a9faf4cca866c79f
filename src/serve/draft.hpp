#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/grid.hpp"
#include "core/result.hpp"
#include "geo/foreign.hpp"
#include "geo/raster.hpp"
#include "geo/repair_raster.hpp"
#include "geo/zip_archive.hpp"
#include "messages/messages.hpp"
#include "scene/new_scene.hpp"

namespace talus::serve {

/// What may be uploaded for a new scene.
struct UploadLimits {
    std::uint64_t bytes = std::uint64_t{2} << 30;  ///< of all its files together, unpacked
    std::size_t files = 200;                       ///< in an archive
    double cells = 5e7;                            ///< of a terrain or of a raster of thickness
};

/// A scene that is being made from uploaded files, in a folder of its own: `data/ROLE/FILE`. Each file is read once, by
/// a process of its own, and written again (geo/foreign.hpp); nothing else of it is opened. It becomes a scene all at
/// once, by a change of the folder's name. Not for several threads at once; reading a terrain takes seconds.
class Draft {
  public:
    static constexpr std::array<std::string_view, 5> roles = {"terrain", "release", "buildings", "orthophoto",
                                                              "bundle"};

    /// Makes the folder. Error: it cannot be made.
    [[nodiscard]] static Result<Draft> make(std::filesystem::path folder, const UploadLimits& limits);
    /// Removes the folder with all that is in it, unless it has become a scene.
    ~Draft();
    Draft(Draft&& other) noexcept;
    Draft& operator=(Draft&& other) = delete;
    Draft(const Draft&) = delete;
    Draft& operator=(const Draft&) = delete;

    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
    /// What may still come.
    [[nodiscard]] std::uint64_t bytes_left() const;

    /// Takes a file that has come whole, `upload`, which is gone afterwards. `name`: as it was called; of an archive
    /// the one file of the role's kind in it, of NAME.gz what is packed in it. Errors: nothing of that kind, beyond the
    /// limits, as convert_foreign; then the former one stays.
    [[nodiscard]] Status take(std::string_view role, const std::string& name, const std::filesystem::path& upload,
                              const geo::ForeignReader& reader);
    void remove(std::string_view role);
    /// Of the terrain; in place of what was to be mended before. Errors: no terrain, as geo::repair_raster; then
    /// nothing changes.
    [[nodiscard]] Status mend(const geo::Mending& mending);
    /// What there is, and what is wrong with the terrain.
    [[nodiscard]] messages::Draft describe() const;
    /// The terrain, if it can be one.
    [[nodiscard]] const Grid<float>* terrain() const { return terrain_ ? &terrain_->grid : nullptr; }

    /// What its user says beside the files.
    struct Wanted {
        std::string title;
        std::optional<double> thickness, volume;  ///< m; m3
        std::vector<PlanPoint> scar;              ///< drawn, in place of a release file
    };
    /// As `talus scene check` would find it; leaves no scene behind.
    [[nodiscard]] Result<scene::NewScene> check(const Wanted& wanted);
    /// Makes it a scene, a folder below `scenes`; returns its scene file. It is of no more use then.
    [[nodiscard]] Result<std::filesystem::path> finish(const Wanted& wanted, const std::filesystem::path& scenes);

  private:
    struct Upload {
        std::string name;            ///< as it was called
        std::filesystem::path file;  ///< as it was written again
        std::uint64_t bytes = 0;
        geo::FileKind kind = geo::FileKind::other;
    };
    Draft(std::filesystem::path folder, const UploadLimits& limits) : folder_(std::move(folder)), limits_(limits) {}
    [[nodiscard]] Result<Upload> convert(std::string_view role, const std::string& name,
                                         const std::filesystem::path& upload, const std::filesystem::path& to,
                                         const geo::ForeignReader& reader) const;
    void read_terrain();
    [[nodiscard]] const Upload* find(std::string_view role) const;
    [[nodiscard]] std::filesystem::path dem() const;
    [[nodiscard]] Result<scene::NewScene> write_scene(const Wanted& wanted);
    [[nodiscard]] Result<scene::NewScene> check_bundle() const;
    /// Without the folder's path and without commands for a shell.
    [[nodiscard]] std::string plain(std::string message) const;

    std::filesystem::path folder_;  // empty: it has become a scene, or another object's
    UploadLimits limits_;
    std::map<std::string, Upload, std::less<>> uploads_;
    geo::Mending mending_;
    std::optional<geo::RasterFacts> facts_;  // of the terrain as it came
    std::optional<geo::Raster> terrain_;
    std::string problem_;  // why the terrain cannot be one
};

/// The file to read of an upload, somewhere below `to`: itself, or the only one of a ZIP archive that is no companion
/// of it. Errors: none or several, one that belongs with others, beyond the limits.
[[nodiscard]] Result<std::filesystem::path> unpack_upload(const std::string& name, const std::filesystem::path& upload,
                                                          const std::filesystem::path& to,
                                                          const geo::ZipLimits& limits);

/// A file's name without anything that leads elsewhere: letters, digits, hyphens, and its ending.
[[nodiscard]] std::string upload_name_of(const std::string& name);

}  // namespace talus::serve
