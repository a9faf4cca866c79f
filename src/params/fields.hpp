#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "params/spec.hpp"

/// The field table: every tunable of a scene, declared once in *fields.cpp. The parser, the scene writer, --help,
/// docs/scene-reference.md and the manifest all read it. Defaults are the member initialisers in spec.hpp.
namespace talus::params {

enum class ParameterKind { boolean, integer, number, text, path, choice, text_list, extent, points };

/// A value at the boundary of the program, in the unit of its key. monostate: not given. A choice is given as its text.
using ParameterValue = std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<std::string>,
                                    Extent, std::vector<PlanPoint>>;

/// The values a number may have.
struct Range {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    bool low_included = true;
    bool high_included = true;

    [[nodiscard]] bool contains(double value) const;
    /// "above 0", "greater than 0 and at most 1", "0 to below 1", "at least 1", "" when everything is allowed.
    [[nodiscard]] std::string text() const;
};

/// Display of a key in a form of the page. Slider, first value and unit are those of the page: a value times `factor`.
struct Form {
    std::string label;
    double slider_low = 0, slider_high = 0;
    double first = 0;    ///< initial value of an optional key when it is added
    std::string tick{};  ///< label of the check box that adds and removes an optional value
    std::string tick_help{};
    std::string unit{};  ///< empty: the usual one for the key's unit, such as kPa for Pa
    double factor = 1;   ///< with a unit of its own only
};

/// Another key without which a value has no effect.
struct Need {
    std::string key, value;  ///< "solver.internal_friction", "stress"
    std::string why;
    bool even_at_0 = false;  ///< also needed by a value of 0
};

/// What the two models make of a key.
enum class KeyUse {
    both,            ///< it changes what both compute, measure or say, or means nothing to a run
    particles,       ///< given for the depth-averaged model, it is named in a note
    depth_averaged,  ///< given for particles alone, it is named in a note
    refused,         ///< the depth-averaged model refuses a scene that gives it
};

/// One key of a scene file. Simple relations to other keys are declared here, and the page shows them next to the
/// field; all others are a Rule.
struct Parameter {
    std::string key;   ///< with its unit: "particle_spacing_m"
    std::string unit;  ///< "m", "" for a pure number or text
    ParameterKind kind = ParameterKind::number;
    bool required = false;
    Range range;
    std::vector<std::string> choices;
    std::string absent;      ///< what happens when it is not given, where there is no default value
    std::string help;        ///< one sentence
    std::string assumption;  ///< what a report calls the default, where the result rests on it and the scene sets none
    std::string live;        ///< the key by which people change it while a run goes on; empty: they cannot
    std::optional<Form> form;
    double spacings = 0;       ///< its minimum, in particle spacings
    std::string spacings_why;  ///< what happens otherwise
    std::string below;         ///< key of the same section that it must be below, where given
    std::optional<Need> need;
    std::vector<std::string> synonyms;  ///< what other programs and papers call it: "xi"
    KeyUse use = KeyUse::both;
    std::string lacking;  ///< why the depth-averaged model refuses it: "has no nets"

    Parameter& also_called(std::vector<std::string> names) {
        synonyms = std::move(names);
        return *this;
    }
    Parameter& assumes(std::string what) {
        assumption = std::move(what);
        return *this;
    }
    Parameter& at_least_spacings(double count, std::string why) {
        spacings = count;
        spacings_why = std::move(why);
        return *this;
    }
    Parameter& below_key(std::string other) {
        below = std::move(other);
        return *this;
    }
    Parameter& needs(Need what) {
        need = std::move(what);
        return *this;
    }

    Parameter& for_particles_only() {
        use = KeyUse::particles;
        return *this;
    }
    Parameter& for_depth_averaged_only() {
        use = KeyUse::depth_averaged;
        return *this;
    }
    Parameter& refused_by_depth_averaged(std::string why) {
        use = KeyUse::refused;
        lacking = std::move(why);
        return *this;
    }

    /// Makes it a live parameter under this key or, by default, its own.
    Parameter& live_as(std::string json_key = "") {
        live = json_key.empty() ? key : std::move(json_key);
        return *this;
    }
    /// The same, with a field in the page's form.
    Parameter& live_in(Form its_form, std::string json_key = "") {
        form = std::move(its_form);
        return live_as(std::move(json_key));
    }

    /// The value in the `index`-th entry of the section (0 where it does not repeat).
    std::function<ParameterValue(const SceneSpec&, std::size_t index)> get;
    /// Takes a value that `problem_with` accepts; monostate only if the parameter is optional.
    std::function<void(SceneSpec&, std::size_t index, const ParameterValue&)> set;
};

/// A rule that is broken.
struct Violation {
    std::string key;   ///< the key at fault, within its section
    std::string text;  ///< what follows the key: " = 0.1 is refused; it must be ...", ": exactly one of ..."
};

/// A rule between keys. `particle_spacing`: m, 0 while unknown.
using Rule = std::function<std::optional<Violation>(const SceneSpec&, std::size_t index, double particle_spacing)>;

/// Keys of which no two may be given.
struct Alternatives {
    std::vector<std::string> keys;
    bool required;       ///< one must be given; otherwise `--set` of one also replaces the scene file's
    std::string blamed;  ///< where none is
};

/// A table of a scene file: `[name]`, or `[[name]]` where it repeats.
struct Section {
    std::string name;
    bool repeats = false;
    std::string help;
    std::vector<Parameter> parameters;
    std::vector<Alternatives> alternatives;
    std::vector<Rule> rules;
    std::function<std::size_t(const SceneSpec&)> count;  ///< entries; 1 where it does not repeat
    std::function<void(SceneSpec&)> append;              ///< adds an entry with default values, where it repeats

    [[nodiscard]] const Parameter* find(std::string_view key) const;
};

/// The section and the place of a struct of the scene.
template <class Spec>
inline constexpr std::pair<const char*, std::vector<Spec> SceneSpec::*> section_of{"", nullptr};
template <>
inline constexpr std::pair section_of<ReleaseSpec>{"release", &SceneSpec::releases};
template <>
inline constexpr std::pair section_of<InflowSpec>{"inflow", &SceneSpec::inflows};
template <>
inline constexpr std::pair section_of<InflowSample>{"hydrograph", &SceneSpec::hydrograph};
template <>
inline constexpr std::pair section_of<BuildingSpec>{"buildings", &SceneSpec::buildings};
template <>
inline constexpr std::pair section_of<BarrierSpec>{"barrier", &SceneSpec::barriers};
template <>
inline constexpr std::pair section_of<BarrierOpeningSpec>{"barrier_opening", &SceneSpec::barrier_openings};
template <>
inline constexpr std::pair section_of<ZoneSpec>{"zone", &SceneSpec::zones};
template <>
inline constexpr std::pair section_of<BedSpec>{"bed", &SceneSpec::beds};

/// All sections in the order of the scene file.
[[nodiscard]] const std::vector<Section>& scene_sections();
[[nodiscard]] const Section* find_section(std::string_view name);

/// The sections that contain live parameters: those of a scene file, and tables that have a file of their own.
[[nodiscard]] const std::vector<Section>& live_sections();
[[nodiscard]] const Section& live_section(std::string_view name);

/// The declaration of an existing key.
[[nodiscard]] const Parameter& parameter_of(std::string_view section, std::string_view key);

/// The default, monostate where there is none.
[[nodiscard]] ParameterValue default_value(const Section& section, const Parameter& parameter);

/// Whether there is a value that is not empty.
[[nodiscard]] bool is_given(const ParameterValue& value);

/// The first set of alternatives of which too many are given, or none of those that are required; among all keys, or
/// among live parameters only.
[[nodiscard]] std::optional<Violation> wrong_choice(const Section& section, const SceneSpec& spec, std::size_t index,
                                                    bool live_only);

/// The first rule that an entry breaks. `particle_spacing`: m, 0 while unknown.
[[nodiscard]] std::optional<Violation> broken_rule(const Section& section, const SceneSpec& spec, std::size_t index,
                                                   double particle_spacing);

/// "release[0].thickness_m", "terrain.file".
[[nodiscard]] std::string key_path(const Section& section, std::size_t index, const Parameter& parameter);

/// The allowed values, as the end of "must be ...": "a number above 0 (m)", "one of \"spiky\", ...".
[[nodiscard]] std::string allowed_text(const Parameter& parameter);

/// Empty if the value (of the parameter's kind) is allowed, otherwise `allowed_text`.
[[nodiscard]] std::string problem_with(const Parameter& parameter, const ParameterValue& value);

/// The value as TOML writes it, exactly; "" for monostate.
[[nodiscard]] std::string toml_text(const ParameterValue& value);

/// The value for display: six digits, no quotes; "" for monostate.
[[nodiscard]] std::string plain_text(const ParameterValue& value);

/// Calls `visit(section, index, parameter, value)` for every key of the scene in file order.
void for_each_value(const SceneSpec& spec,
                    const std::function<void(const Section& section, std::size_t index, const Parameter& parameter,
                                             const ParameterValue& value)>& visit);

/// Keys of a section of which a word is a synonym, whatever its case, hyphens and underscores; empty: none.
[[nodiscard]] std::vector<std::string> keys_called(const Section& section, std::string_view word);

/// The candidate with the smallest edit distance to `word`, or to how it begins; empty without candidates.
[[nodiscard]] std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates);

/// Levenshtein's distance: insertions, deletions and replacements that turn `a` into `b`.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

}  // namespace talus::params
