#include "bench/figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>

#include <fmt/format.h>

#include "products/report_plot.hpp"

namespace talus::bench {
namespace {

constexpr double figure_width = 820, figure_height = 400, plot_left = 62, plot_top = 20, plot_width = 500,
                 plot_height = 320;

// Colours that colour-blind readers tell apart (Okabe & Ito 2008); dashes do it in print.
constexpr std::array<std::string_view, 8> colours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                     "#e69f00", "#56b4e9", "#000000", "#8c6bb1"};

struct Curve {
    std::vector<double> x, y;
};

std::string style() {
    std::string text =
        "svg{background:#fff}text{font:13px system-ui,sans-serif;fill:#333}.axis,.grid{stroke:#d8d8d8;fill:none}"
        ".decade{stroke:#d8d8d8}.series{fill:none;stroke-width:2.2}.mark{stroke:none}";
    for (std::size_t i = 0; i < colours.size(); ++i) {
        text += fmt::format(".c{0}{{stroke:{1}}}.mark.c{0}{{fill:{1}}}", i, colours[i]);
        if (i % 2 == 1) text += fmt::format(".series.c{}{{stroke-dasharray:6 4}}", i);
    }
    return "<style>" + text + "</style>";
}

/// "1,000", "20,000"
std::string grouped(double count) {
    std::string digits = fmt::format("{:.0f}", count);
    for (auto at = static_cast<long>(digits.size()) - 3; at > 0; at -= 3)
        digits.insert(static_cast<std::size_t>(at), ",");
    return digits;
}

}  // namespace

std::string scaling_svg(const std::vector<Row>& rows) {
    std::map<std::string, Curve> lines;
    report::ValueRange sizes{1e300, -1e300}, rates{0, 0};
    for (const Row& row : rows) {
        const double x = std::log10(row.particles), y = 1e-6 * row.particle_iterations_per_second();
        Curve& line =
            lines[fmt::format("{}, {}, {} thread{}", row.scene, row.method, row.threads, row.threads == 1 ? "" : "s")];
        line.x.push_back(x);
        line.y.push_back(y);
        sizes.include(x);
        rates.include(1.1 * y);
    }
    if (rows.empty()) sizes = {3, 6};
    sizes = {sizes.low - 0.1, sizes.high + 0.1};
    report::Plot plot(plot_left, plot_top, plot_width, plot_height, sizes, rates);
    plot.axes("", "million particle-iterations per second");
    for (int decade = static_cast<int>(std::ceil(sizes.low)); decade <= sizes.high; ++decade) {
        plot.vertical(decade, "decade");
        plot.label(decade, rates.low, 0, 18, "middle", "tick", grouped(std::pow(10, decade)));
    }
    plot.label((sizes.low + sizes.high) / 2, rates.low, 0, 40, "middle", "title", "particles");

    std::string keys;
    std::size_t i = 0;
    for (const auto& [name, line] : lines) {
        const std::string colour = fmt::format("c{}", i % colours.size());
        plot.line(line.x, line.y, "series " + colour);
        for (std::size_t k = 0; k < line.x.size(); ++k) plot.mark(line.x[k], line.y[k], "mark " + colour);
        const double y = plot_top + 14 + 24 * static_cast<double>(i);
        keys += fmt::format(R"(<line class="series {}" x1="{}" y1="{}" x2="{}" y2="{}"/><text x="{}" y="{}">{}</text>)",
                            colour, plot_left + plot_width + 14, y - 4, plot_left + plot_width + 40, y - 4,
                            plot_left + plot_width + 46, y, name);
        ++i;
    }
    return fmt::format(R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {} {}" role="img" )"
                       R"(aria-label="Particle-iterations per second against particles">{}{}{}</svg>)",
                       figure_width, figure_height, style(), plot.svg(), keys) +
           "\n";
}

}  // namespace talus::bench
