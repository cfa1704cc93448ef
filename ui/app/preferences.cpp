#include "ui/app/preferences.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/files/read_file.hpp"
#include "base/log.hpp"

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

using Json = nlohmann::json;

Json camera_json(const Camera& camera) {
    return {{"name", camera.name},           {"eye", camera.eye},           {"target", camera.target}, {"up", camera.up},
            {"fov_y_rad", camera.fov_y_rad}, {"aperture", camera.aperture}, {"focus", camera.focus}};
}

bool finite(const std::array<float, 3>& v) {
    return std::all_of(v.begin(), v.end(), [](float x) { return std::isfinite(x); });
}

// Reads a camera. Returns whether the result is usable as a view.
bool read_camera(const Json& json, Camera& camera) {
    camera.name = json.value("name", "");
    camera.eye = json.at("eye").get<std::array<float, 3>>();
    camera.target = json.at("target").get<std::array<float, 3>>();
    camera.up = json.at("up").get<std::array<float, 3>>();
    camera.fov_y_rad = std::clamp(json.at("fov_y_rad").get<float>(), 0.01f, 3.0f);
    camera.aperture = std::clamp(json.value("aperture", 0.0f), 0.0f, 1e15f);
    camera.focus = std::clamp(json.value("focus", 0.0f), 0.0f, 1e15f);
    return finite(camera.eye) && finite(camera.target) && finite(camera.up) && camera.eye != camera.target;
}

PoseTime read_pose(const Json& json) {
    const double time_s = json.at("time_s");
    PoseTime pose;
    pose.clip = json.value("clip", "");
    if (std::isfinite(time_s)) pose.time_s = time_s;
    return pose;
}

Json bookmarks_json(const Preferences& p) {
    Json scenes = Json::array();
    for (const std::string& key : p.bookmarked) {
        const auto found = p.bookmarks.find(key);
        if (found == p.bookmarks.end() || found->second.empty()) continue;
        Json views = Json::array();
        for (const Bookmark& bookmark : found->second) {
            views.push_back({{"name", bookmark.name}, {"camera", camera_json(bookmark.camera)}});
            if (bookmark.pose.time_s) views.back()["pose"] = {{"clip", bookmark.pose.clip}, {"time_s", *bookmark.pose.time_s}};
        }
        scenes.push_back({{"scene", key}, {"views", views}});
    }
    return scenes;
}

// Reads single entries. With `problems`, a failure is appended there and the other entries still count. Otherwise it is thrown.
class Reader {
 public:
    explicit Reader(std::vector<std::string>* problems) : problems_(problems) {}
    template <class Read>
    void entry(const std::string& name, const Read& read) {
        try {
            read();
        } catch (const Json::exception& error) {
            if (!problems_) throw;
            problems_->push_back(name + ": " + error.what());
        }
    }
    template <class Value>
    void value(const Json& json, const char* key, Value& value) {
        entry(key, [&] { value = json.value(key, value); });
    }
    template <class Value>
    void number(const Json& json, const char* key, Value& value, Value least, Value most) {
        entry(key, [&] { value = std::clamp(json.value(key, value), least, most); });
    }

 private:
    std::vector<std::string>* problems_;
};

void read_bookmarks(const Json& scenes, Reader& reader, Preferences& p) {
    for (const Json& scene : scenes) {
        if (p.bookmarked.size() == kBookmarkedScenes) break;
        reader.entry("bookmarks", [&] {
            const std::string key = scene.at("scene");
            std::vector<Bookmark> views;
            for (const Json& view : scene.at("views"))
                reader.entry("a bookmark of " + key, [&] {
                    Bookmark bookmark{view.value("name", ""), {}, {}};
                    if (view.contains("pose")) bookmark.pose = read_pose(view.at("pose"));
                    if (read_camera(view.at("camera"), bookmark.camera)) views.push_back(bookmark);
                });
            if (p.bookmarks.emplace(key, std::move(views)).second) p.bookmarked.push_back(key);
        });
    }
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

Json to_json(const Preferences& p) {
    return {{"width", p.width},
            {"height", p.height},
            {"text_scale", p.text_scale},
            {"camera_speed", p.camera_speed},
            {"light_speed", p.light_speed},
            {"key_map", p.key_map},
            {"panel_visible", p.panel_visible},
            {"panel_width", p.panel_width},
            {"compare_mode", kCompareNames[static_cast<int>(p.compare_mode)]},
            {"moving_fps", p.moving_fps},
            {"show_rays", p.show_rays},
            {"browser_folder", p.browser_folder},
            {"pictures_folder", p.pictures_folder},
            {"recent_files", p.recent_files},
            {"bookmarks", bookmarks_json(p)}};
}

Preferences preferences_from(const Json& json, std::vector<std::string>* problems) {
    Preferences p;
    Reader reader(problems);
    if (!json.is_object()) json.at("width");  // throws
    reader.number(json, "width", p.width, 640, 16384);
    reader.number(json, "height", p.height, 400, 16384);
    reader.number(json, "text_scale", p.text_scale, 0.8f, 2.0f);
    reader.number(json, "camera_speed", p.camera_speed, 0.05f, 10.0f);
    reader.number(json, "light_speed", p.light_speed, 0.05f, 10.0f);
    reader.value(json, "key_map", p.key_map);
    reader.value(json, "panel_visible", p.panel_visible);
    reader.number(json, "panel_width", p.panel_width, 200.0f, 4000.0f);
    std::string mode;
    reader.value(json, "compare_mode", mode);
    for (int i = 0; i < 3; ++i)
        if (mode == kCompareNames[i]) p.compare_mode = static_cast<CompareMode>(i);
    reader.number(json, "moving_fps", p.moving_fps, 0.0f, 240.0f);
    reader.value(json, "show_rays", p.show_rays);
    reader.value(json, "browser_folder", p.browser_folder);
    reader.value(json, "pictures_folder", p.pictures_folder);
    reader.value(json, "recent_files", p.recent_files);
    if (p.recent_files.size() > kRecentFiles) p.recent_files.resize(kRecentFiles);
    if (json.contains("bookmarks")) read_bookmarks(json.at("bookmarks"), reader, p);
    return p;
}

}  // namespace clarity::ui
