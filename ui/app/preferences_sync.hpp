// preferences_sync.hpp -- copies values between the running window and its preferences.
#pragma once
#include <string>
#include <vector>

#include "ui/app/preferences.hpp"
#include "ui/session/session.hpp"
#include "ui/widgets/ui_state.hpp"

namespace clarity::ui {

// A key for a scene: the absolute paths of its files, one a line ("/a/b.obj").
std::string scene_key(const std::vector<std::string>& files);

// Keeps the recent files and the bookmarks of each scene in the preferences while the window runs.
class PreferencesSync {
 public:
    // Called at the start: applies `preferences` to the window. folder: that of the preferences; empty: nothing is written.
    void begin(const std::string& folder, const Preferences& preferences, UiState& state, DesiredState& desired);
    // Called once a frame: follows the open scene's bookmarks and the recent files. Changes are written at once, so that they
    // survive a crash.
    void follow(const Session& session, UiState& state);
    // Called at the end: copies the window's values into `preferences`.
    void note(Preferences& preferences, const UiState& state, const DesiredState& desired) const;

 private:
    void change_scene(const std::vector<std::string>& files, UiState& state);
    void keep_bookmarks(const UiState& state);

    std::string folder_, key_;
    std::vector<std::string> files_;
    Preferences kept_;  // as last loaded or saved; only its recent files and bookmarks are used
    std::vector<Bookmark> seen_;
};

}  // namespace clarity::ui
