// picture_pane.hpp -- the room that pictures have in the window: one picture, or two that are compared, with what is drawn over
// them and what the mouse does there.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ui/app/ui_state.hpp"
#include "ui/hud/picture_hud.hpp"
#include "ui/overlay/gl_lines.hpp"
#include "ui/overlay/overlay.hpp"
#include "ui/session/session.hpp"
#include "ui/viewport/picture_mouse.hpp"
#include "ui/viewport/viewport.hpp"

namespace clarity::ui {

// Needs the GL context current, for all of its life.
class PicturePane {
 public:
    // Empty, or why the picture cannot be shown.
    std::string upload(const std::shared_ptr<const Picture>& picture);
    void draw(const Rect& area, Session& session, VolumeOverlay& overlay, UiState& state);

    // For tests. Where the main picture lies, letter-boxed; the other one too where they are wiped.
    const Rect& area() const { return area_; }
    const std::vector<PicturePlace>& places() const { return places_; }
    const std::vector<LightHandle>& handles() const { return handles_; }
    size_t lines_drawn(unsigned side) const { return lines_[side].any ? lines_[side].layer.drawn() : 0; }
    double lines_ms() const { return lines_ms_; }  // that drawing lines anew took last, waiting for OpenGL left aside
    bool rays_shown() const { return rays_shown_; }

 private:
    // Lines of one side, and what they were drawn of: drawn anew where it differs.
    struct Lines {
        LineLayer layer;
        LineList volumes;
        uint64_t volumes_revision = 0, marks_revision = 0;
        Camera camera;
        Rect area;
        float pixels = 0, scale = 0;
        const FloatImage* distance = nullptr;
        std::shared_ptr<const FloatImage> seen;  // the last distances that were known, and of what
        Camera seen_by;
        const Scene* seen_scene = nullptr;
        unsigned stride = 1;
        bool hides_behind = false, any = false;
    };
    struct Selected {
        const Scene* scene = nullptr;
        Selection selection;
        std::optional<std::array<std::array<float, 3>, 8>> box;
    };

    void lay_out(const Rect& room, const Session& session, const UiState& state);
    void draw_pictures(ImDrawList& list);
    void collect_marks(const Session& session, const UiState& state);
    void update_lines(Lines& lines, const PicturePlace& place, const VolumeOverlay& overlay, bool moving);
    void draw_lines(ImDrawList& list, const VolumeOverlay& overlay, bool moving);
    void draw_hud(ImDrawList& list, const Session& session, VolumeOverlay& overlay);
    void draw_caption(ImDrawList& list, const Session& session, size_t place);
    void draw_scale(ImDrawList& list, size_t place);
    void draw_volume_card(ImDrawList& list, size_t place, VolumeOverlay& overlay);
    void draw_ray_legend(ImDrawList& list);
    void draw_handles(ImDrawList& list, const Session& session);
    void draw_pixel_marks(ImDrawList& list, const Session& session, const UiState& state);
    void draw_wipe(ImDrawList& list) const;
    const PictureSide& side_of(const PicturePlace& place) const;
    bool side_by_side() const { return places_.size() == 2 && places_[0].area.x != places_[1].area.x; }
    // Room for a card at a place: its corner, or below it if pictures lie side by side and leave enough there.
    std::optional<Rect> take_card(size_t place, Corner corner, const ImVec2& size);
    bool covered(const Rect& label) const;
    float card_width(size_t place) const { return stacks_[side_by_side() ? place : 0].max_width(); }

    std::shared_ptr<const Picture> picture_;
    std::array<PictureTexture, 2> textures_, distances_;
    PictureTexture difference_;
    std::array<std::shared_ptr<const FloatImage>, 2> distances_of_;  // what distances_ hold
    std::array<Lines, 2> lines_;
    LineList marks_;  // rays and selection, the same on both sides
    uint64_t marks_revision_ = 0;
    double lines_ms_ = 0;
    Selected selected_;
    bool rays_shown_ = false;

    Rect area_;
    std::vector<PicturePlace> places_;
    std::vector<LightHandle> handles_;
    std::array<HudStack, 2> stacks_, below_;  // over the pictures, and under those that lie side by side
    std::vector<Rect> cards_;                 // taken this frame
    float foot_ = 0;                          // room that cards wanted below pictures, last frame
    PictureMouse mouse_;
};

}  // namespace clarity::ui
