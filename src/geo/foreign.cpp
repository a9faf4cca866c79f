#include "geo/foreign.hpp"

#include <csignal>
#include <cstdio>
#include <memory>
#include <system_error>

#include <fmt/format.h>

#include "core/child_process.hpp"
#include "core/try.hpp"
#include "geo/foreign_data.hpp"

namespace talus::geo {
namespace {

namespace fs = std::filesystem;

constexpr int out_of_memory = 3;  // exit code of the child

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

/// How the child ended; empty: well.
std::string what_failed(const ChildOutcome& outcome, const ForeignReader& reader) {
    if (outcome.success()) return {};
    if (reader.shall_end && reader.shall_end()) return "cancelled";
    if (outcome.too_slow || outcome.signal == SIGXCPU) {
        return fmt::format("takes more than {} s to read; it is too large or malicious",
                           outcome.too_slow ? reader.patience.count() : reader.processor_time.count());
    }
    if (outcome.signal == SIGXFSZ)
        return fmt::format("has more than {:.3g} GB", static_cast<double>(reader.bytes) / 1e9);
    if (outcome.exit_code == out_of_memory) return "needs too much memory to be read";
    return "cannot be read: its reader ended unexpectedly; it is damaged or malicious";
}

}  // namespace

Result<ForeignFile> convert_foreign(const fs::path& file, const ForeignWanted& wanted, const fs::path& stem,
                                    const ForeignReader& reader) {
    std::error_code failed;
    ChildProcess child;
    child.program = reader.program.empty() ? fs::read_symlink("/proc/self/exe", failed) : reader.program;
    if (failed) return Error{file.string() + ": cannot be read: /proc is not mounted"};
    std::string kinds = "-";
    for (const auto& [is, letter] : {std::pair{wanted.raster, 'r'},
                                     {wanted.vector, 'v'},
                                     {wanted.mesh, 'm'},
                                     {wanted.picture, 'p'},
                                     {wanted.styles, 's'}}) {
        if (is) kinds += letter;
    }
    child.arguments = {foreign_word,
                       file.string(),
                       kinds,
                       std::to_string(wanted.bands),
                       fmt::format("{:.17g}", wanted.cells),
                       wanted.purpose,
                       reader.isolated ? "isolated" : "plain"};
    child.memory = reader.memory;
    child.processor_time = reader.processor_time;
    child.patience = reader.patience;
    child.largest_file = reader.bytes;
    child.output = stem.string() + ".numbers";
    child.shall_end = reader.shall_end;
    child.end_at_once = true;
    const auto outcome = run_child(child);
    const std::unique_ptr<std::FILE, CloseFile> numbers(std::fopen(child.output.c_str(), "rb"));
    const std::uintmax_t bytes = fs::file_size(child.output, failed);
    const bool there = !failed;
    fs::remove(child.output, failed);
    if (!outcome) return outcome.error();
    if (const std::string why = what_failed(*outcome, reader); !why.empty()) return Error{file.string() + ": " + why};
    if (!numbers || !there) return Error{file.string() + ": cannot be read; is the disk full?"};

    ForeignFile made;
    std::string name;
    std::vector<std::string> parts;
    const Status written = write_again(numbers.get(), bytes, stem.string(), wanted.cells,
                                       wanted.picture ? 5 : wanted.bands, name, parts, made.layers);
    if (!written) {
        // What the child says begins with the file already.
        const std::string& why = written.error().message;
        return Error{why.starts_with(file.string()) ? why : file.string() + ": " + why};
    }
    made.file = name;
    made.kind = made.file.extension() == ".tif"    ? FileKind::raster
                : made.file.extension() == ".gpkg" ? FileKind::vector
                                                   : FileKind::other;
    for (const std::string& part : parts) {
        const fs::path other = (file.parent_path() / part).lexically_normal();
        const fs::path inside = other.lexically_relative(file.parent_path().lexically_normal());
        if (!inside.empty() && *inside.begin() != ".." && fs::is_regular_file(other, failed))
            made.parts.push_back(other);
    }
    return made;
}

}  // namespace talus::geo
