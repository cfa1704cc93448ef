// picture_pane.hpp -- the room that pictures have in the window: one picture, or two that are compared, with what is drawn over
// them and what the mouse does there.
#pragma once
#include <memory>
#include <string>

#include "ui/overlay.hpp"
#include "ui/session.hpp"
#include "ui/ui_state.hpp"
#include "ui/viewport.hpp"

namespace clarity {

// Needs the GL context current, for all of its life.
class PicturePane {
 public:
    PicturePane();
    ~PicturePane();
    // Empty, or why the picture cannot be shown.
    std::string upload(const std::shared_ptr<const Picture>& picture);
    void draw(const Rect& area, Session& session, VolumeOverlay& overlay, UiState& state);
    // Of the main picture, letter-boxed; the same for the other one where they are wiped.
    const Rect& area() const;

 private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace clarity
