#include "ui/viewport/picture_pane.hpp"

#include <epoxy/gl.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/elapsed.hpp"
#include "scene/camera.hpp"
#include "scene/motion/deform.hpp"
#include "ui/overlay/ray_lines.hpp"
#include "ui/session/camera_control.hpp"
#include "ui/session/session_view.hpp"
#include "ui/viewport/picture_captions.hpp"
#include "ui/widgets/imgui_calls.hpp"
#include "ui/widgets/theme.hpp"

namespace clarity::ui {
namespace {

using What = PicturePlace::What;

constexpr float kBehind = 0.15f;  // opacity of lines behind a surface

// While the camera moves, at most this many volumes are drawn (every n-th one), so that a frame of the window stays short.
constexpr size_t kMovingVolumes = 4000;

std::optional<SelectionBox> selected_box(const Ready& ready, const Selection& selection) {
    const Scene& scene = *ready.scene;
    const bool is_instance = selection.instance >= 0 && static_cast<size_t>(selection.instance) < scene.instances.size();
    const Deformation* const made_elsewhere =
        is_instance ? left_out(ready, scene.instances[static_cast<size_t>(selection.instance)].mesh) : nullptr;
    if (!made_elsewhere) return selection_box(scene, selection);
    const PosedMesh vertices = deformed(*ready.rest, *made_elsewhere);
    return selection_box(scene, selection, &vertices);
}

// Draws the visible part of a texture that covers `area`. top_first: whether the texture's first row is the top one.
void add_part(ImDrawList& list, unsigned texture, const Rect& area, const Rect& shown, bool top_first) {
    if (shown.width <= 0 || shown.height <= 0) return;
    const float left = (shown.x - area.x) / area.width, right = left + shown.width / area.width;
    list.AddImage(reinterpret_cast<ImTextureID>(static_cast<intptr_t>(texture)), {shown.x, shown.y},
                  {shown.x + shown.width, shown.y + shown.height}, {left, top_first ? 0.0f : 1.0f},
                  {right, top_first ? 1.0f : 0.0f});
}

const Instance& instance_of(const Scene& scene, const Selection& selection) {
    return scene.instances[static_cast<size_t>(selection.instance)];
}

void blend_premultiplied(const ImDrawList*, const ImDrawCmd*) {
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
}

}  // namespace

Problem PicturePane::upload(const std::shared_ptr<const Picture>& picture) {
    picture_ = picture;
    Problem why = textures_[0].upload(picture->main.image);
    if (picture->other && !why) why = textures_[1].upload(picture->other->image);
    if (picture->difference && !why) why = difference_.upload(picture->difference->image);
    if (why) picture_.reset();
    return why;
}

const PictureSide& PicturePane::side_of(const PicturePlace& place) const {
    return place.side() == 1 && picture_->other ? *picture_->other : picture_->main;
}

void PicturePane::lay_out(const Rect& room, const Session& session, const UiState& state) {
    const float aspect = static_cast<float>(textures_[0].width()) / static_cast<float>(std::max(1u, textures_[0].height()));
    float head = 0;
    if (picture_->other && state.compare_mode == CompareMode::side_by_side)
        for (unsigned side = 0; side < 2; ++side)
            head = std::max(head,
                            card_size(caption_lines(caption_of(session, *picture_, side)), std::floor(room.width / 2 - 8)).y);
    places_ = lay_out_pictures(room, aspect, picture_->other.has_value(), state.compare_mode, state.wipe, std::round(head + 6),
                               foot_);
    area_ = places_.front().area;
    const float margin = std::round(10 * ui_scale()), least = 190 * ui_scale();
    below_ = {};
    hud_boxes_.clear();
    foot_ = 0;
    for (size_t i = 0; i < places_.size(); ++i) {
        const Rect& area = places_[i].area;
        const float bottom = area.y + area.height;
        stacks_[i] = HudStack(area, margin, least);
        if (side_by_side())
            below_[i] = HudStack({area.x - margin, bottom, area.width + 2 * margin, room.y + room.height - bottom + margin},
                                 margin, least);
    }
}

std::optional<Rect> PicturePane::take_hud_box(size_t place, Corner corner, const ImVec2& size) {
    std::optional<Rect> box;
    const bool low = corner == Corner::bottom_left || corner == Corner::bottom_right;
    if (side_by_side() && low) {
        box = below_[place].take(corner == Corner::bottom_right ? Corner::top_right : Corner::top_left, size.x, size.y);
        const float wanted = box ? box->y + box->height - places_[place].area.y - places_[place].area.height : foot_ + size.y;
        foot_ = std::max(foot_, wanted + 10 * ui_scale());
    }
    if (!box) box = stacks_[side_by_side() ? place : 0].take(corner, size.x, size.y);
    if (box) hud_boxes_.push_back(*box);
    return box;
}

// Whether a box over a picture, or another label, covers this label.
bool PicturePane::covered(const Rect& label) const {
    return std::any_of(hud_boxes_.begin(), hud_boxes_.end(), [&](const Rect& box) {
        return label.x < box.x + box.width && box.x < label.x + label.width && label.y < box.y + box.height &&
               box.y < label.y + label.height;
    });
}

void PicturePane::draw_pictures(ImDrawList& list) {
    for (const PicturePlace& place : places_) {
        PictureTexture& texture =
            place.what == What::difference && picture_->difference ? difference_ : textures_[place.side()];
        // Enlarged pixels stay sharp.
        texture.set_magnified(place.area.width >= 2 * static_cast<float>(texture.width()));
        add_part(list, texture.name(), place.area, place.shown, true);
    }
}

// Collects the rays and the selection as lines of the world.
void PicturePane::collect_marks(const Session& session, const UiState& state) {
    const float scale = ui_scale();
    const Camera& camera = picture_->job.view.camera;
    const Projection projection(area_, camera);
    LineList marks;
    const Ready& ready = *picture_->job.ready;
    const std::shared_ptr<const Scene>& scene = ready.scene;
    const Selection& selection = session.selection;
    if (selection.any() && session.ready() && session.ready()->loaded == ready.loaded) {
        const bool known = selected_.scene == scene && selected_.selection.instance == selection.instance &&
                           selected_.selection.prim == selection.prim;
        const bool moved = !known && selected_.box && selection.instance >= 0 && selected_.scene &&
                           selected_.selection.instance == selection.instance &&
                           selected_.scene->positions.shares(scene->positions) && ready.left_out.empty();
        if (moved)
            selected_ = {scene, selection, SelectionBox{selected_.box->own, instance_of(*scene, selection).world_from_object}};
        else if (!known)
            selected_ = {scene, selection, selected_box(ready, selection)};
        if (selected_.box) {
            marks.box(selected_.box->corners(), IM_COL32(0, 0, 0, 130), 3.4f * scale);
            marks.box(selected_.box->corners(), ImGui::GetColorU32(colors::kAccent), 1.6f * scale);
        }
    } else {
        selected_ = {};
    }
    const auto inspection = session.inspector().latest();
    const bool looking = (state.tab == Tab::inspect && state.panel_visible) || state.inspect_hover || mouse_.rays_asked();
    rays_shown_ =
        looking && state.show_rays && inspection && inspection->failure.empty() && inspection->job.ready->scene == scene;
    if (rays_shown_)
        append_ray_lines(inspection->result, projection, scene_size(session) * 0.6f, scale, state.selected_ray, marks);
    const auto noise = session.inspector().latest_noise();
    if (looking && state.show_paths && noise && noise->failure.empty() && noise->job.revision == picture_->job.revision)
        append_path_lines(noise->replay, noise->report.brightest, projection, scene_size(session) * 0.6f, scale,
                          state.selected_path, marks);
    if (marks == marks_) return;
    marks_ = std::move(marks);
    ++marks_revision_;
}

void PicturePane::update_lines(Lines& lines, const PicturePlace& place, const VolumeOverlay& overlay, bool moving) {
    const unsigned side = place.side();
    const float scale = ui_scale(), pixels = std::max(ImGui::GetIO().DisplayFramebufferScale.x, 0.1f);
    const Camera& camera = picture_->job.view.camera;
    const std::shared_ptr<const Scene>& scene = picture_->job.ready->scene;
    auto distance = side_of(place).distance;
    // Heat maps have no distances. Those of an earlier picture of the same view are used instead.
    if (distance && !distance->pixels.empty()) {
        lines.seen = distance;
        lines.seen_by = camera;
        lines.seen_scene = scene;
    } else if (lines.seen && lines.seen_scene == scene && same_camera(lines.seen_by, camera)) {
        distance = lines.seen;
    }
    const bool moved = !same_camera(lines.camera, camera), scaled = lines.scale != scale;
    const unsigned stride = moving ? static_cast<unsigned>(overlay.count(side) / kMovingVolumes + 1) : 1;
    const bool volumes = lines.volumes_revision != overlay.revision(side) || scaled || lines.stride != stride ||
                         (moved && overlay.has_spheres(side));
    const bool resized =
        lines.area.width != place.area.width || lines.area.height != place.area.height || lines.pixels != pixels;
    const bool anew = volumes || moved || resized || lines.marks_revision != marks_revision_ ||
                      lines.distance != distance.get() || lines.hides_behind != overlay.hides_behind();
    if (!anew) return;
    const auto begin = std::chrono::steady_clock::now();
    const Projection projection(place.area, camera);
    if (volumes) {
        lines.volumes.clear();
        overlay.append_lines(side, projection.eye(), scale, stride, lines.volumes);
    }
    lines.volumes_revision = overlay.revision(side);
    lines.marks_revision = marks_revision_;
    lines.stride = stride;
    lines.camera = camera;
    lines.area = place.area;
    lines.pixels = pixels;
    lines.scale = scale;
    lines.distance = distance.get();
    lines.hides_behind = overlay.hides_behind();
    lines.any = !lines.volumes.empty() || !marks_.empty();
    if (!lines.any) return;
    const bool known = distance && !distance->pixels.empty();
    if (known && distances_of_[side] != distance && !distances_[side].upload(*distance)) distances_of_[side] = distance;
    LinesBehind behind;
    if (known) behind = {distances_[side].name(), distance.get(), overlay.hides_behind() ? 0.0f : kBehind};
    lines.layer.draw({&lines.volumes, &marks_}, projection, pixels, behind);
    lines_ms_ = ms_since(begin);
}

void PicturePane::draw_lines(ImDrawList& list, const VolumeOverlay& overlay, bool moving) {
    for (const PicturePlace& place : places_) {
        Lines& lines = lines_[place.side()];
        update_lines(lines, place, overlay, moving);
        if (!lines.any || !lines.layer.failure().empty() || lines.layer.drawn() == 0) continue;
        list.AddCallback(blend_premultiplied, nullptr);
        add_part(list, lines.layer.texture(), place.area, place.shown, false);
        list.AddCallback(ImDrawCallback_ResetRenderState, nullptr);
    }
}

void PicturePane::draw(const Rect& area, Session& session, VolumeOverlay& overlay, UiState& state) {
    ImGui::SetNextWindowPos({area.x, area.y});
    ImGui::SetNextWindowSize({area.width, area.height});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
    ImGui::Begin("Viewport", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav |
                     ImGuiWindowFlags_NoScrollWithMouse);
    ImGui::PopStyleVar();
    const float margin = std::round(12 * ui_scale());
    const Rect room{area.x + margin, area.y + margin, std::max(area.width - 2 * margin, 1.0f),
                    std::max(area.height - 2 * margin, 1.0f)};
    const ImVec2 pixels = ImGui::GetIO().DisplayFramebufferScale;
    state.room_width = static_cast<int>(room.width * pixels.x);
    state.room_height = static_cast<int>(room.height * pixels.y);
    if (picture_ && textures_[0].name() != 0) {
        lay_out(room, session, state);
        ImDrawList& list = *ImGui::GetWindowDrawList();
        draw_pictures(list);
        collect_marks(session, state);
        draw_lines(list, overlay, session.moving());
        handles_.clear();
        if (state.show_lights) handles_ = light_handles(Projection(area_, picture_->job.view.camera), session.desired.lights);
        place_move_handles(session, state);
        ImGui::SetCursorScreenPos({room.x, room.y});
        covered_button(
            "picture", {room.width, room.height},
            ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonMiddle | ImGuiButtonFlags_MouseButtonRight);
        const bool wipe = places_.size() == 2 && !side_by_side();
        mouse_.update({*picture_, places_, handles_, 11 * ui_scale(), wipe, move_handles_ ? &*move_handles_ : nullptr}, session,
                      state);
        if (wipe) draw_wipe(list);
        draw_part(list);
        draw_pixel_marks(list, session, state);
        list.ChannelsSplit(2);  // boxes are drawn over handles; the handles' labels avoid the boxes
        list.ChannelsSetCurrent(1);
        draw_hud(list, session, overlay);
        list.ChannelsSetCurrent(0);
        draw_handles(list, session);
        draw_move_handles(list);
        list.ChannelsMerge();
        session.want_distance(overlay.level().has_value() || !marks_.empty() || state.show_lights);
    }
    ImGui::End();
}

}  // namespace clarity::ui
