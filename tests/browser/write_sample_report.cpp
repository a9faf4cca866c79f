#include <cstdio>
#include <fstream>

#include "products/products.hpp"
#include "products/report_fixture.hpp"

// Writes the report of the sample valley to the file named, for the browser to open.
int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: write_sample_report FILE\n");
        return 2;
    }
    const talus::Scene scene = talus::test::sample_scene();
    const talus::RunResult result = talus::test::sample_result(scene);
    const auto html = talus::render_report(scene, result, talus::test::sample_comparisons(scene, result));
    if (!html) {
        std::fprintf(stderr, "%s\n", html.error().message.c_str());
        return 1;
    }
    std::ofstream file(argv[1], std::ios::binary);
    file << *html;
    return file.flush() ? 0 : 1;
}
