#include "ui/widgets/theme.hpp"

#include <backends/imgui_impl_opengl3.h>

#include <cmath>

#include "ui/widgets/fonts.hpp"

namespace clarity::ui {
namespace {

Fonts the_fonts;
float the_scale = 0;

ImVec4 with_alpha(ImVec4 color, float alpha) {
    color.w = alpha;
    return color;
}

ImVec4 lighter(const ImVec4& color, float by) {
    return {color.x + by, color.y + by, color.z + by, color.w};
}

void set_colors(ImGuiStyle& style) {
    using namespace colors;
    ImGui::StyleColorsDark(&style);
    const ImVec4 frame = lighter(kPanel, 0.052f), clear(0, 0, 0, 0);
    ImVec4* c = style.Colors;
    c[ImGuiCol_Text] = kText;
    c[ImGuiCol_TextDisabled] = kDim;
    c[ImGuiCol_WindowBg] = kGround;
    c[ImGuiCol_ChildBg] = clear;
    c[ImGuiCol_PopupBg] = lighter(kPanel, 0.02f);
    c[ImGuiCol_Border] = with_alpha(kText, 0.10f);
    c[ImGuiCol_FrameBg] = frame;
    c[ImGuiCol_FrameBgHovered] = lighter(frame, 0.035f);
    c[ImGuiCol_FrameBgActive] = lighter(frame, 0.06f);
    c[ImGuiCol_CheckMark] = kAccent;
    c[ImGuiCol_SliderGrab] = clear;  // widgets.cpp fills sliders from the left
    c[ImGuiCol_SliderGrabActive] = clear;
    c[ImGuiCol_Button] = lighter(frame, 0.03f);
    c[ImGuiCol_ButtonHovered] = with_alpha(kAccent, 0.45f);
    c[ImGuiCol_ButtonActive] = with_alpha(kAccent, 0.75f);
    c[ImGuiCol_Header] = with_alpha(kAccent, 0.22f);
    c[ImGuiCol_HeaderHovered] = with_alpha(kAccent, 0.32f);
    c[ImGuiCol_HeaderActive] = with_alpha(kAccent, 0.45f);
    c[ImGuiCol_Separator] = with_alpha(kText, 0.08f);
    c[ImGuiCol_Tab] = clear;
    c[ImGuiCol_TabHovered] = with_alpha(kAccent, 0.30f);
    c[ImGuiCol_TabActive] = with_alpha(kAccent, 0.28f);
    c[ImGuiCol_ScrollbarBg] = clear;
    c[ImGuiCol_ScrollbarGrab] = with_alpha(kText, 0.16f);
    c[ImGuiCol_ScrollbarGrabHovered] = with_alpha(kText, 0.26f);
    c[ImGuiCol_ScrollbarGrabActive] = with_alpha(kText, 0.36f);
    c[ImGuiCol_PlotLines] = kAccent;
    c[ImGuiCol_PlotHistogram] = kAccent;
    c[ImGuiCol_TextSelectedBg] = with_alpha(kAccent, 0.40f);
    c[ImGuiCol_TableRowBgAlt] = with_alpha(kText, 0.025f);
}

void set_sizes(ImGuiStyle& style) {
    style.WindowPadding = {14, 12};
    style.FramePadding = {8, 4};
    style.ItemSpacing = {8, 6};
    style.ItemInnerSpacing = {6, 4};
    style.CellPadding = {4, 3};
    style.ScrollbarSize = 11;
    style.GrabMinSize = 10;
    style.WindowRounding = 0;
    style.ChildRounding = 6;
    style.FrameRounding = 4;
    style.PopupRounding = 5;
    style.ScrollbarRounding = 6;
    style.GrabRounding = 3;
    style.TabRounding = 4;
    style.WindowBorderSize = 0;
    style.ChildBorderSize = 0;
    style.PopupBorderSize = 1;
    style.FrameBorderSize = 0;
    style.TabBorderSize = 0;
    style.WindowMenuButtonPosition = ImGuiDir_None;
}

}  // namespace

void apply_theme(float scale) {
    if (scale == the_scale) return;
    const bool first = the_scale == 0;
    the_scale = scale;
    ImGuiStyle style;
    set_colors(style);
    set_sizes(style);
    style.ScaleAllSizes(scale);
    ImGui::GetStyle() = style;

    ImGuiIO& io = ImGui::GetIO();
    io.Fonts->Clear();
    const float pixels = std::round(14.0f * scale);
    the_fonts.text = add_font(*io.Fonts, Face::text, pixels);
    the_fonts.bold = add_font(*io.Fonts, Face::bold, pixels);
    the_fonts.mono = add_font(*io.Fonts, Face::mono, std::round(13.0f * scale));
    if (!first) {  // the backend creates its first texture by itself
        ImGui_ImplOpenGL3_DestroyFontsTexture();
        ImGui_ImplOpenGL3_CreateFontsTexture();
    }
}

const Fonts& fonts() {
    return the_fonts;
}
float ui_scale() {
    return the_scale;
}

}  // namespace clarity::ui
