#include "ui/app/preferences_sync.hpp"

#include <imgui.h>

#include <algorithm>
#include <filesystem>

#include "scene/camera.hpp"

namespace clarity::ui {
namespace {

std::string absolute(const std::string& path) {
    std::error_code error;
    const std::filesystem::path full = std::filesystem::absolute(path, error);
    return error ? path : full.lexically_normal().string();
}

template <class Value>
void to_front(std::vector<Value>& values, const Value& value, size_t most) {
    values.erase(std::remove(values.begin(), values.end(), value), values.end());
    values.insert(values.begin(), value);
    if (values.size() > most) values.resize(most);
}

bool same(const std::vector<Bookmark>& a, const std::vector<Bookmark>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Bookmark& x, const Bookmark& y) {
        return x.name == y.name && same_camera(x.camera, y.camera) && same_pose(x.pose, y.pose);
    });
}

}  // namespace

std::string scene_key(const std::vector<std::string>& files) {
    std::string key;
    for (const std::string& file : files) key += (key.empty() ? "" : "\n") + absolute(file);
    return key;
}

void PreferencesSync::begin(const std::string& folder, const Preferences& preferences, UiState& state, DesiredState& desired) {
    folder_ = folder;
    kept_ = preferences;
    state.panel_width = preferences.panel_width;
    state.compare_mode = preferences.compare_mode;
    state.show_rays = preferences.show_rays;
    state.browser_folder = preferences.browser_folder;
    state.pictures_folder = preferences.pictures_folder;
    state.recent_files = preferences.recent_files;
    state.presets_folder = folder.empty() ? std::string() : folder + "/presets";
    desired.moving_fps = preferences.moving_fps;
}

void PreferencesSync::follow(const Session& session, UiState& state) {
    const auto files = session.files();
    if (files != files_) change_scene(files, state);
    // Do not write while a text field is active: the user may still be typing a bookmark's name.
    if (!key_.empty() && !ImGui::IsAnyItemActive() && !same(state.bookmarks, seen_)) keep_bookmarks(state);
}

void PreferencesSync::change_scene(const std::vector<std::string>& files, UiState& state) {
    if (!key_.empty() && !same(state.bookmarks, seen_)) keep_bookmarks(state);
    files_ = files;
    key_ = scene_key(files);
    const auto found = kept_.bookmarks.find(key_);
    state.bookmarks = found == kept_.bookmarks.end() ? std::vector<Bookmark>() : found->second;
    seen_ = state.bookmarks;
    for (auto file = files.rbegin(); file != files.rend(); ++file) to_front(state.recent_files, absolute(*file), kRecentFiles);
    kept_.recent_files = state.recent_files;
    if (folder_.empty() || files.empty()) return;
    Preferences now = load_preferences(folder_);
    now.recent_files = state.recent_files;
    save_preferences(folder_, now);
}

void PreferencesSync::keep_bookmarks(const UiState& state) {
    seen_ = state.bookmarks;
    // Load first: another window may have added bookmarks of other scenes.
    Preferences now = folder_.empty() ? kept_ : load_preferences(folder_);
    now.bookmarks[key_] = state.bookmarks;
    to_front(now.bookmarked, key_, kBookmarkedScenes);
    kept_.bookmarks = now.bookmarks;
    kept_.bookmarked = now.bookmarked;
    save_preferences(folder_, now);
}

void PreferencesSync::note(Preferences& preferences, const UiState& state, const DesiredState& desired) const {
    preferences.panel_width = state.panel_width;
    preferences.compare_mode = state.compare_mode;
    preferences.show_rays = state.show_rays;
    preferences.browser_folder = state.browser_folder;
    preferences.pictures_folder = state.pictures_folder;
    preferences.recent_files = state.recent_files;
    preferences.moving_fps = desired.moving_fps;
    const Preferences now = folder_.empty() ? kept_ : load_preferences(folder_);
    preferences.bookmarks = now.bookmarks;
    preferences.bookmarked = now.bookmarked;
}

}  // namespace clarity::ui
