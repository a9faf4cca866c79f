#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/try.hpp"
#include "scene/parse.hpp"
#include "scene/toml_file.hpp"
#include "validate/kind.hpp"

namespace talus::validate {
namespace {

/// Reads the keys of one table. The first problem is kept; getters continue with defaults.
class TableReader {
  public:
    TableReader(std::string file, std::string header, const toml::table& table)
        : file_(std::move(file)), header_(std::move(header)), table_(table) {}

    std::string text(const std::string& key, bool required) {
        const toml::node* node = find(key, required, "a text, not empty");
        if (node == nullptr) return {};
        const auto value = node->value_exact<std::string>();
        if (!value || value->empty()) refuse(key, *node, "a text, not empty");
        return value.value_or("");
    }

    bool boolean(const std::string& key, bool fallback) {
        const toml::node* node = find(key, false, "");
        if (node == nullptr) return fallback;
        const auto value = node->value_exact<bool>();
        if (!value) refuse(key, *node, "true or false");
        return value.value_or(fallback);
    }

    /// A text or several; one empty text where the key is absent.
    std::vector<std::string> texts(const std::string& key) {
        const toml::node* node = find(key, false, "");
        if (node == nullptr) return {""};
        std::vector<std::string> values;
        const toml::array* items = node->as_array();
        if (items == nullptr) return {text(key, false)};
        for (const toml::node& item : *items) {
            const auto value = item.value_exact<std::string>();
            if (value && !value->empty()) values.push_back(*value);
        }
        if (values.empty() || values.size() != items->size()) refuse(key, *node, "a text or a list of texts");
        return values;
    }

    std::optional<double> number(const std::string& key, const params::Range& range) {
        const toml::node* node = find(key, false, "");
        if (node == nullptr) return std::nullopt;
        const auto value = node->is_number() ? node->value<double>() : std::nullopt;
        if (value && std::isfinite(*value) && range.contains(*value)) return value;
        params::Parameter parameter;
        parameter.range = range;
        refuse(key, *node, allowed_text(parameter));
        return std::nullopt;
    }

    std::string choice(const std::string& key, const std::vector<std::string>& choices, bool required) {
        const std::string allowed = fmt::format("one of \"{}\"", fmt::join(choices, "\", \""));
        const toml::node* node = find(key, required, allowed);
        if (node == nullptr) return {};
        const auto value = node->value_exact<std::string>();
        if (value && std::find(choices.begin(), choices.end(), *value) != choices.end()) return *value;
        refuse(key, *node, allowed);
        return {};
    }

    void problem(const std::string& text) {
        if (problem_.empty()) problem_ = place(table_) + ": " + text;
    }

    /// The first problem, otherwise the first unused key.
    [[nodiscard]] Status check() const {
        if (!problem_.empty()) return Error{problem_};
        for (const auto& [key, node] : table_) {
            const std::string name(key.str());
            if (std::find(asked_.begin(), asked_.end(), name) != asked_.end()) continue;
            return Error{fmt::format("{}:{}: unknown key \"{}\" in {}; nearest known key: {}", file_,
                                     key.source().begin.line, scene::one_line(name, 80), header_,
                                     params::nearest_word(name, asked_))};
        }
        return {};
    }

  private:
    const toml::node* find(const std::string& key, bool required, const std::string& allowed) {
        asked_.push_back(key);
        const toml::node* node = table_.get(key);
        if (node == nullptr && required) problem(fmt::format("{} is missing; it must be {}", key, allowed));
        return node;
    }
    [[nodiscard]] std::string place(const toml::node& node) const {
        return fmt::format("{}:{}", file_, node.source().begin.line);
    }
    void refuse(const std::string& key, const toml::node& node, const std::string& allowed) {
        if (!problem_.empty()) return;
        problem_ =
            fmt::format("{}: {} = {} is refused; it must be {}", place(node), key, scene::toml_text_of(node), allowed);
    }

    std::string file_, header_;
    const toml::table& table_;
    std::vector<std::string> asked_;
    std::string problem_;
};

Parameters::Value to_value(const toml::node& node) {
    if (node.is_number()) return *node.value<double>();
    if (const auto text = node.value_exact<std::string>()) return *text;
    const toml::array* items = node.as_array();
    if (items == nullptr || items->empty()) return {};
    std::vector<double> numbers;
    std::vector<NumberPair> pairs;
    for (const toml::node& item : *items) {
        const toml::array* pair = item.as_array();
        if (item.is_number()) {
            numbers.push_back(*item.value<double>());
        } else if (pair != nullptr && pair->size() == 2 && pair->get(0)->is_number() && pair->get(1)->is_number()) {
            pairs.push_back({*pair->get(0)->value<double>(), *pair->get(1)->value<double>()});
        }
    }
    if (numbers.size() == items->size()) return numbers;
    if (pairs.size() == items->size()) return pairs;
    return {};
}

template <class Items, class Name>
std::vector<std::string> names_of(const Items& items, const Name& name) {
    std::vector<std::string> names;
    names.reserve(std::size(items));
    for (const auto& item : items) names.emplace_back(name(item));
    return names;
}

class CaseReader {
  public:
    explicit CaseReader(const std::filesystem::path& folder) : file_(folder / "case.toml") {
        const std::filesystem::path whole = std::filesystem::absolute(folder).lexically_normal();
        case_.folder = folder;
        case_.name = (whole.has_filename() ? whole : whole.parent_path()).filename().string();
    }

    Result<Case> read() {
        TALUS_ASSIGN(const toml::table root, scene::read_toml_file(file_, "case"));
        TALUS_TRY(check_sections(root));
        TALUS_TRY(read_case(root));
        spec_.solver.rest_duration = 0;  // many cases test whether heaps stand
        TALUS_TRY(read_scene_section(root, "material"));
        TALUS_TRY(read_scene_section(root, "solver"));
        TALUS_TRY(read_expectations(root));
        Parameters parameters(file_, parameter_entries(root));
        setting_.expectations = case_.expectations;
        setting_.material = spec_.material;
        setting_.solver = spec_.solver;
        case_.compute = kind_->prepare(parameters, setting_);
        TALUS_TRY(parameters.check());
        return Result<Case>(std::move(case_));
    }

  private:
    [[nodiscard]] std::string at(const toml::source_region& region) const {
        return fmt::format("{}:{}", file_.string(), region.begin.line);
    }

    [[nodiscard]] Status check_sections(const toml::table& root) const {
        const std::vector<std::string> sections = {"case", "parameters", "material", "solver", "expect"};
        for (const auto& [key, node] : root) {
            const std::string name(key.str());
            if (std::find(sections.begin(), sections.end(), name) == sections.end()) {
                return Error{fmt::format("{}: unknown section \"{}\"; nearest known section: {}", at(key.source()),
                                         scene::one_line(name, 80), params::nearest_word(name, sections))};
            }
            const bool right = name == "expect" ? node.is_array_of_tables() : node.is_table();
            if (!right) {
                return Error{fmt::format("{}: {} must be {}; write {}", at(key.source()), name,
                                         name == "expect" ? "sections" : "one section",
                                         name == "expect" ? "[[expect]]" : "[" + name + "]")};
            }
        }
        for (const char* name : {"case", "expect"}) {
            if (root.contains(name)) continue;
            return Error{fmt::format("{}: section \"{}\" is missing", file_.string(), name)};
        }
        return {};
    }

    Status read_case(const toml::table& root) {
        TableReader reader(file_.string(), "[case]", *root.get_as<toml::table>("case"));
        case_.title = reader.text("title", true);
        case_.kind = reader.choice("kind", names_of(kinds(), [](const Kind& k) { return std::string(k.name); }), true);
        case_.description = reader.text("description", true);
        case_.quick = reader.boolean("quick", false);
        case_.needs_data = reader.text("needs_data", false);
        TALUS_TRY(reader.check());
        for (const Kind& kind : kinds()) {
            if (kind.name == case_.kind) kind_ = &kind;
        }
        return {};
    }

    /// `[material]` and `[solver]` have the same meaning as in a scene file.
    Status read_scene_section(const toml::table& root, const std::string& name) {
        const toml::table* table = root.get_as<toml::table>(name);
        if (table == nullptr) return {};
        const params::Section& section = *params::find_section(name);
        for (const auto& [key, node] : *table) {
            const params::Parameter* parameter = section.find(key.str());
            if (parameter == nullptr) {
                const auto keys = names_of(section.parameters, [](const params::Parameter& p) { return p.key; });
                return Error{fmt::format("{}: unknown key \"{}\" in [{}]; nearest known key: {}", at(key.source()),
                                         scene::one_line(key.str(), 80), name, params::nearest_word(key.str(), keys))};
            }
            const auto value = scene::to_parameter_value(node, parameter->kind);
            const std::string problem = value ? problem_with(*parameter, *value) : allowed_text(*parameter);
            if (!problem.empty()) {
                return Error{fmt::format("{}: {}.{} = {} is refused; it must be {}", at(key.source()), name,
                                         parameter->key, scene::toml_text_of(node), problem)};
            }
            parameter->set(spec_, 0, *value);
            setting_.overrides.push_back(fmt::format("{}.{}={}", name, parameter->key, params::toml_text(*value)));
        }
        return {};
    }

    Status read_expectations(const toml::table& root) {
        for (const toml::node& node : *root.get_as<toml::array>("expect")) {
            TALUS_TRY(read_expectation(*node.as_table()));
        }
        return {};
    }

    Status read_expectation(const toml::table& table) {
        constexpr params::Range not_negative{.low = 0};
        TableReader reader(file_.string(), "[[expect]]", table);
        Expectation e;
        e.quantity = reader.choice(
            "quantity", names_of(kind_->quantities, [](const Quantity& q) { return std::string(q.name); }), true);
        const std::vector<std::string> variants = reader.texts("where");
        e.expected = reader.number("expected", {});
        e.tolerance = reader.number("tolerance", not_negative);
        const std::string comparison = reader.choice("comparison", {"near", "at_most", "at_least"}, false);
        if (comparison == "at_most") e.comparison = Comparison::at_most;
        if (comparison == "at_least") e.comparison = Comparison::at_least;
        e.gate = reader.boolean("gate", true);
        e.source = reader.text("source", true);
        e.known_failure = reader.text("known_failure", false);
        if (const Quantity* quantity = kind_->find(e.quantity)) read_site(reader, *quantity, e);
        if (e.gate && !e.tolerance && e.comparison == Comparison::near) {
            reader.problem("tolerance is missing; it must be a number at least 0, or gate = false");
        }
        if (!e.known_failure.empty() && !e.gate) {
            reader.problem("known_failure belongs to what can fail; leave it out or set gate = true");
        }
        for (const std::string& variant : variants) {
            e.where = variant;
            case_.expectations.push_back(e);
        }
        return reader.check();
    }

    static void read_site(TableReader& reader, const Quantity& quantity, Expectation& e) {
        if (!quantity.has_law && !e.expected) {
            reader.problem(fmt::format("expected is missing; no law gives \"{}\"", quantity.name));
        }
        if (quantity.site == Quantity::Site::chainage) {
            e.chainage = reader.number("chainage_m", {.low = 0});
            if (!e.chainage) reader.problem("chainage_m is missing; it must be a number at least 0");
        } else if (quantity.site == Quantity::Site::building) {
            e.building = reader.text("building", true);
        } else if (quantity.site == Quantity::Site::place) {
            e.x = reader.number("x_m", {});
            e.y = reader.number("y_m", {});
            e.radius = reader.number("radius_m", {.low = 0, .low_included = false});
            if (!e.x || !e.y || !e.radius) reader.problem("x_m, y_m and radius_m must say where it is taken");
        }
    }

    [[nodiscard]] std::map<std::string, Parameters::Entry> parameter_entries(const toml::table& root) const {
        std::map<std::string, Parameters::Entry> entries;
        const toml::table* table = root.get_as<toml::table>("parameters");
        if (table == nullptr) return entries;
        for (const auto& [key, node] : *table) {
            entries[scene::one_line(key.str(), 80)] = {to_value(node), scene::toml_text_of(node), at(key.source())};
        }
        return entries;
    }

    std::filesystem::path file_;
    Case case_;
    params::SceneSpec spec_;
    Setting setting_;
    const Kind* kind_ = nullptr;
};

}  // namespace

Result<Case> load_case(const std::filesystem::path& folder) {
    return CaseReader(folder).read();
}

}  // namespace talus::validate
