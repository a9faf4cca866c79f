// A program of libFuzzer for one target, TALUS_FUZZ_TARGET.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const talus::fuzz::Target* const target = [] {
        for (const talus::fuzz::Target& one : talus::fuzz::targets()) {
            if (std::string_view(one.name) == TALUS_FUZZ_TARGET) return &one;
        }
        std::fprintf(stderr, "there is no target " TALUS_FUZZ_TARGET "\n");
        std::abort();
    }();
    (void)target->run({reinterpret_cast<const char*>(data), size});
    return 0;
}
