#pragma once

#include <cctype>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace talus::test {

/// What a .usda file says, read strictly by the part of the grammar of OpenUSD that a run uses: anything else throws.
/// Attributes by path, as in "/Run/Debris.points"; a list or tuple has entries, time samples have them by time.
class UsdaReader {
  public:
    struct Value {
        std::string text;  ///< of a number or a string
        std::vector<Value> entries;
        std::map<double, Value> samples;

        [[nodiscard]] double number() const { return std::stod(text); }
    };

    explicit UsdaReader(const std::string& text) : text_(text) {
        const std::string first = "#usda 1.0\n";
        if (text.rfind(first, 0) != 0) fail("no header");
        at_ = first.size();
        if (peek() == '(') metadata("");
        while (peek() != '\0') prim("");
    }

    std::map<std::string, Value> attributes;      ///< by path
    std::map<std::string, std::string> types;     ///< of prims and attributes, by path
    std::map<std::string, Value> layer_metadata;  ///< by key; of the dictionary by "customLayerData.key"

  private:
    [[noreturn]] void fail(const std::string& what) const {
        throw std::runtime_error(what + " at \"" + text_.substr(at_, 40) + "\"");
    }
    char peek() {
        while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
        return at_ < text_.size() ? text_[at_] : '\0';
    }
    bool take(char c) {
        if (peek() != c) return false;
        ++at_;
        return true;
    }
    void need(char c) {
        if (!take(c)) fail(std::string("no ") + c);
    }
    std::string word() {
        peek();
        const std::size_t start = at_;
        while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) != 0 || text_[at_] == '_' ||
                                      text_[at_] == ':' || text_[at_] == '.')) {
            ++at_;
        }
        if (start == at_) fail("no word");
        return text_.substr(start, at_ - start);
    }
    std::string type() {
        std::string name = word();
        if (text_.compare(at_, 2, "[]") == 0) {
            at_ += 2;
            name += "[]";
        }
        return name;
    }
    std::string string() {
        need('"');
        std::string all;
        while (at_ < text_.size() && text_[at_] != '"') {
            if (text_[at_] == '\n') fail("a string of two lines");
            if (text_[at_] == '\\') ++at_;
            all += text_[at_++];
        }
        need('"');
        return all;
    }
    Value value() {
        Value v;
        const char c = peek();
        if (c == '"') {
            v.text = string();
        } else if (c == '[' || c == '(') {
            ++at_;
            const char end = c == '[' ? ']' : ')';
            while (!take(end)) {
                v.entries.push_back(value());
                if (!take(',') && peek() != end) fail("no comma");
            }
        } else {
            const std::size_t start = at_;
            while (at_ < text_.size() && std::string("+-.0123456789e").find(text_[at_]) != std::string::npos) ++at_;
            v.text = text_.substr(start, at_ - start);
            std::size_t read = 0;
            if (v.text.empty()) fail("no value");
            (void)std::stod(v.text, &read);
            if (read != v.text.size()) fail("no number");
        }
        return v;
    }
    Value time_samples() {
        Value v;
        need('{');
        while (!take('}')) {
            const double time = std::stod(value().text);
            need(':');
            if (!v.samples.empty() && time <= v.samples.rbegin()->first) fail("times do not rise");
            v.samples[time] = value();
            if (!take(',') && peek() != '}') fail("no comma");
        }
        return v;
    }
    void metadata(const std::string& path) {
        need('(');
        while (!take(')')) {
            if (peek() == '"') {
                const std::string comment = string();
                if (path.empty()) layer_metadata["comment"].text = comment;
                continue;
            }
            const std::string key = word();
            need('=');
            if (peek() != '{') {
                const Value v = value();
                if (path.empty()) layer_metadata[key] = v;
                continue;
            }
            need('{');
            while (!take('}')) {
                (void)type();
                const std::string inner = word();
                need('=');
                layer_metadata[key + "." + inner] = value();
            }
        }
    }
    void prim(const std::string& parent) {
        if (word() != "def") fail("no def");
        const std::string kind = word(), path = parent + "/" + string();
        if (!types.emplace(path, kind).second) fail("twice: " + path);
        if (peek() == '(') metadata(path);
        need('{');
        while (!take('}')) {
            if (text_.compare(at_, 4, "def ") == 0) {
                prim(path);
            } else {
                attribute(path);
            }
        }
    }
    void attribute(const std::string& prim) {
        std::string kind = type();
        if (kind == "custom" || kind == "uniform") kind = type();
        std::string name = prim + "." + word();
        const std::string ending = ".timeSamples";
        const bool sampled = name.size() > ending.size() && name.substr(name.size() - ending.size()) == ending;
        if (sampled) name.resize(name.size() - ending.size());
        if (types.emplace(name, kind).first->second != kind) fail("another type: " + name);
        if (take('=')) attributes[name] = sampled ? time_samples() : value();
        if (peek() == '(') metadata(name);
    }

    std::string text_;
    std::size_t at_ = 0;
};

}  // namespace talus::test
