// picture_mouse.hpp -- mouse input on the picture.
//
//   left drag      orbits, or looks around; on a handle, drags the wipe or a light (Shift: along the line of sight)
//   Ctrl + left drag     draws the part of the picture that alone is traced
//   middle, right drag   shifts the view          wheel     nears the target
//   left click     selects what is there          double    looks at it
//   right click, Shift + left click               follows that pixel's rays
//
// A drag is never a click: it begins when the mouse has moved more than a few pixels while the button is down.
#pragma once
#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "ui/overlay/light_handles.hpp"
#include "ui/overlay/move_handles.hpp"
#include "ui/session/session.hpp"
#include "ui/viewport/picture_layout.hpp"

namespace clarity::ui {

// Turns mouse events into changes of camera, lights, selection and wipe.
class PictureMouse {
 public:
    // What the mouse can act on in this frame.
    struct Target {
        const Picture& picture;
        const std::vector<PicturePlace>& places;
        const std::vector<LightHandle>& handles;  // in places[0]
        float handle_radius;
        bool wipe;                // whether there is a handle between the places
        const MoveHandles* move;  // of the selected instance, in places[0]; nullptr: none are shown
    };
    struct Hover {
        size_t place = 0;
        unsigned x = 0, y = 0;  // pixel of the picture
    };

    // Handles the mouse for this frame. The last ImGui item must be the button that covers the pictures.
    void update(const Target& target, Session& session, UiState& state);
    std::optional<Hover> hover() const { return hover_; }
    int hovered_light() const { return hovered_light_; }     // -1: none
    MoveHandle move_handle() const { return move_handle_; }  // that is hovered or held
    bool wipe_hovered() const { return wipe_hovered_; }
    const std::optional<Rect>& drawn_part() const { return drawn_part_; }  // while it is drawn, in the window
    // Whether the last click asked for a pixel's rays and not for a selection.
    bool rays_asked() const { return rays_asked_; }

 private:
    enum class Grab { nothing, camera, wipe, light, instance, part };
    void find_hovered(const Target& target, const glm::vec2& mouse, bool hovered);
    void press(const Target& target, Session& session, const glm::vec2& mouse);
    void drag(const Target& target, Session& session, UiState& state, const glm::vec2& mouse, const glm::vec2& moved);
    void drag_camera(const Rect& area, Camera& camera, bool look, const glm::vec2& moved) const;
    void click(const Target& target, Session& session, UiState& state);
    void focus_when_known(Session& session);
    void draw_part(const glm::vec2& mouse);
    void take_part(Session& session);

    Grab grab_ = Grab::nothing;
    int button_ = 0;
    bool moved_ = false, double_ = false, wipe_hovered_ = false, rays_asked_ = false;
    int hovered_light_ = -1;
    unsigned light_ = 0;
    glm::vec2 pressed_{}, last_{}, offset_{};  // of the mouse; from the mouse to what it holds
    MoveHandle move_handle_ = MoveHandle::none;
    MoveDrag move_drag_;
    rt_u32 moved_instance_ = 0;
    Rect part_area_;  // of the picture in which a part is drawn
    std::optional<Rect> drawn_part_;
    std::optional<Hover> hover_;
    uint64_t hover_revision_ = 0;
    std::optional<Hover> inspected_hover_;
    // Pixel of a double click, while its distance is not known yet and its rays are being traced.
    std::optional<Hover> focus_on_;
    uint64_t focus_after_ = 0;
};

}  // namespace clarity::ui
