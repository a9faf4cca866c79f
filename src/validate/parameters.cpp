#include "validate/parameters.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace talus::validate {
namespace {

/// "a number from 0 to 89", in the wording of scene files.
std::string allowed_number(const params::Range& range, params::ParameterKind kind = params::ParameterKind::number) {
    params::Parameter parameter;
    parameter.kind = kind;
    parameter.range = range;
    return allowed_text(parameter);
}

bool all_within(const std::vector<double>& values, const params::Range& range) {
    return std::all_of(values.begin(), values.end(), [&](double v) { return std::isfinite(v) && range.contains(v); });
}

}  // namespace

const Parameters::Entry* Parameters::find(const std::string& key) {
    asked_.push_back(key);
    const auto found = entries_.find(key);
    return found == entries_.end() ? nullptr : &found->second;
}

void Parameters::refuse(const std::string& key, const Entry& entry, const std::string& allowed) {
    if (!problem_.empty()) return;
    problem_ = fmt::format("{}: parameters.{} = {} is refused; it must be {}", entry.place, key, entry.text, allowed);
}

void Parameters::miss(const std::string& key, const std::string& allowed) {
    if (!problem_.empty()) return;
    problem_ = fmt::format("{}: parameters.{} is missing; it must be {}", file_.string(), key, allowed);
}

double Parameters::number(const std::string& key, const params::Range& range, double fallback) {
    const Entry* entry = find(key);
    if (entry == nullptr) return fallback;
    const auto* value = std::get_if<double>(&entry->value);
    if (value != nullptr && std::isfinite(*value) && range.contains(*value)) return *value;
    refuse(key, *entry, allowed_number(range));
    return fallback;
}

int Parameters::whole_number(const std::string& key, const params::Range& range, int fallback) {
    const Entry* entry = find(key);
    if (entry == nullptr) return fallback;
    const auto* value = std::get_if<double>(&entry->value);
    if (value != nullptr && range.contains(*value) && *value == std::floor(*value) && std::abs(*value) < 1e9) {
        return static_cast<int>(*value);
    }
    refuse(key, *entry, allowed_number(range, params::ParameterKind::integer));
    return fallback;
}

std::vector<double> Parameters::numbers(const std::string& key, const params::Range& range,
                                        const std::vector<double>& fallback) {
    const Entry* entry = find(key);
    if (entry == nullptr) return fallback;
    const auto* values = std::get_if<std::vector<double>>(&entry->value);
    if (values != nullptr && !values->empty() && all_within(*values, range)) return *values;
    refuse(key, *entry, "a list, each " + allowed_number(range));
    return fallback;
}

std::vector<NumberPair> Parameters::pairs(const std::string& key, const params::Range& range, bool required) {
    const std::string allowed = "a list of pairs, each of the two " + allowed_number(range);
    const Entry* entry = find(key);
    if (entry == nullptr) {
        if (required) miss(key, allowed);
        return {};
    }
    const auto* values = std::get_if<std::vector<NumberPair>>(&entry->value);
    const bool good =
        values != nullptr && !values->empty() && std::all_of(values->begin(), values->end(), [&](const NumberPair& p) {
            return all_within({p[0], p[1]}, range);
        });
    if (good) return *values;
    refuse(key, *entry, allowed);
    return {};
}

std::string Parameters::choice(const std::string& key, const std::vector<std::string>& choices,
                               const std::string& fallback) {
    const Entry* entry = find(key);
    if (entry == nullptr) return fallback;
    const auto* value = std::get_if<std::string>(&entry->value);
    if (value != nullptr && std::find(choices.begin(), choices.end(), *value) != choices.end()) return *value;
    refuse(key, *entry, fmt::format("one of \"{}\"", fmt::join(choices, "\", \"")));
    return fallback;
}

std::string Parameters::text(const std::string& key, const std::string& fallback) {
    const Entry* entry = find(key);
    if (entry == nullptr) return fallback;
    const auto* value = std::get_if<std::string>(&entry->value);
    if (value == nullptr || value->empty()) refuse(key, *entry, "a text, not empty");
    return value == nullptr ? fallback : *value;
}

std::filesystem::path Parameters::path(const std::string& key) {
    const std::string allowed = "a file, relative to the case's folder";
    const Entry* entry = find(key);
    if (entry == nullptr) {
        miss(key, allowed);
        return {};
    }
    const auto* value = std::get_if<std::string>(&entry->value);
    if (value == nullptr || value->empty()) {
        refuse(key, *entry, allowed);
        return {};
    }
    return (file_.parent_path() / *value).lexically_normal();
}

Status Parameters::check() const {
    if (!problem_.empty()) return Error{problem_};
    for (const auto& [key, entry] : entries_) {
        if (std::find(asked_.begin(), asked_.end(), key) != asked_.end()) continue;
        if (asked_.empty())
            return Error{fmt::format("{}: this kind of case has no parameter \"{}\"", entry.place, key)};
        return Error{fmt::format("{}: unknown key \"{}\" in [parameters]; nearest known key: {}", entry.place, key,
                                 params::nearest_word(key, asked_))};
    }
    return {};
}

}  // namespace talus::validate
