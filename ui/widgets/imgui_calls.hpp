// imgui_calls.hpp -- calls of Dear ImGui that have another form in 1.86 (Debian 12) than in 1.90 (Debian 13).
#pragma once
#include <imgui.h>

namespace clarity::ui {

// A button without a face, over which others may be drawn later: they get the mouse where they lie. In 1.86 the button is told
// so when it is there; since 1.89.7 a button that was not told before keeps every click.
inline bool covered_button(const char* id, const ImVec2& size, ImGuiButtonFlags flags = 0) {
#if IMGUI_VERSION_NUM >= 18970
    ImGui::SetNextItemAllowOverlap();
    return ImGui::InvisibleButton(id, size, flags);
#else
    const bool pressed = ImGui::InvisibleButton(id, size, flags);
    ImGui::SetItemAllowOverlap();
    return pressed;
#endif
}

// ImGui::BeginChild() without a border, with the padding of a window.
inline bool begin_padded_child(const char* id, const ImVec2& size, ImGuiWindowFlags flags = 0) {
#if IMGUI_VERSION_NUM >= 19000
    return ImGui::BeginChild(id, size, ImGuiChildFlags_AlwaysUseWindowPadding, flags);
#else
    return ImGui::BeginChild(id, size, false, flags | ImGuiWindowFlags_AlwaysUseWindowPadding);
#endif
}

inline bool key_pressed(ImGuiKey key) {
#if IMGUI_VERSION_NUM >= 18700
    return ImGui::IsKeyPressed(key);
#else
    return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key));
#endif
}

}  // namespace clarity::ui
