#include <chrono>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <span>
#include <string>

#include "core/hash.hpp"
#include "golden/hash_of.hpp"
#include "pack/pack.hpp"
#include "run/run_scene.hpp"

/// golden FILE...: runs packed scenes with the page's engine, and prints for each "FILE MOTION MEASUREMENTS", the
/// hashes of tests/golden, and how it was computed.
int main(int count, char** names) {
    for (const std::string name : std::span(names, static_cast<std::size_t>(count)).subspan(1)) {
        std::ifstream file(name, std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(file), {}};
        const auto packed = talus::pack::read(std::as_bytes(std::span(bytes)), name);
        if (!packed) {
            std::printf("%s\n", packed.error().message.c_str());
            return 2;
        }
        const auto begin = std::chrono::steady_clock::now();
        const auto result = talus::run::run_scene(packed->scene, {});
        if (!result) {
            std::printf("%s: %s\n", name.c_str(), result.error().message.c_str());
            return 2;
        }
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        std::printf("%s %s %s %s %.1f s of debris in %.2f s\n", name.c_str(), talus::to_hex(result->hash).c_str(),
                    talus::test::hash_of(result->observation).c_str(), result->instruction_set.c_str(),
                    result->simulated_time, seconds);
    }
    return 0;
}
