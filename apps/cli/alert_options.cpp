#include "alert_options.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "core/input_file.hpp"
#include "core/try.hpp"
#include "serve/webhook.hpp"

namespace talus::cli {
namespace {

/// A pipe would keep the program waiting, deaf to signals, for what nobody writes.
Status check_regular(const char* option, const std::string& file) {
    if (Status s = check_input_file(file); !s) return Error{fmt::format("{} {}", option, s.error().message)};
    std::error_code code;
    if (!std::filesystem::is_regular_file(file, code)) return Error{fmt::format("{} {}: no such file", option, file)};
    return {};
}

/// A small text file, without the line ends at its end.
Result<std::string> read_secret(const char* option, const std::string& file) {
    constexpr std::size_t longest = 4096;
    TALUS_TRY(check_regular(option, file));
    std::ifstream in(file, std::ios::binary);
    if (!in) return Error{fmt::format("{} {}: cannot be opened", option, file)};
    std::string text(longest + 1, '\0');
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(in.gcount()));
    while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
    if (text.empty() || text.size() > longest) {
        return Error{fmt::format("{} {}: must have 1 to {} bytes", option, file, longest)};
    }
    return text;
}

Status read_mqtt(const AlertArguments& arguments, serve::AlertSettings& settings) {
    auto mqtt = serve::read_mqtt_address(arguments.mqtt, arguments.mqtt_topic, !arguments.mqtt_authority.empty());
    if (!mqtt) return Error{"--mqtt, --mqtt-topic: " + mqtt.error().message};
    if (!arguments.mqtt_authority.empty()) TALUS_TRY(check_regular("--mqtt-ca", arguments.mqtt_authority));
    mqtt->authority = arguments.mqtt_authority;
    if (!arguments.mqtt_login_file.empty()) {
        TALUS_ASSIGN(const std::string login, read_secret("--mqtt-login-file", arguments.mqtt_login_file));
        const std::size_t line = login.find('\n');
        if (line == std::string::npos || line == 0) {
            return Error{
                fmt::format("--mqtt-login-file {}: must have the user on its first line and the password on its "
                            "second",
                            arguments.mqtt_login_file)};
        }
        mqtt->user = login.substr(0, login[line - 1] == '\r' ? line - 1 : line);
        mqtt->password = login.substr(line + 1);
    }
    settings.mqtt = std::move(*mqtt);
    return {};
}

}  // namespace

void add_alerts(CLI::App& app, AlertArguments& arguments) {
    app.add_option("--trigger-token-file", arguments.trigger_token_file,
                   "file with the token that starts the scene's triggers over HTTP; default: none can be started")
        ->type_name("FILE");
    app.add_option("--webhook-file", arguments.webhook_file,
                   "file with the address that alarms are posted to; a second line is its header Authorization")
        ->type_name("FILE");
    CLI::Option* mqtt = app.add_option("--mqtt", arguments.mqtt,
                                       "broker that triggers come from and alarms go to; port 1883, or 8883 with TLS")
                            ->type_name("HOST:PORT");
    app.add_option("--mqtt-topic", arguments.mqtt_topic,
                   "listens to TOPIC/trigger and publishes to TOPIC/alarm; default: talus")
        ->type_name("TOPIC")
        ->needs(mqtt);
    app.add_option("--mqtt-login-file", arguments.mqtt_login_file, "file with user and password, a line each")
        ->type_name("FILE")
        ->needs(mqtt);
    app.add_option("--mqtt-ca", arguments.mqtt_authority,
                   "certificate authority of the broker (PEM); with it the connection uses TLS")
        ->type_name("FILE")
        ->needs(mqtt);
    app.add_flag("--alarms-of-all-runs", arguments.all_runs,
                 "send alarms of runs that people start, too; default: of those that a trigger starts");
}

Status check_alerts(const AlertArguments& arguments, const params::SceneSpec& scene) {
    if (!arguments.trigger_token_file.empty() && scene.triggers.empty()) {
        return Error{"--trigger-token-file: the scene has no [[trigger]]"};
    }
    if (!arguments.webhook_file.empty() && scene.alarms.empty()) {
        return Error{"--webhook-file: the scene has no [[alarm]]"};
    }
    if (!arguments.mqtt.empty() && scene.triggers.empty() && scene.alarms.empty()) {
        return Error{"--mqtt: the scene has neither [[trigger]] nor [[alarm]]"};
    }
    return {};
}

Result<serve::AlertSettings> read_alerts(const AlertArguments& arguments, serve::Tokens& tokens) {
    serve::AlertSettings settings;
    const bool listens = !arguments.trigger_token_file.empty(), posts = !arguments.webhook_file.empty();
    if (listens) {
        TALUS_ASSIGN(tokens.trigger, read_secret("--trigger-token-file", arguments.trigger_token_file));
        if (const Status good = serve::check_tokens(tokens); !good) {
            return Error{
                fmt::format("--trigger-token-file {}: {}", arguments.trigger_token_file, good.error().message)};
        }
    }
    settings.http = listens;
    if (posts) {
        TALUS_ASSIGN(const std::string text, read_secret("--webhook-file", arguments.webhook_file));
        auto target = serve::read_webhook(text);
        if (!target) {
            return Error{fmt::format("--webhook-file {}: {}", arguments.webhook_file, target.error().message)};
        }
        settings.sender.webhook = std::move(*target);
    }
    if (!arguments.mqtt.empty()) TALUS_TRY(read_mqtt(arguments, settings));
    settings.all_runs = arguments.all_runs;
    return settings;
}

}  // namespace talus::cli
