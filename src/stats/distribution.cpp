#include "stats/distribution.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

namespace talus::stats {
namespace {

/// Standard normal distribution function.
double normal_share(double z) {
    return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

/// Its inverse, by bisection: exact to the last digits and called a few thousand times at most.
double normal_quantile(double share) {
    double below = -40, above = 40;
    for (int i = 0; i < 80; ++i) {
        const double z = (below + above) / 2;
        (normal_share(z) < share ? below : above) = z;
    }
    return (below + above) / 2;
}

double triangular_quantile(const Distribution& d, double share) {
    const double width = d.high - d.low, left = d.middle - d.low, right = d.high - d.middle;
    if (share * width <= left) return d.low + std::sqrt(share * width * left);
    return d.high - std::sqrt((1 - share) * width * right);
}

std::vector<std::string> split(std::string_view text, char separator) {
    std::vector<std::string> parts(1);
    for (const char c : text) {
        if (c == separator) {
            parts.emplace_back();
        } else {
            parts.back() += c;
        }
    }
    return parts;
}

std::optional<double> number_of(const std::string& text) {
    double value = 0;
    const char* const end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || stopped != end || !std::isfinite(value)) return std::nullopt;
    return value;
}

/// "400@3" is the entry 400 with the weight 3, if all entries are written so.
void take_weights(Distribution& d) {
    std::vector<std::string> bare;
    std::vector<double> weights;
    for (const std::string& entry : d.entries) {
        const std::size_t at = entry.rfind('@');
        const auto weight = at == std::string::npos ? std::nullopt : number_of(entry.substr(at + 1));
        if (!weight) return;
        bare.push_back(entry.substr(0, at));
        weights.push_back(*weight);
    }
    d.entries = std::move(bare);
    d.weights = std::move(weights);
}

constexpr const char* forms =
    "write low:high, log:low:high, normal:mean:deviation, triangular:low:mode:high, value,value or "
    "value@weight,value@weight";

/// A distribution of the named kind from its numbers, in the order in which they are written.
Result<Distribution> make_distribution(const std::string& name, const std::vector<double>& n) {
    Distribution d;
    if (name == "uniform" && n.size() == 2) {
        d = {DistributionKind::uniform, n[0], n[1], 0, 0, {}};
    } else if (name == "log" && n.size() == 2) {
        d = {DistributionKind::log_uniform, n[0], n[1], 0, 0, {}};
    } else if (name == "normal" && (n.size() == 2 || n.size() == 4)) {
        d.kind = DistributionKind::normal;
        d.middle = n[0];
        d.deviation = n[1];
        if (n.size() == 4) {
            d.low = n[2];
            d.high = n[3];
        }
    } else if (name == "triangular" && n.size() == 3) {
        d = {DistributionKind::triangular, n[0], n[2], n[1], 0, {}};
    } else {
        return Error{forms};
    }
    return d;
}

}  // namespace

double Distribution::quantile(double share) const {
    const double s = std::clamp(share, 0.0, 1.0);
    switch (kind) {
        case DistributionKind::uniform:
            return low + s * (high - low);
        case DistributionKind::log_uniform:
            return std::clamp(low * std::pow(high / low, s), low, high);
        case DistributionKind::triangular:
            return triangular_quantile(*this, s);
        case DistributionKind::normal: {
            const double first = normal_share((low - middle) / deviation);
            const double last = normal_share((high - middle) / deviation);
            return std::clamp(middle + deviation * normal_quantile(first + s * (last - first)), low, high);
        }
        case DistributionKind::list:
            break;
    }
    return std::numeric_limits<double>::quiet_NaN();
}

const std::string& Distribution::entry(double share) const {
    if (!weights.empty()) {
        double left = share * std::accumulate(weights.begin(), weights.end(), 0.0);
        for (std::size_t k = 0; k + 1 < entries.size(); ++k) {
            left -= weights[k];
            if (left < 0) return entries[k];
        }
        return entries.back();
    }
    const auto n = static_cast<double>(entries.size());
    return entries[static_cast<std::size_t>(std::clamp(std::floor(share * n), 0.0, n - 1))];
}

std::string Distribution::text() const {
    const bool cut = std::isfinite(low) || std::isfinite(high);
    switch (kind) {
        case DistributionKind::uniform:
            return fmt::format("uniform from {:.6g} to {:.6g}", low, high);
        case DistributionKind::log_uniform:
            return fmt::format("log-uniform from {:.6g} to {:.6g}", low, high);
        case DistributionKind::triangular:
            return fmt::format("triangular from {:.6g} over {:.6g} to {:.6g}", low, middle, high);
        case DistributionKind::normal:
            return fmt::format("normal, {:.6g} with standard deviation {:.6g}", middle, deviation) +
                   (cut ? fmt::format(", cut to {:.6g} to {:.6g}", low, high) : "");
        case DistributionKind::list:
            break;
    }
    if (weights.empty()) return fmt::format("one of {}", fmt::join(entries, ", "));
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    std::string list;
    for (std::size_t k = 0; k < entries.size(); ++k) {
        list += fmt::format("{}{} ({:.3g} %)", k > 0 ? ", " : "", entries[k], 100 * weights[k] / sum);
    }
    return "one of " + list;
}

std::string Distribution::written() const {
    switch (kind) {
        case DistributionKind::uniform:
            return fmt::format("{}:{}", low, high);
        case DistributionKind::log_uniform:
            return fmt::format("log:{}:{}", low, high);
        case DistributionKind::triangular:
            return fmt::format("triangular:{}:{}:{}", low, middle, high);
        case DistributionKind::normal:
            if (std::isfinite(low) && std::isfinite(high)) {
                return fmt::format("normal:{}:{}:{}:{}", middle, deviation, low, high);
            }
            return fmt::format("normal:{}:{}", middle, deviation);
        case DistributionKind::list:
            break;
    }
    if (weights.empty()) return fmt::format("{}", fmt::join(entries, ","));
    std::string list;
    for (std::size_t k = 0; k < entries.size(); ++k) {
        list += fmt::format("{}{}@{}", k > 0 ? "," : "", entries[k], weights[k]);
    }
    return list;
}

std::string Distribution::problem() const {
    if (kind == DistributionKind::list) {
        if (entries.empty()) return "a list needs at least one value";
        const bool hole = std::any_of(entries.begin(), entries.end(), [](const auto& e) { return e.empty(); });
        if (hole) return "a value of the list is empty";
        if (weights.empty()) return "";
        if (weights.size() != entries.size()) {
            return fmt::format("{} weights are given for {} values", weights.size(), entries.size());
        }
        const bool bad =
            std::any_of(weights.begin(), weights.end(), [](double w) { return !std::isfinite(w) || !(w > 0); });
        return bad ? "a weight must be a number above 0" : "";
    }
    if (!(low < high)) return fmt::format("the range is empty: low {:.6g} must be below high {:.6g}", low, high);
    if (kind == DistributionKind::log_uniform && !(low > 0)) {
        return fmt::format("low {:.6g} must be above 0 for a log-uniform distribution", low);
    }
    if (kind == DistributionKind::triangular && !(middle >= low && middle <= high)) {
        return fmt::format("mode {:.6g} must lie from {:.6g} to {:.6g}", middle, low, high);
    }
    if (kind == DistributionKind::normal) {
        if (!(deviation > 0)) return fmt::format("standard deviation {:.6g} must be above 0", deviation);
        if (!(middle > low - 6 * deviation && middle < high + 6 * deviation)) {
            return fmt::format("mean {:.6g} lies more than six standard deviations outside {:.6g} to {:.6g}", middle,
                               low, high);
        }
    }
    return "";
}

Result<Distribution> parse_distribution(std::string_view text) {
    Distribution d;
    const std::vector<std::string> parts = split(text, ':');
    if (parts.size() == 1) {
        d.kind = DistributionKind::list;
        d.entries = split(text, ',');
        take_weights(d);
    } else {
        const bool named = !number_of(parts.front()).has_value();
        std::vector<double> numbers;
        for (std::size_t i = named ? 1 : 0; i < parts.size(); ++i) {
            const std::optional<double> number = number_of(parts[i]);
            if (!number) return Error{fmt::format("\"{}\" is not a number; {}", parts[i], forms)};
            numbers.push_back(*number);
        }
        Result<Distribution> made = make_distribution(named ? parts.front() : "uniform", numbers);
        if (!made) return made;
        d = *std::move(made);
    }
    if (std::string problem = d.problem(); !problem.empty()) return Error{std::move(problem)};
    return d;
}

const char* distribution_name(DistributionKind kind) {
    switch (kind) {
        case DistributionKind::uniform:
            return "uniform";
        case DistributionKind::log_uniform:
            return "log_uniform";
        case DistributionKind::normal:
            return "normal";
        case DistributionKind::triangular:
            return "triangular";
        case DistributionKind::list:
            break;
    }
    return "list";
}

}  // namespace talus::stats
