// history.hpp -- undo and redo of the desired state, except for the camera, which bookmarks keep, and for the time within a
// clip.
#pragma once
#include <vector>

#include "ui/threads/desired_state.hpp"

namespace clarity::ui {

// The steps of undo and redo, at most 200.
class History {
 public:
    // Called once a frame. All changes during one gesture (a slider is dragged, a key is down) are one step.
    void observe(const DesiredState& desired, bool gesture);
    // Called for a new scene: earlier steps cannot be undone any more.
    void forget();
    // Called when the lights of the file move with a pose. Steps that hold the lights of the old pose then hold those of the
    // new one, because undo takes back what the user did and not what the clip did.
    void lights_moved(const std::vector<Light>& before, const std::vector<Light>& now);
    bool can_undo() const { return !undo_.empty(); }
    bool can_redo() const { return !redo_.empty(); }
    // The name of the next step to undo: "Depth", "Structure", "light 1". Empty: there is none.
    std::string undo_name() const;
    std::string redo_name() const;
    void undo(DesiredState& desired);
    void redo(DesiredState& desired);

 private:
    static constexpr size_t kSteps = 200;
    bool known_ = false;
    DesiredState settled_;
    std::vector<DesiredState> undo_, redo_;
};

// Lights of the file that the user has not changed follow it from one pose to another.
void follow_lights(DesiredState& desired, const std::vector<Light>& before, const std::vector<Light>& now);

// What differs between two desired states, as a text for the user: "Depth", "3 changes". Empty: nothing that undo would
// restore.
std::string difference_name(const DesiredState& a, const DesiredState& b);

}  // namespace clarity::ui
