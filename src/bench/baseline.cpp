#include "bench/baseline.hpp"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "products/text_file.hpp"

namespace talus::bench {

Result<Baseline> read_baseline(const std::filesystem::path& file) {
    std::ifstream stream(file);
    if (!stream) return Error{fmt::format("{}: no such file, or it cannot be read", file.string())};
    const auto json = nlohmann::json::parse(stream, nullptr, false);
    const auto wrong = [&](const std::string& what) { return Error{fmt::format("{}: {}", file.string(), what)}; };
    if (!json.is_object()) return wrong("not a JSON object of instruction sets");
    Baseline baseline;
    for (const auto& [instruction_set, rates] : json.items()) {
        if (!rates.is_object()) return wrong(fmt::format("{}: not an object of relative rates", instruction_set));
        Rates& read = baseline[instruction_set];
        for (const auto& [name, rate] : rates.items()) {
            if (!rate.is_number() || !(rate.get<double>() > 0)) {
                return wrong(fmt::format("{}: {}: not a number above 0: {}", instruction_set, name, rate.dump()));
            }
            read[name] = rate.get<double>();
        }
    }
    return baseline;
}

Status write_baseline(const std::filesystem::path& file, const Baseline& baseline) {
    nlohmann::json json = nlohmann::json::object();
    for (const auto& [instruction_set, rates] : baseline) {
        for (const auto& [name, rate] : rates) json[instruction_set][name] = std::stod(fmt::format("{:.4g}", rate));
    }
    return products::write_text_file(file, json.dump(2) + "\n");
}

std::vector<std::string> slower(const Rates& expected, const Rates& measured, double share) {
    std::vector<std::string> names;
    for (const auto& [name, rate] : expected) {
        const auto found = measured.find(name);
        // Negated, so that a rate that is not a number counts as slower.
        if (found == measured.end() || !(found->second >= share * rate)) names.push_back(name);
    }
    return names;
}

Rates better_of(const Rates& a, const Rates& b) {
    Rates better = a;
    for (const auto& [name, rate] : b) {
        const auto [at, added] = better.emplace(name, rate);
        if (!added) at->second = std::max(at->second, rate);
    }
    return better;
}

}  // namespace talus::bench
