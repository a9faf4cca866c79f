#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "report/chart.hpp"
#include "report/svg.hpp"
#include "risk/criteria.hpp"
#include "risk/risk_products.hpp"

namespace talus::risk {
namespace {

using report::coordinate;

/// Logarithmic axes over whole powers of ten.
struct Axes {
    int most_deaths = 3;        // power of ten
    int least = -9, most = -1;  // powers of ten of the frequency
    double left = 92, top = 16, width = 560, height = 400;

    [[nodiscard]] double x(double deaths) const { return left + width * std::log10(deaths) / most_deaths; }
    [[nodiscard]] double y(double frequency) const {
        const double f = std::clamp(std::log10(frequency), static_cast<double>(least), static_cast<double>(most));
        return top + height * (most - f) / (most - least);
    }
};

std::string power(int exponent) {
    static constexpr std::array<const char*, 10> raised = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    if (exponent == 0) return "1";
    return fmt::format("10{}{}", exponent < 0 ? "⁻" : "", raised.at(static_cast<std::size_t>(std::abs(exponent)) % 10));
}

void draw_axes(report::Svg& svg, const Axes& axes) {
    const double right = axes.left + axes.width, bottom = axes.top + axes.height;
    for (int k = axes.least; k <= axes.most; ++k) {
        const double y = axes.y(std::pow(10, k));
        svg.line("grid", axes.left, y, right, y);
        svg.text("tick", axes.left - 8, y + 4, power(k), "end");
    }
    for (int k = 0; k <= axes.most_deaths; ++k) {
        const double x = axes.x(std::pow(10, k));
        svg.line("grid", x, axes.top, x, bottom);
        svg.text("tick", x, bottom + 18, k < 4 ? fmt::format("{:.0f}", std::pow(10, k)) : power(k), "middle");
    }
    svg.line("axis", axes.left, bottom, right, bottom);
    svg.line("axis", axes.left, axes.top, axes.left, bottom);
    svg.text("axis-title", axes.left + axes.width / 2, bottom + 40, "Deaths in an event, N", "middle");
    svg.turned_text("axis-title", 22, axes.top + axes.height / 2, -90, "Events per year with N deaths or more",
                    "middle");
}

/// The line c / N of a criterion, within the axes.
void draw_limit(report::Svg& svg, const Axes& axes, double at_1, double most_deaths, const char* style,
                const std::string& name) {
    const double floor = std::pow(10, axes.least);
    const double last = std::min({most_deaths, at_1 / floor, std::pow(10.0, axes.most_deaths)});
    svg.line(style, axes.x(1), axes.y(at_1), axes.x(last), axes.y(at_1 / last));
    const double deaths = std::pow(10, 0.62 * axes.most_deaths);
    if (deaths < last) svg.text("note", axes.x(deaths) + 6, axes.y(at_1 / deaths) - 6, name);
}

std::string steps(const Axes& axes, const std::vector<double>& f) {
    std::string path;
    const double floor = std::pow(10, axes.least);
    for (std::size_t n = 1; n < f.size() && f[n] > floor; ++n) {
        const auto deaths = static_cast<double>(n);
        const double from = n == 1 ? axes.x(1) : axes.x(deaths - 1);
        path += fmt::format("{}{} {}", path.empty() ? "M" : "L", coordinate(from), coordinate(axes.y(f[n])));
        path += fmt::format("L{} {}", coordinate(axes.x(deaths)), coordinate(axes.y(f[n])));
    }
    return path;
}

}  // namespace

std::string fn_svg(const StudyResult& result) {
    double most = 1e-4, deaths = 10;
    for (const Risk& risk : result.risks) {
        for (std::size_t n = 1; n < risk.deaths_at_least.size(); ++n) {
            if (!(risk.deaths_at_least[n] > 1e-9)) break;
            most = std::max(most, risk.deaths_at_least[n]);
            deaths = std::max(deaths, static_cast<double>(n));
        }
    }
    const Criteria* criteria = criteria_of(result.scene().spec.risk.criteria);
    Axes axes;
    axes.most = std::max(-2, static_cast<int>(std::ceil(std::log10(most))));
    axes.most_deaths = std::max(criteria != nullptr ? 3 : 1, static_cast<int>(std::ceil(std::log10(deaths))));
    report::Svg svg;
    draw_axes(svg, axes);
    if (criteria != nullptr) {
        draw_limit(svg, axes, criteria->unacceptable_at_1, criteria->most_deaths, "series red", "unacceptable above");
        draw_limit(svg, axes, criteria->acceptable_at_1, criteria->most_deaths, "series green",
                   "broadly acceptable below");
    }
    double key = axes.top + 14;
    for (std::size_t k = 0; k < result.risks.size(); ++k) {
        const std::string style = fmt::format("series v{}", k % 8);
        if (const std::string path = steps(axes, result.risks[k].deaths_at_least); !path.empty()) {
            svg.path(style, path, result.name_of(k));
        }
        const double x = axes.left + axes.width + 22;
        svg.line(style, x, key - 4, x + 26, key - 4);
        svg.text("key", x + 34, key, report::shortened(result.name_of(k), 34));
        key += 22;
    }
    return figure_svg(940, axes.top + axes.height + 54, "F-N curves", svg);
}

}  // namespace talus::risk
