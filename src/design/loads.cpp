#include "design/loads.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "design_load_files.hpp"

namespace talus::design {
namespace {

constexpr double gravity = 9.81;
constexpr std::array<std::string_view, 5> kinds = {"hydrodynamic", "hydrostatic", "mixed", "run_up", "boulder"};

std::vector<LoadMethod> read_methods() {
    const toml::table root = toml::parse(design_load_files::loads_toml);
    std::vector<LoadMethod> methods;
    for (const toml::node& entry : *root["load"].as_array()) {
        const toml::table& table = *entry.as_table();
        const auto text = [&](const char* key) { return table[key].value_or(std::string()); };
        LoadMethod method;
        method.name = text("name");
        method.title = text("title");
        const auto kind = std::find(kinds.begin(), kinds.end(), text("kind"));
        method.kind = static_cast<LoadKind>(kind - kinds.begin());
        method.coefficient = table["coefficient"].value_or(std::numeric_limits<double>::quiet_NaN());
        method.source = text("source");
        method.note = text("note");
        method.checked = text("checked") == "text";
        methods.push_back(std::move(method));
    }
    return methods;
}

}  // namespace

std::string LoadMethod::formula() const {
    const std::string c = coefficient == 1 ? "" : fmt::format("{:g} ", coefficient);
    switch (kind) {
        case LoadKind::hydrodynamic:
            return c + "ρ v²";
        case LoadKind::hydrostatic:
            return c + "ρ g h";
        case LoadKind::mixed:
            return c + "ρ v⁰·⁸ (g h)⁰·⁶";
        case LoadKind::run_up:
            return c + "v² / 2g";
        case LoadKind::boulder:
            return fmt::format("{:g} · 4000 v¹·² r² kN", coefficient);
    }
    return "";
}

Load load_of(const LoadMethod& method, const Approach& a) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    Load load{none, none, none, none};
    switch (method.kind) {
        case LoadKind::hydrodynamic:
            load.pressure = method.coefficient * a.density * a.speed * a.speed;
            load.force_per_metre = load.pressure * a.depth;
            break;
        case LoadKind::hydrostatic:
            load.pressure = method.coefficient * a.density * gravity * a.depth;
            load.force_per_metre = load.pressure * a.depth / 2;
            break;
        case LoadKind::mixed:
            load.pressure = method.coefficient * a.density * std::pow(a.speed, 0.8) * std::pow(gravity * a.depth, 0.6);
            load.force_per_metre = load.pressure * a.depth;
            break;
        case LoadKind::run_up:
            load.height = method.coefficient * a.speed * a.speed / (2 * gravity);
            break;
        case LoadKind::boulder:
            if (a.boulder_diameter) {
                const double radius = *a.boulder_diameter / 2;
                load.force = 1e3 * method.coefficient * 4000 * std::pow(a.speed, 1.2) * radius * radius;
            }
            break;
    }
    return load;
}

const std::vector<LoadMethod>& load_methods() {
    static const std::vector<LoadMethod> methods = read_methods();
    return methods;
}

}  // namespace talus::design
