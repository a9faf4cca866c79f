#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "params/fields.hpp"

/// Helpers with which the files of this folder declare the sections of the field table.
namespace talus::params {

constexpr Range above(double low) {
    return {.low = low, .low_included = false};
}
constexpr Range at_least(double low) {
    return {.low = low};
}
constexpr Range between(double low, double high) {
    return {.low = low, .high = high};
}
constexpr Range above_to(double low, double high) {
    return {.low = low, .high = high, .low_included = false};
}
constexpr Range from_to_below(double low, double high) {
    return {.low = low, .high = high, .high_included = false};
}
constexpr Range anything() {
    return {};
}

template <class Member>
constexpr ParameterKind kind_of() {
    if constexpr (std::is_same_v<Member, bool>) return ParameterKind::boolean;
    if constexpr (std::is_same_v<Member, int>) return ParameterKind::integer;
    if constexpr (std::is_same_v<Member, std::string>) return ParameterKind::text;
    if constexpr (std::is_same_v<Member, std::vector<std::string>>) return ParameterKind::text_list;
    if constexpr (std::is_same_v<Member, Extent>) return ParameterKind::extent;
    if constexpr (std::is_same_v<Member, std::vector<PlanPoint>>) return ParameterKind::points;
    return ParameterKind::number;
}

template <class Member>
ParameterValue to_value(const Member& member) {
    if constexpr (std::is_same_v<Member, int>) {
        return static_cast<std::int64_t>(member);
    } else {
        return member;
    }
}

template <class Member>
Member from_value(const ParameterValue& value) {
    if constexpr (std::is_same_v<Member, int>) {
        return static_cast<int>(std::get<std::int64_t>(value));
    } else if constexpr (std::is_same_v<Member, std::vector<PlanPoint>>) {
        return std::holds_alternative<std::monostate>(value) ? Member{} : std::get<Member>(value);  // none are none
    } else {
        return std::get<Member>(value);
    }
}

/// Declares the keys of one section; `Struct` is its part of the SceneSpec.
template <class Struct>
class Declaration {
  public:
    Declaration(std::string name, std::string help, Struct SceneSpec::*part) {
        section_.name = std::move(name);
        section_.help = std::move(help);
        section_.count = [](const SceneSpec&) { return std::size_t{1}; };
        part_ = [part](SceneSpec& spec, std::size_t) -> Struct& { return spec.*part; };
    }

    Declaration(std::string name, std::string help, std::vector<Struct> SceneSpec::*parts) {
        section_.name = std::move(name);
        section_.help = std::move(help);
        section_.repeats = true;
        section_.count = [parts](const SceneSpec& spec) { return (spec.*parts).size(); };
        section_.append = [parts](SceneSpec& spec) { (spec.*parts).emplace_back(); };
        part_ = [parts](SceneSpec& spec, std::size_t index) -> Struct& { return (spec.*parts)[index]; };
    }

    /// A key that always has a value.
    template <class Holder, class Member>
    Parameter& key(std::string name, std::string unit, Member Holder::*member, Range range, std::string help) {
        static_assert(std::is_base_of_v<Holder, Struct>);
        Parameter& p = add(std::move(name), std::move(unit), kind_of<Member>(), range, std::move(help));
        p.get = [part = part_, member](const SceneSpec& spec, std::size_t index) {
            return to_value(part(const_cast<SceneSpec&>(spec), index).*member);
        };
        p.set = [part = part_, member](SceneSpec& spec, std::size_t index, const ParameterValue& value) {
            part(spec, index).*member = from_value<Member>(value);
        };
        return p;
    }

    /// A key without a default value; `absent` describes what happens then.
    template <class Member>
    Parameter& optional_key(std::string name, std::string unit, std::optional<Member> Struct::*member, Range range,
                            std::string absent, std::string help) {
        Parameter& p = add(std::move(name), std::move(unit), kind_of<Member>(), range, std::move(help));
        p.absent = std::move(absent);
        p.get = [part = part_, member](const SceneSpec& spec, std::size_t index) -> ParameterValue {
            const std::optional<Member>& value = part(const_cast<SceneSpec&>(spec), index).*member;
            return value ? to_value(*value) : ParameterValue{};
        };
        p.set = [part = part_, member](SceneSpec& spec, std::size_t index, const ParameterValue& value) {
            std::optional<Member>& target = part(spec, index).*member;
            if (std::holds_alternative<std::monostate>(value)) {
                target.reset();
            } else {
                target = from_value<Member>(value);
            }
        };
        return p;
    }

    /// A text whose emptiness means "not given".
    Parameter& text(std::string name, std::string Struct::*member, std::string absent, std::string help) {
        Parameter& p = add(std::move(name), "", ParameterKind::text, {}, std::move(help));
        p.absent = std::move(absent);
        p.get = [part = part_, member](const SceneSpec& spec, std::size_t index) -> ParameterValue {
            const std::string& value = part(const_cast<SceneSpec&>(spec), index).*member;
            return value.empty() ? ParameterValue{} : ParameterValue{value};
        };
        p.set = [part = part_, member](SceneSpec& spec, std::size_t index, const ParameterValue& value) {
            const auto* given = std::get_if<std::string>(&value);
            part(spec, index).*member = given ? *given : std::string{};
        };
        return p;
    }

    /// A file; relative ones are taken from the scene file's folder.
    Parameter& path(std::string name, std::string Struct::*member, std::string absent, std::string help) {
        Parameter& p = text(std::move(name), member, std::move(absent), std::move(help));
        p.kind = ParameterKind::path;
        return p;
    }

    /// One of several texts, in the order of the enumeration.
    template <class Enum>
    Parameter& choice(std::string name, Enum Struct::*member, const std::vector<std::string>& choices,
                      std::string help) {
        Parameter& p = add(std::move(name), "", ParameterKind::choice, {}, std::move(help));
        p.choices = choices;
        p.get = [part = part_, member, choices](const SceneSpec& spec, std::size_t index) -> ParameterValue {
            return choices[static_cast<std::size_t>(part(const_cast<SceneSpec&>(spec), index).*member)];
        };
        p.set = [part = part_, member, choices](SceneSpec& spec, std::size_t index, const ParameterValue& value) {
            for (std::size_t i = 0; i < choices.size(); ++i) {
                if (choices[i] == std::get<std::string>(value)) part(spec, index).*member = static_cast<Enum>(i);
            }
        };
        return p;
    }

    /// `blamed`: the key to name where none is given.
    void exactly_one_of(std::vector<std::string> keys, std::string blamed = "") {
        if (blamed.empty()) blamed = keys.front();
        section_.alternatives.push_back({std::move(keys), true, std::move(blamed)});
    }

    void at_most_one_of(std::vector<std::string> keys) {
        section_.alternatives.push_back({std::move(keys), false, ""});
    }

    /// `problem(entry, scene, particle_spacing)` is a std::optional<Violation>.
    template <class Problem>
    void rule(Problem problem) {
        section_.rules.push_back([part = part_, problem](const SceneSpec& spec, std::size_t index, double spacing) {
            return std::optional<Violation>(problem(part(const_cast<SceneSpec&>(spec), index), spec, spacing));
        });
    }

    /// All keys so far.
    void for_particles_only() {
        for (Parameter& parameter : section_.parameters) parameter.for_particles_only();
    }

    [[nodiscard]] Section take() { return std::move(section_); }

  private:
    Parameter& add(std::string name, std::string unit, ParameterKind kind, Range range, std::string help) {
        Parameter& p = section_.parameters.emplace_back();
        p.key = std::move(name);
        p.unit = std::move(unit);
        p.kind = kind;
        p.range = range;
        p.help = std::move(help);
        return p;
    }

    Section section_;
    std::function<Struct&(SceneSpec&, std::size_t)> part_;
};

/// Friction by pairs does not support it.
[[nodiscard]] inline Need stress(bool even_at_0 = false) {
    return {"solver.internal_friction", "stress", "friction by pairs has no such law", even_at_0};
}

/// Of entries that results, messages or the command line name.
template <class Spec>
[[nodiscard]] std::optional<Violation> name_twice(const Spec& entry, const std::vector<Spec>& all) {
    const auto same =
        std::count_if(all.begin(), all.end(), [&](const Spec& other) { return other.name == entry.name; });
    if (same == 1) return {};
    return Violation{"name",
                     " = \"" + entry.name + "\" is refused; " + std::to_string(same) + " entries have that name"};
}

/// Sources of debris.
[[nodiscard]] Section declare_release();
[[nodiscard]] Section declare_inflow();
[[nodiscard]] Section declare_hydrograph();
[[nodiscard]] Section declare_bed();

/// Obstacles.
[[nodiscard]] Section declare_buildings();
[[nodiscard]] Section declare_barrier();
[[nodiscard]] Section declare_barrier_opening();

/// Material, and ground that differs.
[[nodiscard]] Section declare_material();
[[nodiscard]] Section declare_zone();

/// What is recorded at places, and particles in one area only.
[[nodiscard]] Section declare_gauge();
[[nodiscard]] Section declare_cross_section();
[[nodiscard]] Section declare_zoom();

/// The sections of field observations.
[[nodiscard]] std::vector<Section> declare_observations();

/// What a live run listens to, and what it tells.
[[nodiscard]] Section declare_trigger();
[[nodiscard]] Section declare_alarm();

/// Options, and what is at risk.
[[nodiscard]] Section declare_option();
[[nodiscard]] Section declare_risk();
[[nodiscard]] Section declare_risk_scenario();
[[nodiscard]] Section declare_exposure();

}  // namespace talus::params
