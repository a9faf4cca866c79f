#include "publish/page.hpp"

#include <array>
#include <openssl/evp.h>
#include <utility>

#include <fmt/format.h>

#include "publish/tape.hpp"

namespace talus::publish {
namespace {

std::string base64(std::string_view bytes) {
    std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');
    const int size =
        EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                        reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<int>(bytes.size()));
    text.resize(static_cast<std::size_t>(size));
    return text;
}

/// Of a script or a style sheet, as a policy names it.
std::string fingerprint(std::string_view text) {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned size = 0;
    EVP_Digest(text.data(), text.size(), digest.data(), &size, EVP_sha256(), nullptr);
    return "'sha256-" + base64({reinterpret_cast<const char*>(digest.data()), size}) + "'";
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
        text.replace(at, from.size(), to);
    }
    return text;
}

/// A script that holds the end of a script in a string would end there.
std::string inline_script(std::string_view script) {
    return replaced(replaced(std::string(script), "</script", "<\\/script"), "<!--", "<\\!--");
}

std::string escaped(std::string text) {
    for (const auto& [from, to] : {std::pair{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}}) {
        text = replaced(std::move(text), from, to);
    }
    return text;
}

/// JSON that no parser of HTML can take for markup.
std::string json_block(const std::string& content) {
    return replaced(content, "<", "\\u003c");
}

/// `scripts`, `styles`, `connects`: what a policy allows there. Pictures and the worker are made by the page itself.
std::string head(const Content& content, std::string_view scripts, std::string_view styles, std::string_view connects) {
    // Without 'wasm-unsafe-eval' no browser compiles WebAssembly under a policy; it allows no script from a text.
    const std::string_view engine = content.engine ? " 'wasm-unsafe-eval'" : "";
    const std::string_view worker = connects == "'none'" ? "blob:" : connects;
    return fmt::format(
        // The byte order mark makes browsers read UTF-8 whatever a server says: in another encoding blocks are damaged.
        "\xef\xbb\xbf<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src {}{}; style-src {}; "
        "connect-src {}; img-src data: blob:; font-src data:; media-src blob:; worker-src {}; base-uri 'none'; "
        "form-action 'none'\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<meta name=\"color-scheme\" content=\"light dark\">\n<meta name=\"referrer\" content=\"no-referrer\">\n"
        "<title>{} · talus</title>\n",
        scripts, engine, styles, connects, worker, escaped(content.title));
}

constexpr std::string_view opening =
    "</head>\n<body>\n<div id=\"page\" class=\"starting\"><p class=\"boot\" role=\"status\">Opening the twin "
    "…</p></div>\n"
    "<noscript>This page needs JavaScript: it shows a simulation.</noscript>\n";

/// Data that the page reads: no browser runs a script of this type.
std::string block(const char* id, std::string_view text) {
    return fmt::format("<script type=\"text/plain\" id=\"{}\">{}</script>\n", id, text);
}

/// The worker with the engine's script before it: a policy that names scripts lets a worker import none. The script is
/// a module, whose one export becomes a value of the worker; the worker is put into a block, so that their names do not
/// meet.
std::string worker_with(const Engine& engine, std::string_view worker) {
    constexpr std::string_view exported = "export default Module;";
    return fmt::format("{}\n{{\n{}\n}}\n", replaced(engine.script, exported, "globalThis.talusEngine = Module;"),
                       worker);
}

}  // namespace

std::string text_of_bytes(std::string_view bytes) {
    // HTML replaces 0 and the carriage return, and '<' may begin markup.
    const auto kept = [](unsigned symbol) { return symbol != 0 && symbol != '\r' && symbol != '<'; };
    std::string text;
    text.reserve(bytes.size() * 6 / 5 + 2);
    unsigned held = 0;
    int count = 0;
    const auto put = [&] {
        const unsigned symbol = held & 127U;
        if (!kept(symbol)) text += '\xc2';  // UTF-8 of the character 128 higher
        text += static_cast<char>(kept(symbol) ? symbol : symbol + 128);
        held >>= 7U;
        count -= 7;
    };
    for (const char byte : bytes) {
        held |= unsigned{static_cast<unsigned char>(byte)} << count;
        count += 8;
        while (count >= 7) put();
    }
    if (count > 0) put();
    return text;
}

std::string one_file(const PageFiles& page, const Content& content) {
    const std::string loader = inline_script(page.loader);
    const std::string scripts = fmt::format("{} {}", fingerprint(loader), fingerprint(page.script));
    std::string html = head(content, scripts, fingerprint(page.style), "'none'");
    html += opening;
    html += block("about", json_block(content.about));
    html += block("style", text_of_bytes(deflated(page.style)));
    html += block("script", text_of_bytes(deflated(page.script)));
    html += block("tape", text_of_bytes(content.tape));
    if (content.engine) {
        html += block("scene", text_of_bytes(content.scene));
        // The scene is deflated already.
        html += block("worker", text_of_bytes(deflated(worker_with(*content.engine, page.worker))));
        html += block("engine", text_of_bytes(deflated(content.engine->wasm)));
    }
    html += "<script type=\"module\">" + loader + "</script>\n</body>\n</html>\n";
    return html;
}

std::vector<File> folder(const PageFiles& page, const Content& content) {
    // By its manifest a folder is known as one of talus, which talus may replace.
    std::vector<File> files = {
        {"page.js", std::string(page.script)},
        {"page.css", std::string(page.style)},
        {"tape.bin", content.tape},
        {"manifest.json", content.about + "\n"},
    };
    if (content.engine) {
        files.push_back({"scene.bin", content.scene});
        files.push_back({"worker.js", worker_with(*content.engine, page.worker)});
        files.push_back({"talus_engine.wasm", content.engine->wasm});
    }
    std::string html = head(content, "'self'", "'self'", "'self'");
    html += "<link rel=\"stylesheet\" href=\"page.css\">\n";
    html += fmt::format("{}{}", opening, block("about", json_block(content.about)));
    html += "<script type=\"module\" src=\"page.js\"></script>\n</body>\n</html>\n";
    files.insert(files.begin(), {"index.html", std::move(html)});
    return files;
}

}  // namespace talus::publish
