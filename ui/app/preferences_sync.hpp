// memory.hpp -- what of a running window goes into its preferences, and comes from them.
#pragma once
#include <string>
#include <vector>

#include "ui/app/preferences.hpp"
#include "ui/app/ui_state.hpp"
#include "ui/session/session.hpp"

namespace clarity::ui {

// "/a/b.obj": the files of a scene as a key, one a line.
std::string scene_key(const std::vector<std::string>& files);

class PreferencesSync {
 public:
    // At the start. folder: of the preferences; empty: nothing is written.
    void begin(const std::string& folder, const Preferences& preferences, UiState& state, DesiredState& desired);
    // Once a frame: the bookmarks of the scene that is open, and the files opened last. What changed of them is written at
    // once, so that it outlives a crash.
    void follow(const Session& session, UiState& state);
    // At the end.
    void note(Preferences& preferences, const UiState& state, const DesiredState& desired) const;

 private:
    void change_scene(const std::vector<std::string>& files, UiState& state);
    void keep_bookmarks(const UiState& state);

    std::string folder_, key_;
    std::vector<std::string> files_;
    Preferences kept_;  // recent files and bookmarks
    std::vector<Bookmark> seen_;
};

}  // namespace clarity::ui
