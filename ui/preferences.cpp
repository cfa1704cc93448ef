#include "ui/preferences.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/log.hpp"

namespace clarity {
namespace fs = std::filesystem;

std::string preferences_folder() {
    const auto variable = [](const char* name) {
        const char* value = std::getenv(name);
        return std::string(value ? value : "");
    };
    if (!variable("CLARITY_UI_NO_SAVE").empty()) return {};
    fs::path folder = variable("XDG_CONFIG_HOME");
    if (!folder.is_absolute()) {  // the XDG specification: a relative one is to be ignored
        const fs::path home = variable("HOME");
        if (!home.is_absolute()) return {};
        folder = home / ".config";
    }
    folder /= "clarity";
    std::error_code error;
    fs::create_directories(folder, error);
    if (error || access(folder.c_str(), W_OK) != 0) {
        log(LogLevel::warning, folder.string() + ": cannot be written; the window will not remember its settings");
        return {};
    }
    return folder.string();
}

Preferences load_preferences(const std::string& folder) {
    Preferences p;
    if (folder.empty()) return p;
    const fs::path path = fs::path(folder) / "window.json";
    std::ifstream in(path);
    if (!in) return p;
    try {
        const nlohmann::json json = nlohmann::json::parse(in);
        p.width = std::clamp(json.value("width", p.width), 640, 16384);
        p.height = std::clamp(json.value("height", p.height), 400, 16384);
        p.text_scale = std::clamp(json.value("text_scale", p.text_scale), 0.8f, 2.0f);
        p.camera_speed = std::clamp(json.value("camera_speed", p.camera_speed), 0.05f, 10.0f);
        p.light_speed = std::clamp(json.value("light_speed", p.light_speed), 0.05f, 10.0f);
        p.key_map = json.value("key_map", p.key_map);
        p.panel_visible = json.value("panel_visible", p.panel_visible);
    } catch (const nlohmann::json::exception& error) {
        log(LogLevel::warning, path.string() + ": not understood, so the defaults are used: " + error.what());
        return Preferences{};
    }
    return p;
}

void save_preferences(const std::string& folder, const Preferences& p) {
    if (folder.empty()) return;
    const fs::path path = fs::path(folder) / "window.json",
                   temporary = fs::path(folder) / ("window.json." + std::to_string(getpid()));
    const nlohmann::json json = {{"width", p.width},
                                 {"height", p.height},
                                 {"text_scale", p.text_scale},
                                 {"camera_speed", p.camera_speed},
                                 {"light_speed", p.light_speed},
                                 {"key_map", p.key_map},
                                 {"panel_visible", p.panel_visible}};
    std::error_code error;
    {
        std::ofstream out(temporary);
        out << json.dump(4) << "\n";
        out.close();
        if (!out) error = std::make_error_code(std::errc::io_error);
    }
    if (!error) fs::rename(temporary, path, error);
    if (!error) return;
    log(LogLevel::warning, path.string() + ": cannot be written: " + error.message());
    fs::remove(temporary, error);
}

}  // namespace clarity
