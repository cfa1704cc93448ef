// The table of keys. A key is one row: in map.bindings of one key map, or in add_common() for all of them.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "rt_plugin.h"
#include "ui/app/key_actions.hpp"
#include "ui/overlay/overlay.hpp"
#include "ui/session/session.hpp"
#include "ui/session/session_output.hpp"
#include "ui/session/session_view.hpp"
#include "ui/widgets/key_map.hpp"
#include "ui/widgets/ui_state.hpp"

namespace clarity::ui {
namespace {

// A key that does something once for each press.
KeyBinding once(int key, const char* name, const char* help, void (*press)(KeyTarget&)) {
    return {key, name, help, Motion::none, press, false};
}
KeyBinding with_ctrl(int key, const char* name, const char* help, void (*press)(KeyTarget&)) {
    return {key, name, help, Motion::none, press, true};
}

template <rt_u32 level>
void toggle_level(KeyTarget& to) {
    to.overlay.toggle(level);
}

// Adds the bindings which all presets share.
void add_common(KeyMap& map) {
    const char* levels = "show that level of the bounding volumes; again: hide";
    const char* frame = "the frame before, the frame after";
    const char* undo = "undo, redo a setting";
    const KeyBinding common[] = {
        once(GLFW_KEY_1, "1", levels, toggle_level<0>),
        once(GLFW_KEY_2, "2", levels, toggle_level<1>),
        once(GLFW_KEY_3, "3", levels, toggle_level<2>),
        once(GLFW_KEY_4, "4", levels, toggle_level<3>),
        once(GLFW_KEY_5, "5", levels, toggle_level<4>),
        once(GLFW_KEY_6, "6", levels, toggle_level<5>),
        once(GLFW_KEY_7, "7", levels, toggle_level<6>),
        once(GLFW_KEY_8, "8", levels, toggle_level<7>),
        once(GLFW_KEY_9, "9", levels, toggle_level<8>),
        once(GLFW_KEY_0, "0", "show the bottom level", toggle_level<RT_LEVEL_BOTTOM>),
        once(GLFW_KEY_F, "F", "print the frame rate to the console", print_frame_rate),
        once(GLFW_KEY_C, "C", "compare two settings, or no longer",
             [](KeyTarget& to) { to.session.compare(!to.session.desired.other); }),
        once(GLFW_KEY_X, "X", "swap the two sides", [](KeyTarget& to) { to.session.swap_sides(); }),
        once(GLFW_KEY_R, "R", "follow the rays of the pixel under the mouse", toggle_inspector),
        once(GLFW_KEY_L, "L", "show the lights, to drag them",
             [](KeyTarget& to) { to.state.show_lights = !to.state.show_lights; }),
        once(GLFW_KEY_M, "M", "show handles that move, turn and scale what is selected",
             [](KeyTarget& to) { to.state.move_handles = !to.state.move_handles; }),
        once(GLFW_KEY_V, "V", "trace the whole picture again, after a part of it",
             [](KeyTarget& to) { to.session.desired.part.reset(); }),
        once(GLFW_KEY_G, "G", "bring what is selected into view, or all", [](KeyTarget& to) { frame_selection(to.session); }),
        once(GLFW_KEY_B, "B", "bookmark this view", add_bookmark),
        once(GLFW_KEY_N, "N", "next bookmark, or camera of the file", go_to_next_bookmark),
        once(GLFW_KEY_SPACE, "Space", "play the clip, or pause it", toggle_playing),
        once(GLFW_KEY_COMMA, ",", frame, [](KeyTarget& to) { to.session.playback().step(to.session.desired, -1); }),
        once(GLFW_KEY_PERIOD, ".", frame, [](KeyTarget& to) { to.session.playback().step(to.session.desired, 1); }),
        with_ctrl(GLFW_KEY_Z, "Ctrl+Z", undo, [](KeyTarget& to) { to.session.undo(); }),
        with_ctrl(GLFW_KEY_Y, "Ctrl+Y", undo, [](KeyTarget& to) { to.session.redo(); }),
        with_ctrl(GLFW_KEY_O, "Ctrl+O", "open a file", [](KeyTarget& to) { to.state.browser_open = true; }),
        with_ctrl(GLFW_KEY_S, "Ctrl+S", "save the picture",
                  [](KeyTarget& to) { to.session.save_picture(next_picture_path(to.state.pictures_folder)); }),
        with_ctrl(GLFW_KEY_E, "Ctrl+E", "save the scene with its edits",
                  [](KeyTarget& to) {
                      const std::string path = scene_path(to.session);
                      save_scene(to.session, path);
                      to.state.notify("saved " + path);
                  }),
        once(GLFW_KEY_HOME, "Home", "back to the first view of the scene", [](KeyTarget& to) { to.session.reset_view(); }),
        once(GLFW_KEY_ESCAPE, "Esc", "cancel what is being prepared; close what is open", close_or_cancel),
        once(GLFW_KEY_F1, "F1", "this list", [](KeyTarget& to) { to.state.keys_open = !to.state.keys_open; }),
        once(GLFW_KEY_F2, "F2", "hide or show the panel",
             [](KeyTarget& to) { to.state.panel_visible = !to.state.panel_visible; }),
    };
    map.bindings.insert(map.bindings.end(), std::begin(common), std::end(common));
}

KeyMap make_thesis() {
    const char* move = "move the camera in X and Z";
    const char* light = "move the light in X and Z";
    KeyMap map{"thesis", "Thesis", false, {}};
    map.bindings = {
        {GLFW_KEY_LEFT, "\u2190", move, Motion::camera_left},
        {GLFW_KEY_RIGHT, "\u2192", move, Motion::camera_right},
        {GLFW_KEY_UP, "\u2191", move, Motion::camera_forward},
        {GLFW_KEY_DOWN, "\u2193", move, Motion::camera_back},
        {GLFW_KEY_PAGE_UP, "PgUp", "move the camera up, down", Motion::camera_up},
        {GLFW_KEY_PAGE_DOWN, "PgDn", "move the camera up, down", Motion::camera_down},
        {GLFW_KEY_I, "I", "pitch the camera", Motion::pitch_up},
        {GLFW_KEY_K, "K", "pitch the camera", Motion::pitch_down},
        {GLFW_KEY_O, "O", "yaw the camera", Motion::yaw_left},
        {GLFW_KEY_P, "P", "yaw the camera", Motion::yaw_right},
        {GLFW_KEY_W, "W", light, Motion::light_forward},
        {GLFW_KEY_S, "S", light, Motion::light_back},
        {GLFW_KEY_A, "A", light, Motion::light_left},
        {GLFW_KEY_D, "D", light, Motion::light_right},
    };
    add_common(map);
    return map;
}

KeyMap make_viewer() {
    const char* walk = "walk";
    const char* light = "move the light in X and Z";
    KeyMap map{"viewer", "Viewer", true, {}};
    map.bindings = {
        {GLFW_KEY_W, "W", walk, Motion::camera_forward},
        {GLFW_KEY_A, "A", walk, Motion::camera_left},
        {GLFW_KEY_S, "S", walk, Motion::camera_back},
        {GLFW_KEY_D, "D", walk, Motion::camera_right},
        {GLFW_KEY_E, "E", "rise, sink", Motion::camera_up},
        {GLFW_KEY_Q, "Q", "rise, sink", Motion::camera_down},
        {GLFW_KEY_LEFT, "\u2190", light, Motion::light_left},
        {GLFW_KEY_RIGHT, "\u2192", light, Motion::light_right},
        {GLFW_KEY_UP, "\u2191", light, Motion::light_forward},
        {GLFW_KEY_DOWN, "\u2193", light, Motion::light_back},
        {GLFW_KEY_PAGE_UP, "PgUp", "move the light up, down", Motion::light_up},
        {GLFW_KEY_PAGE_DOWN, "PgDn", "move the light up, down", Motion::light_down},
    };
    add_common(map);
    return map;
}

}  // namespace

const std::vector<KeyMap>& key_maps() {
    static const std::vector<KeyMap> maps = {make_thesis(), make_viewer()};
    return maps;
}

}  // namespace clarity::ui
