#include "ui/app/preferences.hpp"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/files/read_file.hpp"
#include "base/log.hpp"
#include "ui/app/preferences_json.hpp"

namespace clarity::ui {
namespace fs = std::filesystem;

std::string preferences_folder() {
    const auto variable = [](const char* name) {
        const char* value = std::getenv(name);
        return std::string(value ? value : "");
    };
    if (!variable("CLARITY_UI_NO_SAVE").empty()) return {};
    fs::path folder = variable("XDG_CONFIG_HOME");
    if (!folder.is_absolute()) {  // the XDG specification says that a relative path is to be ignored
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

namespace {

// Returns the first name which no file has yet: window.damaged-1.json, window.damaged-2.json, and so on.
fs::path name_for_damaged(const fs::path& path) {
    for (int number = 1;; ++number) {
        fs::path name = path;
        name.replace_filename("window.damaged-" + std::to_string(number) + ".json");
        std::error_code error;
        if (!fs::exists(name, error)) return name;
    }
}

// Renames the damaged file. Returns the end of the message about it: where the file is now, or why it could not be kept.
std::string keep_aside(const fs::path& path) {
    const fs::path aside = name_for_damaged(path);
    std::error_code error;
    fs::rename(path, aside, error);
    if (error) return "it cannot be kept as " + aside.string() + ": " + error.message();
    return "the damaged file is kept as " + aside.string();
}

}  // namespace

Preferences load_preferences(const std::string& folder, std::string* notice) {
    Preferences p;
    if (folder.empty()) return p;
    const fs::path path = fs::path(folder) / "window.json";
    std::error_code error;
    if (!fs::exists(path, error)) return p;
    bool some = false;  // whether any entry could be read
    std::string content;
    Problem why = try_read_file(path.string(), kMaxTextFileBytes, content);
    if (!why) try {
            std::vector<std::string> problems;
            p = preferences_from(nlohmann::json::parse(content), &problems);
            if (problems.empty()) return p;
            some = true;
            why = "some entries cannot be read (" + problems.front() +
                  (problems.size() > 1 ? ", and " + std::to_string(problems.size() - 1) + " more)" : ")");
        } catch (const nlohmann::json::exception& failure) {
            why = std::string("cannot be read as preferences: ") + failure.what();
        }
    const std::string text = path.string() + ": " + why.text() + (some ? "; the rest is used, " : "; the defaults are used, ") +
                             "and " + keep_aside(path);
    // Save at once, so that the readable entries survive even if this window crashes.
    if (some) save_preferences(folder, p);
    if (notice)
        *notice = text;
    else
        log(LogLevel::warning, text);
    return p;
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

}  // namespace clarity::ui
