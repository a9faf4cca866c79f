#include "bench/figure.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "report/chart.hpp"

namespace talus::bench {
namespace {

struct Measured {
    std::vector<double> x, y;
};

/// "1,000", "20,000"
std::string grouped(double count) {
    std::string digits = fmt::format("{:.0f}", count);
    for (auto at = static_cast<long>(digits.size()) - 3; at > 0; at -= 3)
        digits.insert(static_cast<std::size_t>(at), ",");
    return digits;
}

}  // namespace

std::string scaling_svg(const std::vector<Row>& rows) {
    std::map<std::string, Measured> lines;
    report::ValueRange sizes{1e300, -1e300}, rates{0, 0};
    for (const Row& row : rows) {
        const double x = std::log10(row.particles), y = 1e-6 * row.particle_iterations_per_second();
        Measured& line =
            lines[fmt::format("{}, {}, {} thread{}", row.scene, row.method, row.threads, row.threads == 1 ? "" : "s")];
        line.x.push_back(x);
        line.y.push_back(y);
        sizes.include(x);
        rates.include(1.1 * y);
    }
    if (rows.empty()) sizes = {3, 6};
    sizes = {sizes.low - 0.1, sizes.high + 0.1};
    report::Plot plot(62, 20, 500, 320, sizes, rates);
    plot.axes("", "million particle-iterations per second");
    plot.key = report::Plot::Key::beside;
    for (int decade = static_cast<int>(std::ceil(sizes.low)); decade <= sizes.high; ++decade) {
        plot.vertical(decade, "grid");
        plot.label(decade, rates.low, 0, 18, "middle", "tick", grouped(std::pow(10, decade)));
    }
    plot.label((sizes.low + sizes.high) / 2, rates.low, 0, 40, "middle", "axis-title", "particles");
    constexpr std::size_t colours = 8;
    std::size_t i = 0;
    for (const auto& [name, line] : lines) {
        const std::size_t k = i++ % colours;
        // Dashes distinguish lines in print.
        plot.line(line.x, line.y, fmt::format("series v{}{}", k, k % 2 == 1 ? " dashed" : ""), name);
        for (std::size_t at = 0; at < line.x.size(); ++at)
            plot.mark(line.x[at], line.y[at], fmt::format("mark v{}", k));
    }
    return report::chart_file({"Particle-iterations per second against particles", 820, 400, {std::move(plot)}});
}

}  // namespace talus::bench
