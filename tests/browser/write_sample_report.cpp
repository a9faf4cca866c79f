#include <cstdio>
#include <fstream>

#include "report/report_fixture.hpp"

// Writes the report of the sample valley to the file named, for the browser to open.
int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: write_sample_report FILE\n");
        return 2;
    }
    const talus::scene::Scene scene = talus::test::sample_scene();
    const talus::run::RunResult result = talus::test::sample_result(scene);
    std::ofstream file(argv[1], std::ios::binary);
    file << talus::test::report_page(scene, result, talus::test::sample_comparisons(scene, result));
    return file.flush() ? 0 : 1;
}
