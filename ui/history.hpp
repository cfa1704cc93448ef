// history.hpp -- undo and redo of the wish, all but the camera, which bookmarks keep.
#pragma once
#include <vector>

#include "ui/wish.hpp"

namespace clarity {

class History {
 public:
    // Once a frame. While a gesture lasts (a slider is dragged, a key is down) its steps are one.
    void observe(const Wish& wish, bool gesture);
    // A new scene: nothing before it can be taken back.
    void forget();
    bool can_undo() const { return !undo_.empty(); }
    bool can_redo() const { return !redo_.empty(); }
    // What the next step would take back: "Depth", "Structure", "light 1"; empty: nothing.
    std::string undo_name() const;
    std::string redo_name() const;
    void undo(Wish& wish);
    void redo(Wish& wish);

 private:
    static constexpr size_t kSteps = 200;
    bool known_ = false;
    Wish settled_;
    std::vector<Wish> undo_, redo_;
};

// What of a wish differs, for a person: "Depth", "3 changes". Empty: nothing that counts.
std::string difference_name(const Wish& a, const Wish& b);

}  // namespace clarity
