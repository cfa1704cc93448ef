// The rows of the sky.
#include <imgui.h>

#include "scene/sky_kinds.hpp"
#include "ui/panel/panel.hpp"
#include "ui/session/session_view.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"
#include "view/edit/edit.hpp"
#include "view/settings/settings.hpp"

namespace clarity::ui {
namespace {

bool sky_kind_row(const Scene& scene, const clarity::View& view, SkyValues& sky) {
    std::string help = "what lies beyond the scene and lights it, for the tracer `path`";
    for (const SkyKind& kind : sky_kinds()) help += "; " + std::string(kind.label) + ": " + kind.help;
    row_label("Sky", help);
    if (!ImGui::BeginCombo("##sky", sky_kind_of(sky.kind).label)) return false;
    const rt_u32 before = sky.kind;
    for (const SkyKind& kind : sky_kinds())
        if (is_possible_sky(scene, kind.kind) && option(kind.label, before == kind.kind) && before != kind.kind)
            choose_sky_kind(scene, view, kind.kind, sky);
    ImGui::EndCombo();
    return sky.kind != before;
}

}  // namespace

void draw_sky_rows(Session& session) {
    const auto ready = session.ready();
    if (!ready) return;
    const Scene& scene = *ready->loaded->scene;
    clarity::View view;  // what the sky depends on
    view.background = session.desired.background;
    view.sky = session.desired.sky;
    SkyValues sky = sky_of(scene, view);
    bool changed = sky_kind_row(scene, view, sky);
    ImGui::PushID("sky");
    for (const Key& key : sky_kind_of(sky.kind).keys) {
        std::array<float, 3> value = value_of(key, &sky);
        if (key.alias || !key_row(key, value, 1)) continue;
        set_value(key, &sky, value);
        changed = true;
    }
    ImGui::PopID();
    if (sky.kind != RT_NONE && picture_of_tracer(session.desired.main.settings.tracer) != kPathPicture)
        dim_text("the sky is for the tracer `path`");
    if (changed) session.desired.sky = sky;
}

}  // namespace clarity::ui
