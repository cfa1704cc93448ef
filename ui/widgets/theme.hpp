// theme.hpp -- the look of the window: colours, spacing and fonts at any scale.
#pragma once
#include <imgui.h>

namespace clarity::ui {

namespace colors {
inline const ImVec4 kGround{0.078f, 0.086f, 0.102f, 1.0f};  // behind the picture
inline const ImVec4 kPanel{0.106f, 0.118f, 0.141f, 1.0f};
inline const ImVec4 kHudGround{0.129f, 0.145f, 0.173f, 0.97f};  // over the picture
inline const ImVec4 kText{0.878f, 0.898f, 0.925f, 1.0f};
inline const ImVec4 kDim{0.553f, 0.592f, 0.655f, 1.0f};
inline const ImVec4 kAccent{0.329f, 0.647f, 0.949f, 1.0f};
inline const ImVec4 kAmber{0.957f, 0.706f, 0.314f, 1.0f};
inline const ImVec4 kRed{0.957f, 0.443f, 0.420f, 1.0f};
inline const ImVec4 kGreen{0.467f, 0.796f, 0.545f, 1.0f};
}  // namespace colors

struct Fonts {
    ImFont* text = nullptr;
    ImFont* bold = nullptr;
    ImFont* mono = nullptr;
};

// Sets the style and builds the fonts for this scale (1: 96 dpi). Call it outside of a frame.
void apply_theme(float scale);
const Fonts& fonts();
// The current scale. Multiply lengths by it.
float ui_scale();

}  // namespace clarity::ui
