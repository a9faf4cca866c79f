#include "report/page.hpp"

#include <cassert>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <kainjow/mustache.hpp>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "core/visible_text.hpp"
#include "report/chart.hpp"
#include "report/number_text.hpp"
#include "report/table.hpp"
#include "report_files.hpp"

namespace talus::report {
namespace {

namespace mustache = kainjow::mustache;

mustache::data converted(const Json& json);

mustache::data converted_chart(const Json& json) {
    mustache::list curves;
    for (const Json& plot : json["plots"]) {
        for (const Json& curve : plot["curves"]) {
            if (curve["name"].get<std::string>().empty()) continue;
            mustache::data entry;
            entry.set("name", curve["name"].get<std::string>());
            entry.set("sample", sample_svg(curve["style"].get<std::string>()));
            curves.push_back(entry);
        }
    }
    mustache::data chart;
    chart.set("svg", chart_svg(chart_from(json)));
    chart.set("title", json["title"].get<std::string>());
    chart.set("curves", curves);
    return chart;
}

mustache::data converted(const Json& json) {
    switch (json.type()) {
        case Json::value_t::object: {
            const std::string kind = json.value("kind", "");
            if (kind == "chart") return converted_chart(json);
            if (kind == "table") return converted(table_cells(json));
            mustache::data object(mustache::data::type::object);
            for (const auto& [name, value] : json.items()) object.set(name, converted(value));
            if (kind == "key_figure") object.set("text", value_text(json["value"], json["format"].get<std::string>()));
            return object;
        }
        case Json::value_t::array: {
            mustache::list list;
            for (const Json& value : json) list.push_back(converted(value));
            return list;
        }
        case Json::value_t::string: {
            const auto& text = json.get_ref<const std::string&>();
            return text.empty() ? mustache::data(false) : mustache::data(visible(text));
        }
        case Json::value_t::boolean:
            return json.get<bool>();
        case Json::value_t::null:
            return false;
        default:
            // A number that is not finite is treated as null, which is how it is written to a file.
            return std::isfinite(json.get<double>()) ? mustache::data(formatted(json.get<double>(), ""))
                                                     : mustache::data(false);
    }
}

/// Text between the quotes of a string of CSS, in a style element of HTML, which reads no entities.
std::string css_text(const std::string& text) {
    std::string all;
    for (const char c : text) {
        const bool escaped = c == '"' || c == '\\' || c == '<' || static_cast<unsigned char>(c) < ' ';
        all += escaped ? fmt::format("\\{:06x}", static_cast<unsigned char>(c)) : std::string(1, c);
    }
    return all;
}

/// Data as templates see them, with what every page has.
class Context : public mustache::context<std::string> {
  public:
    explicit Context(const mustache::data* data) : mustache::context<std::string>(data) {}

    const mustache::data* get(const std::string& name) const override {
        if (name == "figure") return made(fmt::format("{}", ++figures_));
        if (name == "page_style")
            return made(std::string(report_files::chart_css) + std::string(report_files::report_css));
        if (name == "page_script") return made(std::string(report_files::report_js));
        const std::size_t bar = name.find('|');
        const mustache::data* found = mustache::context<std::string>::get(name.substr(0, bar));
        assert(found != nullptr && "a template names what its data lack");
        if (bar == std::string::npos || found == nullptr) return found;
        if (name.substr(bar) == "|css") return made(found->is_string() ? css_text(found->string_value()) : "");
        const bool number = found->is_string();
        return made(formatted(
            number ? std::strtod(found->string_value().c_str(), nullptr) : std::numeric_limits<double>::quiet_NaN(),
            std::string_view(name).substr(bar + 1)));
    }
    const mustache::data* get_partial(const std::string& name) const override {
        for (const auto& file : report_files::files) {
            if (file.name == name + ".html") return made(std::string(file.content));
        }
        assert(false && "a template includes one that is not there");
        return nullptr;
    }

  private:
    const mustache::data* made(const std::string& text) const { return &made_.emplace_back(text); }

    mutable int figures_ = 0;
    mutable std::deque<mustache::data> made_;
};

}  // namespace

std::string render(std::string_view page_template, const Json& data) {
    const mustache::data converted_data = converted(data);
    mustache::mustache page{std::string(page_template)};
    assert(page.is_valid());
    Context context(&converted_data);
    std::ostringstream out;
    return page.render(context, out).str();
}

}  // namespace talus::report
