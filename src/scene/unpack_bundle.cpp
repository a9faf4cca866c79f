#include <algorithm>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <system_error>

#include <fmt/format.h>

#include "core/input_file.hpp"
#include "core/try.hpp"
#include "params/paths.hpp"
#include "scene/bundle.hpp"
#include "scene/load.hpp"
#include "scene/parse.hpp"
#include "scene/scene_text_edits.hpp"
#include "scene/toml_file.hpp"

namespace talus::scene {
namespace {

namespace fs = std::filesystem;

bool lies_in(const fs::path& file, const fs::path& folder) {
    std::error_code failed;
    const fs::path relative =
        fs::weakly_canonical(file, failed).lexically_relative(fs::weakly_canonical(folder, failed));
    return !failed && !relative.empty() && *relative.begin() != "..";
}

/// The only scene file of an unpacked archive.
Result<fs::path> find_scene_in(const fs::path& folder, const fs::path& archive) {
    std::error_code failed;
    const auto scenes_in = [&](const fs::path& place) {
        std::vector<fs::path> found;
        for (const auto& entry : fs::directory_iterator(place, failed)) {
            if (entry.path().extension() == ".toml") found.push_back(entry.path());
        }
        std::sort(found.begin(), found.end());
        return found;
    };
    std::vector<fs::path> scenes = scenes_in(folder);
    if (scenes.empty()) {
        const std::vector<fs::path> inner(fs::directory_iterator(folder, failed), fs::directory_iterator());
        if (inner.size() == 1 && fs::is_directory(inner.front(), failed)) scenes = scenes_in(inner.front());
    }
    if (scenes.empty()) return Error{archive.string() + ": there is no scene in it: no .toml file at its top"};
    if (scenes.size() > 1) {
        return Error{fmt::format("{}: there are {} scenes in it, {} and {}; unpack it and name one", archive.string(),
                                 scenes.size(), scenes[0].filename().string(), scenes[1].filename().string())};
    }
    return scenes.front();
}

std::set<std::string> paths_of(const params::SceneSpec& spec) {
    std::set<std::string> paths;
    params::for_each_path(spec, [&](const params::Section&, std::size_t, const params::Parameter&,
                                    const std::string& path) { paths.insert(path); });
    return paths;
}

std::string choosing(const params::VariantSpec& variant) {
    return "variant=" + variant.name;
}

/// No variant may name what the scene does not: only that was looked at and written again.
Status check_variant_paths(const ParsedScene& parsed) {
    const std::set<std::string> own = paths_of(parsed.spec);
    for (const params::VariantSpec& variant : parsed.spec.variants) {
        TALUS_ASSIGN(const auto other, parse_scene(parsed.file, {choosing(variant)}));
        for (const std::string& path : paths_of(other)) {
            if (own.contains(path)) continue;
            return Error{fmt::format("variant \"{}\" of its scene names a file that the scene itself does not",
                                     one_line(variant.name, 80))};
        }
    }
    return {};
}

/// What the file of a key may be; nothing: the scene's own reader takes it as it is.
std::optional<geo::ForeignWanted> wanted_for(const std::string& section, const std::string& key, int band) {
    if (key == "hydrograph" || key == "pore_pressure_hydrograph") return {};
    geo::ForeignWanted wanted;
    wanted.cells = 2e8;  // as raster_read takes
    const bool raster = section == "elevation_change" || key == "deposit" || key == "erosion" || key == "raster" ||
                        key.ends_with("_raster") || (section == "terrain" && key == "file");
    wanted.picture = key == "orthophoto";
    wanted.raster = raster;
    wanted.vector = !raster && !wanted.picture;
    wanted.mesh = section == "buildings";
    if (wanted.picture) wanted.cells = 1e9;
    if (section == "terrain" && key == "file") wanted.bands = std::max(1, band);
    wanted.purpose = raster           ? "is no raster"
                     : wanted.picture ? "is no picture"
                     : wanted.mesh    ? "is no layer of polygons and no mesh"
                                      : "is no layer of polygons, lines or points";
    return wanted;
}

/// Writes the scene and its files again, from one folder into another.
class Rewriting {
  public:
    Rewriting(fs::path from, fs::path to, const geo::ForeignReader& reader)
        : from_(std::move(from)), to_(std::move(to)), reader_(reader) {}

    Status rewrite(const fs::path& archive, Unpacked& unpacked) {
        TALUS_ASSIGN(const toml::table root, read_toml_file(from_, "scene"));
        TALUS_ASSIGN(const ParsedScene parsed, parse_scene_with_places(from_, {}));
        if (const Status good = check_variant_paths(parsed); !good) {
            return Error{archive.string() + ": " + good.error().message};
        }
        TALUS_ASSIGN(std::string text, text_of(from_));
        std::vector<std::pair<toml::source_position, std::string>> edits;
        Status failed;
        const auto places = places_of(root);
        params::for_each_path(parsed.spec, [&](const params::Section& section, std::size_t index,
                                               const params::Parameter& parameter, const std::string& path) {
            if (!failed) return;
            const std::string at = key_path(section, index, parameter);
            if (!lies_in(path, from_.parent_path())) {
                failed =
                    Error{fmt::format("{}: {} in its scene names a file outside the archive", archive.string(), at)};
                return;
            }
            const auto place = places.find(at);
            std::error_code ignored;
            if (place == places.end()) return;
            // Also a file in an archive, which would be opened as it is: a copy of a table may become one.
            if (!fs::is_regular_file(path, ignored)) {
                failed = Error{fmt::format("{}: {}: no such file", parsed.at(at), path)};
                return;
            }
            const auto again = write_again(path, section.name, parameter.key, parsed.spec.terrain.band);
            if (!again) {
                failed = Error{parsed.at(at) + ": " + again.error().message};
            } else {
                edits.emplace_back(place->second, *again + layer_behind(parsed, section, index, parameter));
            }
        });
        TALUS_TRY(std::move(failed));
        std::sort(edits.begin(), edits.end(), [](const auto& a, const auto& b) {
            return std::pair(a.first.line, a.first.column) > std::pair(b.first.line, b.first.column);
        });
        for (const auto& [place, path] : edits) {
            if (const Status s = replace_string(text, place, path); !s) {
                return Error{fmt::format("{}:{}: {}", from_.string(), place.line, s.error().message)};
            }
        }
        unpacked.scene = to_ / from_.filename();
        std::ofstream out(unpacked.scene, std::ios::binary);
        out << text;
        out.close();
        if (!out) return Error{unpacked.scene.string() + ": cannot be written; is the disk full?"};
        remember(unpacked.scene, {from_});
        unpacked.originals = std::move(originals_);
        return {};
    }

  private:
    /// Its new path, as the scene names it. A file that several keys name is written once.
    Result<std::string> write_again(const std::string& path, const std::string& section, const std::string& key,
                                    int band) {
        const auto wanted = wanted_for(section, key, band);
        const std::string use = wanted ? wanted->purpose : "table";
        if (const auto known = written_.find({path, use}); known != written_.end()) return known->second;
        const std::string stem = free_stem(fs::path(path));
        std::error_code error;
        fs::create_directories(to_ / "data", error);
        fs::path made;
        std::vector<fs::path> before = {path};
        if (wanted) {
            TALUS_ASSIGN(const auto converted, geo::convert_foreign(path, *wanted, to_ / "data" / stem, reader_));
            made = converted.file;
            before.insert(before.end(), converted.parts.begin(), converted.parts.end());
        } else {
            made = to_ / "data" / (stem + fs::path(path).extension().string());
            fs::copy_file(path, made, error);
            if (error) return Error{made.string() + ": cannot be written: " + error.message()};
        }
        remember(made, before);
        return written_[{path, use}] = "data/" + made.filename().string();
    }

    std::string free_stem(const fs::path& file) {
        std::string name = file.stem().string();
        for (const char* ending : {".city", ".roofs"}) {
            if (name.ends_with(ending)) name.resize(name.size() - std::string_view(ending).size());
        }
        std::string stem = name.empty() ? "file" : name;
        for (int k = 2; !stems_.insert(stem).second; ++k) stem = fmt::format("{}-{}", name, k);
        return stem;
    }

    void remember(const fs::path& made, const std::vector<fs::path>& before) {
        Scene recorded;
        for (const fs::path& file : before) record_input("", file.string(), recorded);
        for (InputFile& input : recorded.inputs) {
            input.path = (to_ / fs::path(input.path).lexically_relative(from_.parent_path())).string();
        }
        originals_.push_back({made.string(), std::move(recorded.inputs)});
    }

    const fs::path from_, to_;  // the scene file of the archive; the folder of the new one
    const geo::ForeignReader& reader_;
    std::map<std::pair<std::string, std::string>, std::string> written_;
    std::set<std::string> stems_;
    std::vector<OriginalInput> originals_;
};

}  // namespace

Result<Unpacked> unpack_bundle(const fs::path& archive, const fs::path& folder, const geo::ZipLimits& limits,
                               const geo::ForeignReader& reader) {
    const fs::path foreign = folder / "archive";
    std::error_code ignored;
    Unpacked unpacked;
    const auto work = [&]() -> Status {
        TALUS_TRY(geo::unpack_zip(archive, foreign, limits));
        TALUS_ASSIGN(const fs::path scene, find_scene_in(foreign, archive));
        return Rewriting(scene, folder, reader).rewrite(archive, unpacked);
    };
    const Status done = work();
    fs::remove_all(foreign, ignored);
    if (done) return Result<Unpacked>(std::move(unpacked));
    // The folder may have been there before: what is in it is this function's alone.
    for (const auto& entry : fs::directory_iterator(folder, ignored)) fs::remove_all(entry.path(), ignored);
    fs::remove(folder, ignored);
    // In a message the archive stands for the folder that is gone.
    std::string message = done.error().message;
    const std::string place = (foreign / "").string();
    for (std::size_t at = 0; (at = message.find(place, at)) != std::string::npos; at += archive.string().size()) {
        message.replace(at, place.size(), archive.string() + "/");
    }
    return Error{std::move(message)};
}

void name_originals(Scene& scene, const std::vector<OriginalInput>& originals) {
    std::vector<InputFile> inputs;
    for (InputFile& input : scene.inputs) {
        const auto found = std::find_if(originals.begin(), originals.end(),
                                        [&](const OriginalInput& original) { return original.file == input.path; });
        if (found == originals.end()) {
            inputs.push_back(std::move(input));
            continue;
        }
        for (const InputFile& before : found->before) {
            inputs.push_back({input.role + before.role, before.path, before.bytes, before.hash});
        }
    }
    scene.inputs = std::move(inputs);
    std::map<std::string, std::string> names;
    for (const OriginalInput& original : originals) names[original.file] = original.before.front().path;
    params::replace_paths(scene.spec, [&](const std::string& path) {
        const auto name = names.find(path);
        return name != names.end() ? name->second : path;
    });
}

Status check_saved_overrides(const fs::path& scene_file, const std::vector<std::string>& overrides) {
    if (overrides.empty()) return {};
    TALUS_ASSIGN(const auto own, parse_scene(scene_file, {}));
    std::set<std::string> named = paths_of(own);
    for (const params::VariantSpec& variant : own.variants) {
        TALUS_ASSIGN(const auto other, parse_scene(scene_file, {choosing(variant)}));
        named.merge(paths_of(other));
    }
    TALUS_ASSIGN(const auto parsed, parse_scene_with_places(scene_file, overrides));
    Status outside;
    params::for_each_path(parsed.spec, [&](const params::Section& section, std::size_t index,
                                           const params::Parameter& parameter, const std::string& path) {
        if (!outside || named.contains(path)) return;
        outside = Error{fmt::format(
            "{}: the session sets a file that its scene does not name, {}; make a variant of the scene that names it",
            parsed.at(key_path(section, index, parameter)), one_line(path, 200))};
    });
    return outside;
}

}  // namespace talus::scene
