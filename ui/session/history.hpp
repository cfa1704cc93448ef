// history.hpp -- undo and redo of the wish, all but the camera, which bookmarks keep.
#pragma once
#include <vector>

#include "ui/session/desired_state.hpp"

namespace clarity::ui {

class History {
 public:
    // Once a frame. While a gesture lasts (a slider is dragged, a key is down) its steps are one.
    void observe(const DesiredState& desired, bool gesture);
    // A new scene: nothing before it can be taken back.
    void forget();
    bool can_undo() const { return !undo_.empty(); }
    bool can_redo() const { return !redo_.empty(); }
    // What the next step would take back: "Depth", "Structure", "light 1"; empty: nothing.
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

// What of a wish differs, for a person: "Depth", "3 changes". Empty: nothing that counts.
std::string difference_name(const DesiredState& a, const DesiredState& b);

}  // namespace clarity::ui
