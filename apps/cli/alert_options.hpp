#pragma once

#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "core/result.hpp"
#include "params/spec.hpp"
#include "serve/access.hpp"
#include "serve/alerts.hpp"

namespace talus::cli {

/// Options of triggers and alarms (docs/triggers.md). Secrets come from files alone.
struct AlertArguments {
    std::string trigger_token_file, webhook_file, mqtt, mqtt_login_file, mqtt_authority;
    std::string mqtt_topic = "talus";
    bool all_runs = false;
};

void add_alerts(CLI::App& app, AlertArguments& arguments);

/// Sets the token of triggers in `tokens`. Errors name the option: a file that cannot be read or used.
[[nodiscard]] Result<serve::AlertSettings> read_alerts(const AlertArguments& arguments, serve::Tokens& tokens);

/// Errors name the option for which a scene has neither triggers nor alarms.
[[nodiscard]] Status check_alerts(const AlertArguments& arguments, const params::SceneSpec& scene);

}  // namespace talus::cli
