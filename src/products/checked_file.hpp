#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "core/result.hpp"

/// Files that only the program itself reads: a first line with a signature and the checksum of all that follows, so
/// that one that was damaged, cut or made by something else is refused.
namespace talus::products {

struct CheckedFileKind {
    std::string_view signature;  ///< "talus run 2 ": before the checksum
    std::string_view what;       ///< "record of a run", in errors
};

/// Under a temporary name first: a file with the final name is complete.
[[nodiscard]] Status write_checked_file(const std::filesystem::path& file, const CheckedFileKind& kind,
                                        std::string_view contents);

enum class Verify {
    bytes,   ///< also the checksum, for which the whole file is read
    header,  ///< of a file that this process has verified or written before
};

/// At the first byte of the contents. Errors: missing, of another kind or version, damaged.
[[nodiscard]] Result<std::ifstream> open_checked_file(const std::filesystem::path& file, const CheckedFileKind& kind,
                                                      Verify verify = Verify::bytes);

/// All contents. Errors as above.
[[nodiscard]] Result<std::string> read_checked_file(const std::filesystem::path& file, const CheckedFileKind& kind);

}  // namespace talus::products
