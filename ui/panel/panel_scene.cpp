// The Scene tab: files, tree, materials, camera, lights, background.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <utility>

#include "ui/panel/panel.hpp"
#include "ui/session/session_output.hpp"
#include "ui/session/session_view.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

void open_rows(Session& session, UiState& state) {
    const float half = share_of_line(2);
    if (button("Open\u2026", "a model or a scene (Ctrl+O); several, chosen with Ctrl+click, become one scene", half))
        state.browse(BrowseFor::scene);
    ImGui::SameLine();
    ImGui::SetNextItemWidth(half);
    if (ImGui::BeginCombo("##recent", "Recent files", ImGuiComboFlags_HeightLarge)) {
        for (const std::string& file : state.recent_files) {
            ImGui::PushID(file.c_str());
            if (ImGui::Selectable(file_name(file).c_str())) session.open({file});
            note_rect("recent " + file_name(file));
            tooltip(file);
            ImGui::PopID();
        }
        if (state.recent_files.empty()) ImGui::TextUnformatted("none yet");
        ImGui::EndCombo();
    }
    note_rect("Recent files");
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (std::exchange(state.focus_path_asked, false)) ImGui::SetKeyboardFocusHere();
    const bool entered = ImGui::InputTextWithHint("##path", "or a path, and Enter; or drop files onto the window", &state.path,
                                                  ImGuiInputTextFlags_EnterReturnsTrue);
    if (entered && !state.path.empty()) session.open({state.path});
}

void save_row(Session& session, UiState& state) {
    static std::string path;
    const float width = ImGui::CalcTextSize("Save scene").x + 2 * ImGui::GetStyle().FramePadding.x;
    ImGui::SetNextItemWidth(-width - ImGui::GetStyle().ItemSpacing.x);
    ImGui::InputTextWithHint("##scene path", file_name(scene_path(session)).c_str(), &path);
    note_rect("Scene path");
    tooltip("a path that ends in .scene; empty: " + scene_path(session));
    ImGui::SameLine();
    if (button("Save scene", "a text scene that loads these files and makes the edits of this window (Ctrl+E)", width))
        attempt(session, [&] {
            const std::string to = path.empty() ? scene_path(session) : path;
            save_scene(session, to);
            state.notify("saved " + to);
        });
}

void fact_rows(const Ready& ready) {
    const Scene& scene = *ready.loaded->scene;
    row_text("Triangles", count_text(static_cast<double>(ready.loaded->placed_triangles)),
             "in the world: those of every instance");
    row_text("Meshes", std::to_string(scene.meshes.size()) + " in " + plural(scene.instances.size(), "place"));
    const size_t analytic = scene.spheres.size() + scene.polygons.size() + scene.planes.size();
    if (analytic > 0)
        row_text("Analytic", plural(scene.spheres.size(), "sphere") + ", " + plural(scene.polygons.size(), "polygon") + ", " +
                                 plural(scene.planes.size(), "plane"));
    if (!scene.shapes.empty()) row_text("Shapes", std::to_string(scene.shapes.size()), "made by plugins: cylinders, ...");
    row_text("Materials", std::to_string(scene.materials.size()) + ", " + plural(scene.textures.size(), "texture"));
    row_text("Up axis", std::string(1, "XYZ"[scene.up_axis % 3]), "as the file states it; the scene is not rotated");
    row_text("Unit", scene.unit_scale > 0 ? number_text(scene.unit_scale) + " m" : "not said", "metres per unit of the file");
    row_text("Diagonal", number_text(ready.loaded->bounds.diagonal()), "of the box around it, in units of the file");
    if (!scene.warnings.empty()) {
        wrapped_text(plural(scene.warnings.size(), "warning") + " in the log", colors::kAmber);
        tooltip(scene.warnings.front());
    }
}

bool drag3(const char* label, const char* help, float* values, float speed) {
    row_label(label, help);
    return ImGui::DragFloat3((std::string("##") + label).c_str(), values, speed, 0, 0, "%.3g");
}

void camera_rows(Session& session, UiState& state) {
    const auto ready = session.ready();
    Camera& camera = session.desired.camera;
    if (ready && !ready->cameras.empty()) {
        row_label("From file", "cameras that the file holds");
        if (ImGui::BeginCombo("##cameras", camera.name.empty() ? "choose" : camera.name.c_str())) {
            for (size_t i = 0; i < ready->cameras.size(); ++i) {
                const Camera& other = ready->cameras[i];
                const std::string name = other.name.empty() ? "camera " + std::to_string(i + 1) : other.name;
                ImGui::PushID(static_cast<int>(i));
                if (ImGui::Selectable(name.c_str())) camera = other;
                note_rect(name);
                ImGui::PopID();
            }
            ImGui::EndCombo();
        }
    }
    const float speed = scene_size(session) * 0.002f;
    drag3("Eye", "where the camera is, in units of the file", camera.eye.data(), speed);
    drag3("Target", "the point it looks at", camera.target.data(), speed);
    float degrees = camera.fov_y_rad * 57.29578f;
    row_label("Field of view", "vertical, in degrees");
    if (slider("##fov", degrees, 5, 120, "%.1f\u00b0")) camera.fov_y_rad = degrees / 57.29578f;
    row_label("Aperture", "diameter of the lens, in units of the file; 0: a pinhole. For `path`");
    const float step = scene_size(session) * 0.0005f;
    if (ImGui::DragFloat("##aperture", &camera.aperture, step, 0, 0, "%.3g")) camera.aperture = std::max(camera.aperture, 0.0f);
    row_label("Focus", "distance along the view at which the lens is sharp; 0: that of the target");
    if (ImGui::DragFloat("##focus", &camera.focus, 10 * step, 0, 0, "%.3g")) camera.focus = std::max(camera.focus, 0.0f);
    row_label("Key speed", "how fast the keys move the camera; 1: a third of the scene a second");
    slider("##speed", state.camera_speed, 0.05f, 10, "%.2f", true);
    const float half = share_of_line(2);
    if (button("Show all", "all of the scene, or what is selected, comes into view (G)", half)) frame_selection(session);
    ImGui::SameLine();
    if (button("Reset view", "the scene's own camera, lights and materials again (Home)", half)) session.reset_view();
    CameraPath& path = session.desired.camera_path;
    if (button("Set camera key",
               "the camera is here at the time of the timeline; with a key at another time it moves from one to the other. A "
               "scene that does not move gets a timeline of ten seconds",
               half))
        session.playback().set_camera_key(session.desired);
    ImGui::SameLine();
    const std::string keys = path.empty() ? "no keys" : "Clear " + plural(path.keys.size(), "key");
    if (path.empty())
        dim_text(keys);
    else if (button(keys.c_str(), "takes the camera's path away; Ctrl+Z brings it back", half))
        path = {};
}

}  // namespace

void draw_scene_tab(Session& session, UiState& state) {
    section("FILE");
    open_rows(session, state);
    const auto ready = session.ready();
    if (!ready) {
        dim_text("no scene yet");
        return;
    }
    for (const std::string& file : ready->loaded->files) {
        ImGui::TextUnformatted(cut_front_to(file_name(file), ImGui::GetContentRegionAvail().x).c_str());
        tooltip(file);
    }
    save_row(session, state);
    if (folding_section("WHAT IT HOLDS", false)) fact_rows(*ready);
    if (folding_section("TREE")) draw_scene_tree(session, state);
    if (folding_section("OBJECT")) draw_object_rows(session, state);
    if (folding_section("MATERIAL")) draw_material_rows(session, state);
    if (folding_section("LIGHTS")) draw_light_rows(session, state);
    if (folding_section("CAMERA")) camera_rows(session, state);
    if (folding_section("BOOKMARKS")) draw_bookmark_rows(session, state);
    if (folding_section("SURROUNDINGS")) {
        row_label("Background", "colour of rays that hit nothing; linear");
        color_field("##background", session.desired.background.data());
        row_label("Ambient", "light that comes from everywhere; linear");
        color_field("##ambient", session.desired.ambient.data());
        draw_sky_rows(session);
    }
}

}  // namespace clarity::ui
