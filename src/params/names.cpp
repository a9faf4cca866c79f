// Which key a wrong name stands for.
#include <algorithm>
#include <limits>
#include <numeric>

#include "core/lower_case.hpp"
#include "params/fields.hpp"

namespace talus::params {

std::vector<std::string> keys_called(const Section& section, std::string_view word) {
    const auto bare = [](std::string_view name) {
        std::string letters = lower_case(name);
        std::erase_if(letters, [](char c) { return c == '_' || c == '-'; });
        return letters;
    };
    const std::string wanted = bare(word);
    std::vector<std::string> keys;
    for (const Parameter& parameter : section.parameters) {
        const auto is_wanted = [&](const std::string& name) { return bare(name) == wanted; };
        if (std::any_of(parameter.synonyms.begin(), parameter.synonyms.end(), is_wanted)) keys.push_back(parameter.key);
    }
    return keys;
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
            diagonal = row[j];
            row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
        }
    }
    return row[b.size()];
}

std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates) {
    std::string nearest;
    std::size_t smallest = std::numeric_limits<std::size_t>::max();
    for (const std::string& candidate : candidates) {
        // Of "frictoin" the nearest is friction_coefficient, although viscosity has fewer other letters.
        std::size_t distance = edit_distance(word, candidate);
        if (word.size() >= 3) distance = std::min(distance, edit_distance(word, candidate.substr(0, word.size())));
        if (distance < smallest) {
            smallest = distance;
            nearest = candidate;
        }
    }
    return nearest;
}

}  // namespace talus::params
