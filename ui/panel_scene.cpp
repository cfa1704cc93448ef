// The tab of what is traced: files, camera, lights, background.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <cmath>

#include "ui/panel.hpp"
#include "ui/theme.hpp"
#include "ui/widgets.hpp"

namespace clarity {
namespace {

void open_row(Session& session, UiState& state) {
    const float button = 64 * ui_scale();
    ImGui::SetNextItemWidth(-button - ImGui::GetStyle().ItemSpacing.x);
    if (std::exchange(state.focus_path_asked, false)) ImGui::SetKeyboardFocusHere();
    const bool entered =
        ImGui::InputTextWithHint("##path", "path of a model or scene", &state.path, ImGuiInputTextFlags_EnterReturnsTrue);
    ImGui::SameLine();
    const bool pressed = ImGui::Button("Open", {button, 0});
    if ((entered || pressed) && !state.path.empty()) session.open({state.path});
    dim_text("or drop files onto the window; several become one scene");
}

void file_rows(Session& session) {
    const auto ready = session.ready();
    if (!ready) {
        dim_text("no scene yet");
        return;
    }
    const Scene& scene = *ready->loaded->scene;
    for (const std::string& file : ready->loaded->files) {
        ImGui::TextUnformatted(file.substr(file.find_last_of('/') + 1).c_str());
        tooltip(file);
    }
    row_text("Triangles", count_text(static_cast<double>(ready->loaded->placed_triangles)),
             "in the world: those of every instance");
    row_text("Meshes", std::to_string(scene.meshes.size()) + " in " + std::to_string(scene.instances.size()) + " places");
    const size_t analytic = scene.spheres.size() + scene.polygons.size() + scene.planes.size();
    if (analytic > 0)
        row_text("Analytic", std::to_string(scene.spheres.size()) + " spheres, " + std::to_string(scene.polygons.size()) +
                                 " polygons, " + std::to_string(scene.planes.size()) + " planes");
    row_text("Materials", std::to_string(scene.materials.size()) + ", " + std::to_string(scene.textures.size()) + " textures");
    row_text("Up axis", std::string(1, "XYZ"[scene.up_axis % 3]), "as the file says it; nothing is turned");
    row_text("Unit", scene.unit_scale > 0 ? number_text(scene.unit_scale) + " m" : "not said", "metres per unit of the file");
    row_text("Diagonal", number_text(ready->loaded->bounds.diagonal()), "of the box around it, in units of the file");
    if (!scene.warnings.empty()) {
        ImGui::PushStyleColor(ImGuiCol_Text, colors::kAmber);
        ImGui::Text("%zu warnings in the log", scene.warnings.size());
        ImGui::PopStyleColor();
        tooltip(scene.warnings.front());
    }
}

bool drag3(const char* label, const char* help, float* values, float speed) {
    row_label(label, help);
    return ImGui::DragFloat3((std::string("##") + label).c_str(), values, speed, 0, 0, "%.3g");
}

void camera_rows(Session& session, UiState& state) {
    const auto ready = session.ready();
    Camera& camera = session.wish.camera;
    if (ready && !ready->loaded->scene->cameras.empty()) {
        row_label("From file", "cameras that the file holds");
        if (ImGui::BeginCombo("##cameras", camera.name.empty() ? "choose" : camera.name.c_str())) {
            for (size_t i = 0; i < ready->loaded->scene->cameras.size(); ++i) {
                const Camera& other = ready->loaded->scene->cameras[i];
                const std::string name = other.name.empty() ? "camera " + std::to_string(i + 1) : other.name;
                ImGui::PushID(static_cast<int>(i));
                if (ImGui::Selectable(name.c_str())) camera = other;
                ImGui::PopID();
            }
            ImGui::EndCombo();
        }
    }
    const float speed = session.scene_size() * 0.002f;
    drag3("Eye", "where the camera is, in units of the file", camera.eye.data(), speed);
    drag3("Target", "the point it looks at", camera.target.data(), speed);
    float degrees = camera.fov_y_rad * 57.29578f;
    row_label("Field of view", "vertical, in degrees");
    if (slider("##fov", degrees, 5, 120, "%.1f\u00b0")) camera.fov_y_rad = degrees / 57.29578f;
    row_label("Key speed", "how fast the keys move the camera; 1: a third of the scene a second");
    slider("##speed", state.camera_speed, 0.05f, 10, "%.2f", true);
    row_label("");
    if (ImGui::Button("Reset view", {-FLT_MIN, 0})) session.reset_view();
    tooltip("the scene's own camera and lights again");
}

void light_rows(Session& session) {
    auto& lights = session.wish.lights;
    if (lights.empty()) {
        dim_text("this scene has no lights");
        return;
    }
    session.selected_light = std::min<unsigned>(session.selected_light, static_cast<unsigned>(lights.size()) - 1);
    row_label("Light", "the keys move this one");
    if (ImGui::BeginCombo("##light", lights[session.selected_light].name.c_str())) {
        for (unsigned i = 0; i < lights.size(); ++i) {
            ImGui::PushID(static_cast<int>(i));
            if (ImGui::Selectable((lights[i].name + (lights[i].on ? "" : "  (off)")).c_str(), i == session.selected_light))
                session.selected_light = i;
            ImGui::PopID();
        }
        ImGui::EndCombo();
    }
    WishedLight& light = lights[session.selected_light];
    row_label("On");
    ImGui::Checkbox("##on", &light.on);
    if (light.values.kind == RT_LIGHT_DIRECTIONAL) {
        if (drag3("Direction", "towards the light", light.values.position, 0.005f)) {
            float squared = 0;
            for (const float x : light.values.position) squared += x * x;
            if (squared > 0)
                for (float& x : light.values.position) x /= std::sqrt(squared);
        }
    } else {
        drag3("Position", "in units of the file", light.values.position, session.scene_size() * 0.002f);
    }
    row_label("Colour", "linear, intensity included");
    ImGui::ColorEdit3("##colour", light.values.color, ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR);
}

}  // namespace

void draw_scene_tab(Session& session, UiState& state) {
    section("FILE");
    open_row(session, state);
    file_rows(session);
    section("CAMERA");
    camera_rows(session, state);
    section("LIGHTS");
    light_rows(session);
    section("SURROUNDINGS");
    const ImGuiColorEditFlags flags = ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR;
    row_label("Background", "what rays see that hit nothing; linear");
    ImGui::ColorEdit3("##background", session.wish.background.data(), flags);
    row_label("Ambient", "light that comes from everywhere; linear");
    ImGui::ColorEdit3("##ambient", session.wish.ambient.data(), flags);
}

}  // namespace clarity
