// Whatever server a test of this program starts: what it answers is as the description has it.
#include <algorithm>
#include <optional>

#include <gtest/gtest.h>

#include "serve/client.hpp"
#include "serve/openapi.hpp"
#include "serve/schema.hpp"

namespace talus::test {
namespace {

using nlohmann::json;

std::vector<std::string> parts_of(const std::string& path) {
    std::vector<std::string> parts(1);
    for (const char c : path) {
        if (c == '/') {
            parts.emplace_back();
        } else {
            parts.back() += c;
        }
    }
    return parts;
}

/// The number of parts that are parameters; nothing: the path is not of this pattern.
std::optional<int> parameters_between(const std::string& pattern, const std::string& path) {
    const std::vector<std::string> wanted = parts_of(pattern), given = parts_of(path);
    if (wanted.size() != given.size()) return {};
    int parameters = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        if (wanted[i].starts_with('{')) {
            ++parameters;
        } else if (wanted[i] != given[i]) {
            return {};
        }
    }
    return parameters;
}

/// The responses of the operation, of the pattern with the fewest parameters; null: there is no such operation.
json responses_of(const json& document, std::string method, const std::string& path) {
    std::transform(method.begin(), method.end(), method.begin(), [](unsigned char c) { return std::tolower(c); });
    std::pair<int, json> best{1000, nullptr};
    for (const auto& [pattern, item] : document["paths"].items()) {
        const auto parameters = parameters_between(pattern, path);
        if (parameters && *parameters < best.first && item.contains(method)) {
            best = {*parameters, item[method]["responses"]};
        }
    }
    return best.second;
}

std::vector<std::string> undescribed(const std::string& method, const std::string& target, const Answer& answer) {
    static const json document = json::parse(serve::openapi_document());
    const auto found_type = answer.headers.find("content-type");
    const std::string type = found_type == answer.headers.end() ? "" : found_type->second;
    const json responses = responses_of(document, method, target.substr(0, target.find('?')));
    const std::string status = std::to_string(answer.status);
    if (answer.status >= 400) {
        if (type != "application/json") return {};
        return differences(answer.json(), {{"$ref", "#/components/schemas/Refusal"}}, document);
    }
    if (responses.is_null() || !responses.contains(status)) return {"the answer is not described"};
    const json& content = responses[status]["content"];
    if (!content.contains(type)) {
        return content.contains("*/*") ? std::vector<std::string>() : std::vector<std::string>{"the type is " + type};
    }
    if (!content[type].contains("schema")) return {};
    return differences(answer.json(), content[type]["schema"], document);
}

const bool watching = [] {
    answer_watcher() = [](const std::string& method, const std::string& target, const Answer& answer) {
        if (!target.starts_with("/api/") || method == "HEAD") return;
        for (const std::string& line : undescribed(method, target, answer)) {
            ADD_FAILURE() << method << ' ' << target << ' ' << answer.status << ": " << line;
        }
    };
    return true;
}();

}  // namespace
}  // namespace talus::test
