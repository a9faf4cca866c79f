#pragma once

#include <string>

#include "core/result.hpp"
#include "geo/foreign_data.hpp"

/// The parts of the child process that reads foreign files. Not for other modules.
namespace talus::geo {

/// Formats of one file, or of files of one name, whose readers open nothing else that they name.
[[nodiscard]] bool is_plain_format(const std::string& name);
/// Those that can name other files, or whose readers are large: only where the kernel keeps this process from them.
[[nodiscard]] bool is_isolated_format(const std::string& name);
/// All other formats are forgotten: what a reader opens by itself, such as a mask or an overview, is one of these too.
void forget_other_formats(bool isolated);

/// Reads a file and hands it over. `isolated`: the kernel keeps this process from other files.
[[nodiscard]] Status read_foreign_file(const std::string& file, const ForeignWanted& wanted, bool isolated,
                                       ForeignOutput& out);

}  // namespace talus::geo
