// The part of the Render tab for output: presets, pictures, the command line, sequences of pictures.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <filesystem>

#include "base/error.hpp"
#include "ui/browser/file_listing.hpp"
#include "ui/panel/panel.hpp"
#include "ui/panel/preset_folder.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

namespace fs = std::filesystem;

// A value read from the file system, at most once a second.
template <class Value>
struct Remembered {
    Value value{};
    double asked_s = -1e9;
    std::string of;
    template <class Ask>
    const Value& get(const std::string& about, Ask ask) {
        const double now = ImGui::GetTime();
        if (of != about || now - asked_s > 1 || now < asked_s) {
            value = ask();
            of = about;
            asked_s = now;
        }
        return value;
    }
};

void preset_rows(Session& session, UiState& state) {
    static std::string name;
    static Remembered<std::vector<std::string>> names;
    row_label("Preset",
              "all settings, structure, device, camera, lights and materials under a name; a name that ends in .json is "
              "a file of that path");
    const float width = ImGui::CalcTextSize("Save").x + 2 * ImGui::GetStyle().FramePadding.x;
    ImGui::SetNextItemWidth(-width - ImGui::GetStyle().ItemSpacing.x);
    const bool entered = ImGui::InputTextWithHint("##preset", "name", &name, ImGuiInputTextFlags_EnterReturnsTrue);
    ImGui::SameLine();
    ImGui::BeginDisabled(name.empty());
    const bool pressed = button("Save##preset", "save the current settings under this name", width);
    note_rect("Save preset");
    ImGui::EndDisabled();
    if ((entered || pressed) && !name.empty())
        attempt(session, [&] {
            session.save_preset(preset_path(state.presets_folder, name));
            state.notify("preset " + name + " saved");
            names.asked_s = -1e9;
        });
    const auto& saved = names.get(state.presets_folder, [&] { return preset_names(state.presets_folder); });
    for (const std::string& preset : saved) {
        ImGui::PushID(preset.c_str());
        const float cross = ImGui::GetFrameHeight();
        if (ImGui::Selectable(cut_to(preset, ImGui::GetContentRegionAvail().x - cross * 1.5f).c_str(), false, 0,
                              {ImGui::GetContentRegionAvail().x - cross * 1.2f, 0}))
            attempt(session, [&] { session.load_preset(preset_path(state.presets_folder, preset)); });
        note_rect("preset " + preset);
        tooltip("load " + preset_path(state.presets_folder, preset));
        ImGui::SameLine(ImGui::GetCursorPosX() + ImGui::GetContentRegionAvail().x - cross);
        if (ImGui::SmallButton("\u00d7")) ImGui::OpenPopup("delete");
        note_rect("delete preset " + preset);
        if (ImGui::BeginPopup("delete")) {
            if (ImGui::Selectable(("delete the preset " + preset).c_str())) {
                std::error_code error;
                fs::remove(preset_path(state.presets_folder, preset), error);
                names.asked_s = -1e9;
            }
            note_rect("delete the preset " + preset);
            ImGui::EndPopup();
        }
        ImGui::PopID();
    }
    if (button("Load a preset\u2026", "from any file", -FLT_MIN)) state.browse(BrowseFor::preset);
}

std::string with_extension(const std::string& path, const char* extension) {
    return fs::path(path).replace_extension(extension).string();
}

void save_picture(Session& session, UiState& state, std::string& path, const std::string& next, const char* extension) {
    attempt(session, [&] {
        const std::string chosen = with_extension(path.empty() ? next : path, extension);
        session.save_picture(chosen);
        if (!path.empty()) {
            const fs::path folder = fs::path(chosen).parent_path();
            state.pictures_folder = folder.empty() ? "." : folder.string();
            path.clear();
        }
    });
}

void picture_rows(Session& session, UiState& state) {
    static std::string path;
    static Remembered<std::string> next;
    const std::string& free_name = next.get(state.pictures_folder, [&] {
        try {
            return next_picture_path(state.pictures_folder);
        } catch (const Error&) {
            return state.pictures_folder + "/picture.png";
        }
    });
    row_label("Folder", "folder of pictures whose file name has no folder");
    if (button((cut_front_to(absolute_folder(state.pictures_folder), ImGui::GetContentRegionAvail().x - 16 * ui_scale()) +
                "##folder")
                   .c_str(),
               absolute_folder(state.pictures_folder) + "\nclick to choose another", -FLT_MIN))
        state.browse(BrowseFor::folder_of_pictures);
    note_rect("Folder");
    row_label("File", "path of the picture; empty: the next free number in the folder");
    ImGui::InputTextWithHint("##picture", file_name(free_name).c_str(), &path);
    const float half = share_of_line(2);
    if (button("Save PNG", "as shown, once all samples are in", half)) {
        save_picture(session, state, path, free_name, ".png");
        next.asked_s = -1e9;
    }
    ImGui::SameLine();
    if (button("Save EXR", "the film's linear values as 32-bit floats, once all samples are in", half))
        save_picture(session, state, path, free_name, ".exr");
    if (button("Copy command line", "`clarity render \u2026` that makes exactly this picture, to the clipboard", -FLT_MIN))
        attempt(session, [&] {
            const std::string command = session.render_command("picture.png");
            ImGui::SetClipboardText(command.c_str());
            state.notify("command line copied: " + command);
        });
}

void sequence_rows(Session& session, UiState& state) {
    static bool through_bookmarks = false;
    static int frames = 60;
    static std::string pattern;
    Sequence& sequence = session.sequence();
    if (sequence.running()) {
        const std::string text =
            plural(static_cast<size_t>(sequence.done()), "frame") + " of " + std::to_string(sequence.count());
        ImGui::ProgressBar(static_cast<float>(sequence.done()) / static_cast<float>(std::max(1, sequence.count())),
                           {-FLT_MIN, 0}, text.c_str());
        dim_text(sequence.pattern());
        if (button("Stop the sequence", "the camera goes back to where it was (Esc)", -FLT_MIN)) sequence.stop(session);
        return;
    }
    row_label("Camera", "once around the target, or smoothly from bookmark to bookmark");
    if (ImGui::BeginCombo("##path", through_bookmarks ? "Through the bookmarks" : "Turntable")) {
        if (option("Turntable", !through_bookmarks)) through_bookmarks = false;
        if (option("Through the bookmarks", through_bookmarks)) through_bookmarks = true;
        ImGui::EndCombo();
    }
    row_label("Frames");
    ImGui::InputInt("##frames", &frames, 1, 10);
    frames = std::clamp(frames, 1, 9999);
    row_label("Files", "#### becomes the frame's number");
    const std::string standard = (fs::path(state.pictures_folder) / "sequence_####.png").string();
    ImGui::InputTextWithHint("##pattern", "sequence_####.png", &pattern);
    const bool enough = !through_bookmarks || state.bookmarks.size() >= 2;
    ImGui::BeginDisabled(!enough);
    if (button("Start the sequence", enough ? "" : "bookmark two views first: B, or Scene > Bookmarks", -FLT_MIN))
        attempt(session, [&] {
            const std::string files = pattern.empty() ? standard : pattern;
            if (!through_bookmarks) return sequence.start_turntable(session, files, frames);
            std::vector<Camera> cameras;
            for (const Bookmark& bookmark : state.bookmarks) cameras.push_back(bookmark.camera);
            sequence.start_path(session, files, frames, cameras);
        });
    ImGui::EndDisabled();
}

}  // namespace

void draw_output_rows(Session& session, UiState& state) {
    if (folding_section("SAVE")) picture_rows(session, state);
    if (folding_section("PRESETS")) preset_rows(session, state);
    if (folding_section("SEQUENCE", false)) sequence_rows(session, state);
}

}  // namespace clarity::ui
