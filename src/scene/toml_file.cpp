#include "scene/toml_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <sstream>
#include <system_error>

#include <fmt/format.h>

#include "core/input_file.hpp"
#include "core/try.hpp"
#include "core/utf8.hpp"
#include "scene/parse.hpp"

namespace talus::scene {
namespace {

constexpr std::uintmax_t largest_file = 16 << 20;  // bytes; such a file is a page of text

Result<std::string> read_text(const std::filesystem::path& file, const std::string& what) {
    const std::string name = file.string();
    std::error_code code;
    const auto status = std::filesystem::status(file, code);
    if (!std::filesystem::exists(status)) return Error{name + ": no such " + what + " file"};
    if (std::filesystem::is_directory(status)) {
        return Error{name + ": is a folder, not a " + what + " file; name the .toml file in it"};
    }
    TALUS_TRY(check_input_file(file));
    std::ifstream in(file, std::ios::binary);
    if (!in) return Error{name + ": cannot be opened: " + std::generic_category().message(errno)};
    std::string text;
    char block[65536];
    while (in.read(block, sizeof block), in.gcount() > 0) {
        text.append(block, static_cast<std::size_t>(in.gcount()));
        if (text.size() > largest_file)
            return Error{fmt::format("{}: is larger than 16 MB, not a {} file", name, what)};
    }
    if (in.bad()) return Error{name + ": cannot be read to its end"};
    if (const std::size_t invalid = invalid_utf8(text); invalid != std::string::npos) {
        const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(invalid), '\n');
        return Error{fmt::format("{}:{}: not UTF-8 text; save the {} file as UTF-8", name, line, what)};
    }
    return text;
}

}  // namespace

Result<toml::table> read_toml_file(const std::filesystem::path& file, const std::string& what) {
    TALUS_ASSIGN(const std::string text, read_text(file, what));
    try {
        return toml::parse(text, file.string());
    } catch (const toml::parse_error& error) {
        return Error{fmt::format("{}:{}: not valid TOML: {}", file.string(), error.source().begin.line,
                                 one_line(error.description()))};
    }
}

std::string toml_text_of(const toml::node& node) {
    std::ostringstream out;
    out << toml::toml_formatter{node};
    return one_line(out.str(), 80);
}

std::optional<params::ParameterValue> to_parameter_value(const toml::node& node, params::ParameterKind kind) {
    switch (kind) {
        case params::ParameterKind::boolean:
            if (const auto value = node.value_exact<bool>()) return *value;
            return std::nullopt;
        case params::ParameterKind::integer: {
            if (const auto value = node.value_exact<std::int64_t>()) return *value;
            const auto number = node.value_exact<double>();  // users write 1e6 for a whole number; TOML calls it a
                                                             // float
            if (number && std::abs(*number) < 9e15 && *number == std::floor(*number)) {
                return static_cast<std::int64_t>(*number);
            }
            return std::nullopt;
        }
        case params::ParameterKind::number:
            if (node.is_number()) return node.value<double>();
            return std::nullopt;
        case params::ParameterKind::text:
        case params::ParameterKind::path:
        case params::ParameterKind::choice:
            if (const auto value = node.value_exact<std::string>()) return *value;
            return std::nullopt;
        case params::ParameterKind::text_list: {
            const toml::array* items = node.as_array();
            if (!items) return std::nullopt;
            std::vector<std::string> texts;
            for (const toml::node& item : *items) {
                const auto text = item.value_exact<std::string>();
                if (!text) return std::nullopt;
                texts.push_back(*text);
            }
            return texts;
        }
        case params::ParameterKind::extent: {
            const toml::array* items = node.as_array();
            if (!items || items->size() != 4) return std::nullopt;
            double numbers[4];
            for (std::size_t i = 0; i < 4; ++i) {
                if (!items->get(i)->is_number()) return std::nullopt;
                numbers[i] = *items->get(i)->value<double>();
            }
            return Extent{numbers[0], numbers[1], numbers[2], numbers[3]};
        }
        case params::ParameterKind::points: {
            const toml::array* items = node.as_array();
            if (!items) return std::nullopt;
            std::vector<PlanPoint> points;
            points.reserve(items->size());
            for (const toml::node& item : *items) {
                const toml::array* place = item.as_array();
                if (!place || place->size() != 2) return std::nullopt;
                if (!place->get(0)->is_number() || !place->get(1)->is_number()) return std::nullopt;
                points.push_back({*place->get(0)->value<double>(), *place->get(1)->value<double>()});
            }
            return points;
        }
    }
    return std::nullopt;
}

}  // namespace talus::scene
