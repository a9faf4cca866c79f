#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/result.hpp"
#include "params/fields.hpp"

namespace talus::validate {

using NumberPair = std::array<double, 2>;

/// The `[parameters]` of a case file as its kind reads them. The keys that a kind reads are the valid ones: `check`
/// rejects all others. Getters return the default after a problem, so that a kind can read all its parameters without
/// checks.
class Parameters {
  public:
    using Value = std::variant<std::monostate, double, std::string, std::vector<double>, std::vector<NumberPair>>;
    struct Entry {
        Value value;        ///< monostate: of a type that no parameter has
        std::string text;   ///< as written
        std::string place;  ///< "case.toml:12"
    };

    Parameters(std::filesystem::path file, std::map<std::string, Entry> entries)
        : file_(std::move(file)), entries_(std::move(entries)) {}

    double number(const std::string& key, const params::Range& range, double fallback);
    int whole_number(const std::string& key, const params::Range& range, int fallback);
    /// At least one number.
    std::vector<double> numbers(const std::string& key, const params::Range& range,
                                const std::vector<double>& fallback);
    /// Pairs of numbers, `[[1, 2], [3, 4]]`; none where the key is absent and not required.
    std::vector<NumberPair> pairs(const std::string& key, const params::Range& range, bool required);
    std::string choice(const std::string& key, const std::vector<std::string>& choices, const std::string& fallback);
    std::string text(const std::string& key, const std::string& fallback);
    /// A file, relative to the case's folder; required.
    std::filesystem::path path(const std::string& key);

    /// The first problem: an invalid value, a missing key, or an unused one.
    [[nodiscard]] Status check() const;

  private:
    const Entry* find(const std::string& key);
    void refuse(const std::string& key, const Entry& entry, const std::string& allowed);
    void miss(const std::string& key, const std::string& allowed);

    std::filesystem::path file_;
    std::map<std::string, Entry> entries_;
    std::vector<std::string> asked_;
    std::string problem_;
};

}  // namespace talus::validate
