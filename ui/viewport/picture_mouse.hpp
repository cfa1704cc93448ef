// picture_mouse.hpp -- what the mouse does on the picture.
//
//   left drag      orbits, or looks around; on a handle, drags the wipe or a light (Shift: along the line of sight)
//   middle, right drag   shifts the view          wheel     nears the target
//   left click     selects what is there          double    looks at it
//   right click, Shift + left click               follows that pixel's rays
//
// A drag never clicks: it begins once the mouse has moved a few pixels with the button down.
#pragma once
#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "ui/overlay/light_handles.hpp"
#include "ui/session/session.hpp"
#include "ui/viewport/picture_layout.hpp"

namespace clarity::ui {

class PictureMouse {
 public:
    // What there is to be taken hold of, this frame.
    struct Target {
        const Picture& picture;
        const std::vector<PicturePlace>& places;
        const std::vector<LightHandle>& handles;  // in the first place
        float handle_radius;
        bool wipe;  // between the places is a handle
    };
    struct Hover {
        size_t place = 0;
        unsigned x = 0, y = 0;  // pixel of the picture
    };

    // The last item is the button that the pictures are.
    void update(const Target& target, Session& session, UiState& state);
    std::optional<Hover> hover() const { return hover_; }
    int hovered_light() const { return hovered_light_; }  // -1: none
    bool wipe_hovered() const { return wipe_hovered_; }
    // The last click asked for a pixel's rays, rather than for a selection.
    bool rays_asked() const { return rays_asked_; }

 private:
    enum class Grab { nothing, camera, wipe, light };
    void find_hovered(const Target& target, const glm::vec2& mouse, bool hovered);
    void press(const Target& target, Session& session, const glm::vec2& mouse);
    void drag(const Target& target, Session& session, UiState& state, const glm::vec2& mouse, const glm::vec2& moved);
    void drag_camera(const Rect& area, Camera& camera, bool look, const glm::vec2& moved) const;
    void click(const Target& target, Session& session, UiState& state);
    void focus_when_known(Session& session);

    Grab grab_ = Grab::nothing;
    int button_ = 0;
    bool moved_ = false, double_ = false, wipe_hovered_ = false, rays_asked_ = false;
    int hovered_light_ = -1;
    unsigned light_ = 0;
    glm::vec2 pressed_{}, last_{}, offset_{};  // of the mouse; from the mouse to what it holds
    std::optional<Hover> hover_;
    uint64_t hover_revision_ = 0;
    std::optional<Hover> inspected_hover_;
    // A double click on a pixel whose distance is not known yet: its rays are on their way.
    std::optional<Hover> focus_on_;
    uint64_t focus_after_ = 0;
};

}  // namespace clarity::ui
