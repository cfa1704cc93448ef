// picture_pane.hpp -- the part of the window with the pictures: one picture, or two that are compared, with overlays and mouse
// input.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "ui/hud/picture_hud.hpp"
#include "ui/overlay/gl_lines.hpp"
#include "ui/overlay/move_handles.hpp"
#include "ui/overlay/overlay.hpp"
#include "ui/session/session.hpp"
#include "ui/viewport/picture_mouse.hpp"
#include "ui/viewport/picture_texture.hpp"
#include "ui/widgets/rect.hpp"
#include "ui/widgets/ui_state.hpp"

namespace clarity::ui {

// Draws the pictures. Its GL context must be current during its whole life.
class PicturePane {
 public:
    // Sets the picture to draw. Returns why it cannot be shown, or nothing.
    Problem upload(const std::shared_ptr<const Picture>& picture);
    void draw(const Rect& area, Session& session, VolumeOverlay& overlay, UiState& state);

    // For tests. area() is that of the main picture, letter-boxed; with a wipe, the other picture has the same area.
    const Rect& area() const { return area_; }
    const std::vector<PicturePlace>& places() const { return places_; }
    const std::vector<LightHandle>& handles() const { return handles_; }
    const std::optional<MoveHandles>& move_handles() const { return move_handles_; }
    size_t lines_drawn(unsigned side) const { return lines_[side].any ? lines_[side].layer.drawn() : 0; }
    // Milliseconds that the last update of lines took, without waiting for OpenGL.
    double lines_ms() const { return lines_ms_; }
    bool rays_shown() const { return rays_shown_; }

 private:
    // The lines of one side, and the inputs they were drawn from. They are drawn again when an input changes.
    struct Lines {
        LineLayer layer;
        LineList volumes;
        uint64_t volumes_revision = 0, marks_revision = 0;
        Camera camera;
        Rect area;
        float pixels = 0, scale = 0;
        const FloatImage* distance = nullptr;
        std::shared_ptr<const FloatImage> seen;  // the last known distances; seen_by and seen_scene say for which view
        Camera seen_by;
        std::shared_ptr<const Scene> seen_scene;
        unsigned stride = 1;
        bool hides_behind = false, any = false;
    };
    struct Selected {
        std::shared_ptr<const Scene> scene;
        Selection selection;
        std::optional<SelectionBox> box;
    };

    void lay_out(const Rect& room, const Session& session, const UiState& state);
    void draw_pictures(ImDrawList& list);
    void collect_marks(const Session& session, const UiState& state);
    void update_lines(Lines& lines, const PicturePlace& place, const VolumeOverlay& overlay, bool moving);
    void draw_lines(ImDrawList& list, const VolumeOverlay& overlay, bool moving);
    void draw_hud(ImDrawList& list, const Session& session, VolumeOverlay& overlay);
    void draw_caption(ImDrawList& list, const Session& session, size_t place);
    void draw_scale(ImDrawList& list, size_t place);
    void draw_volume_hud(ImDrawList& list, size_t place, VolumeOverlay& overlay);
    void draw_ray_legend(ImDrawList& list);
    void draw_handles(ImDrawList& list, const Session& session);
    void place_move_handles(Session& session, const UiState& state);
    void draw_move_handles(ImDrawList& list) const;
    void draw_pixel_marks(ImDrawList& list, const Session& session, const UiState& state);
    void draw_wipe(ImDrawList& list) const;
    void draw_part(ImDrawList& list) const;
    void draw_part_card(ImDrawList& list);
    const PictureSide& side_of(const PicturePlace& place) const;
    bool side_by_side() const { return places_.size() == 2 && places_[0].area.x != places_[1].area.x; }
    // Takes room for a box at a picture: in its corner, or below the picture if pictures lie side by side and there is enough
    // room.
    std::optional<Rect> take_hud_box(size_t place, Corner corner, const ImVec2& size);
    bool covered(const Rect& label) const;
    float card_width(size_t place) const { return stacks_[side_by_side() ? place : 0].max_width(); }

    std::shared_ptr<const Picture> picture_;
    std::array<PictureTexture, 2> textures_, distances_;
    PictureTexture difference_;
    std::array<std::shared_ptr<const FloatImage>, 2> distances_of_;  // the images in distances_
    std::array<Lines, 2> lines_;
    LineList marks_;  // rays and selection, the same on both sides
    uint64_t marks_revision_ = 0;
    double lines_ms_ = 0;
    Selected selected_;
    bool rays_shown_ = false;

    Rect area_;
    std::vector<PicturePlace> places_;
    std::vector<LightHandle> handles_;
    std::optional<MoveHandles> move_handles_;  // of the selected instance
    std::array<HudStack, 2> stacks_, below_;   // over the pictures; under pictures which lie side by side
    std::vector<Rect> hud_boxes_;              // rectangles taken in this frame
    float foot_ = 0;                           // height that boxes wanted below the pictures in the last frame
    PictureMouse mouse_;
};

}  // namespace clarity::ui
