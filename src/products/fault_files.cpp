#include "products/fault_files.hpp"

#include <system_error>

#include <fmt/format.h>

#include "core/try.hpp"
#include "products/text_file.hpp"

namespace talus::products {

Status write_fault(const run::FaultRecord& record, const std::filesystem::path& folder) {
    std::error_code failed;
    std::filesystem::create_directories(folder, failed);
    if (failed) return Error{fmt::format("{}: cannot be made: {}", folder.string(), failed.message())};
    TALUS_TRY(write_text_file(folder / "last_good_state.csv", record.state_table));
    return write_text_file(folder / "fault.json", record.content.dump(1) + "\n");
}

}  // namespace talus::products
