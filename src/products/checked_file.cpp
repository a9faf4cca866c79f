#include "products/checked_file.hpp"

#include <iterator>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/hash.hpp"
#include "core/try.hpp"
#include "products/text_file.hpp"

namespace talus::products {
namespace {

std::string checked_first_line(const CheckedFileKind& kind, std::uint64_t checksum) {
    return std::string(kind.signature) + to_hex(checksum) + "\n";
}

/// Of everything after the first line. FNV-1a maps states to states one to one, so one changed byte changes the sum.
std::uint64_t rest_checksum(std::ifstream& in) {
    StateHash sum;
    std::vector<char> block(std::size_t{1} << 16);
    while (in.read(block.data(), static_cast<std::streamsize>(block.size())) || in.gcount() > 0) {
        sum.add(block.data(), static_cast<std::size_t>(in.gcount()));
    }
    return sum.value();
}

}  // namespace

Status write_checked_file(const std::filesystem::path& file, const CheckedFileKind& kind, std::string_view contents) {
    StateHash sum;
    sum.add(contents.data(), contents.size());
    std::string text = checked_first_line(kind, sum.value());
    text += contents;
    return replace_text_file(file, text);
}

Result<std::ifstream> open_checked_file(const std::filesystem::path& file, const CheckedFileKind& kind, Verify verify) {
    std::ifstream in(file, std::ios::binary);
    std::string first;
    if (!in || !std::getline(in, first)) return Error{file.string() + ": cannot be read"};
    if (!first.starts_with(kind.signature)) {
        return Error{fmt::format("{}: is no {}, or of another version", file.string(), kind.what)};
    }
    if (verify == Verify::bytes) {
        const std::streampos begin = in.tellg();
        if (first + "\n" != checked_first_line(kind, rest_checksum(in))) {
            return Error{file.string() + ": is damaged: its checksum is not that of its contents"};
        }
        in.clear();
        in.seekg(begin);
    }
    return Result<std::ifstream>(std::move(in));
}

Result<std::string> read_checked_file(const std::filesystem::path& file, const CheckedFileKind& kind) {
    TALUS_ASSIGN(auto in, open_checked_file(file, kind));
    return std::string(std::istreambuf_iterator<char>(in), {});
}

}  // namespace talus::products
