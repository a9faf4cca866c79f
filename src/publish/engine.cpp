#include "publish/engine.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

// The assembler includes the files directly: as arrays of numbers they would take the compiler seconds.
#ifdef TALUS_ENGINE
__asm__(
    ".section .rodata\n"
    ".global talus_engine_script_begin\n"
    ".global talus_engine_script_end\n"
    ".global talus_engine_wasm_begin\n"
    ".global talus_engine_wasm_end\n"
    "talus_engine_script_begin:\n"
    ".incbin \"" TALUS_ENGINE
    ".js\"\n"
    "talus_engine_script_end:\n"
    "talus_engine_wasm_begin:\n"
    ".incbin \"" TALUS_ENGINE
    ".wasm\"\n"
    "talus_engine_wasm_end:\n"
    ".previous\n");
extern "C" {
extern const char talus_engine_script_begin[];
extern const char talus_engine_script_end[];
extern const char talus_engine_wasm_begin[];
extern const char talus_engine_wasm_end[];
}
#endif

namespace talus::publish {

std::optional<Engine> find_engine() {
#ifdef TALUS_ENGINE
    return Engine{{talus_engine_script_begin, talus_engine_script_end},
                  {talus_engine_wasm_begin, talus_engine_wasm_end}};
#else
    const auto read = [](const std::filesystem::path& file) {
        std::ifstream stream(file, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(stream), {});
    };
    std::error_code error;
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
    if (error) return {};
    const std::filesystem::path folder = program.parent_path().parent_path() / "share/talus/web_engine";
    Engine engine{read(folder / "talus_engine.js"), read(folder / "talus_engine.wasm")};
    if (engine.script.empty() || engine.wasm.empty()) return {};
    return engine;
#endif
}

}  // namespace talus::publish
