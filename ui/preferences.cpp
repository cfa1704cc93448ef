#include "ui/preferences.hpp"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/output_file.hpp"
#include "base/read_file.hpp"
#include "ui/preferences_json.hpp"

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
    const Preferences p;
    if (folder.empty()) return p;
    const fs::path path = fs::path(folder) / "window.json";
    std::error_code missing;
    if (!fs::exists(path, missing)) return p;
    try {
        return preferences_from(nlohmann::json::parse(read_file(path.string(), kMaxTextFileBytes, Exit::failed)));
    } catch (const Error& error) {
        log(LogLevel::warning, std::string(error.what()) + "; the window starts with its defaults");
        return p;
    } catch (const nlohmann::json::exception& error) {
        log(LogLevel::warning, path.string() + ": not understood, so the defaults are used: " + error.what());
        return p;
    }
}

void save_preferences(const std::string& folder, const Preferences& p) {
    if (folder.empty()) return;
    const std::string path = (fs::path(folder) / "window.json").string();
    try {
        write_text_file(path, to_json(p).dump(4, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
    } catch (const Error& error) {
        log(LogLevel::warning, error.what());
    }
}

}  // namespace clarity
