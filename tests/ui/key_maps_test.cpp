// Presses every binding of every key map with real key events and checks that it does what its help says. A new binding without
// a case here fails.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "ui/driver/window_fixture.hpp"
#include "ui/widgets/key_map.hpp"

namespace clarity::ui {
namespace {

namespace fs = std::filesystem;

Point minus(const Point& a, const Point& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
double dot(const Point& a, const Point& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
double length(const Point& a) {
    return std::sqrt(dot(a, a));
}
Point unit(const Point& a) {
    const double l = length(a);
    return {a[0] / l, a[1] / l, a[2] / l};
}
Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Point times(const Point& a, double f) {
    return {a[0] * f, a[1] * f, a[2] * f};
}

// Returns the name that xdotool uses for a key of the help text.
std::string x_name(const std::string& help_name) {
    static const std::map<std::string, std::string> named = {
        {"\u2190", "Left"}, {"\u2192", "Right"}, {"\u2191", "Up"},   {"\u2193", "Down"}, {"PgUp", "Prior"},
        {"PgDn", "Next"},   {"Esc", "Escape"},   {"Space", "space"}, {",", "comma"},     {".", "period"}};
    if (const auto found = named.find(help_name); found != named.end()) return found->second;
    if (help_name.rfind("Ctrl+", 0) == 0) return "ctrl+" + x_name(help_name.substr(5));
    return help_name.size() == 1 ? std::string(1, char(std::tolower(help_name[0]))) : help_name;
}

class KeyMaps : public WindowTest, public ::testing::WithParamInterface<std::string> {
 protected:
    void press(const KeyBinding& binding) { window->key(x_name(binding.name)); }
    bool reaches(const std::string& key, const nlohmann::json& value) {
        return window->reaches([&](const nlohmann::json& state) { return state.contains(key) && state[key] == value; });
    }
    void check(const KeyMap& map, const KeyBinding& binding);
    void check_motion(const KeyMap& map, const KeyBinding& binding);
    void check_common(const KeyBinding& binding);
    void check_sides(const KeyBinding& binding);
    void check_inspector(const KeyBinding& binding);
    void check_saved_scene(const KeyBinding& binding);
    void check_saving(const KeyBinding& binding);
    void check_undo();
    void check_views(const KeyBinding& binding);
    void check_time(const KeyBinding& binding);

    std::unique_ptr<WindowDriver> window;
};

// Checks the motion of eye, target or light while a key is held.
void KeyMaps::check_motion(const KeyMap& map, const KeyBinding& binding) {
    const auto was = window->state();
    const Point eye = was["eye"], target = was["target"];
    const Point sight = unit(minus(target, eye)), up = {0, 1, 0}, right = unit(cross(sight, up));
    const Point ahead = unit(cross(up, right)), forward = map.mouse_look ? sight : ahead;
    struct Case {
        const char* moves;
        Point along;
    };
    const std::map<Motion, Case> cases = {
        {Motion::camera_left, {"eye", times(right, -1)}},
        {Motion::camera_right, {"eye", right}},
        {Motion::camera_forward, {"eye", forward}},
        {Motion::camera_back, {"eye", times(forward, -1)}},
        {Motion::camera_up, {"eye", up}},
        {Motion::camera_down, {"eye", times(up, -1)}},
        {Motion::pitch_up, {"target", cross(right, sight)}},
        {Motion::pitch_down, {"target", cross(sight, right)}},
        {Motion::yaw_left, {"target", times(right, -1)}},
        {Motion::yaw_right, {"target", right}},
        {Motion::light_left, {"light", times(right, -1)}},
        {Motion::light_right, {"light", right}},
        {Motion::light_forward, {"light", ahead}},
        {Motion::light_back, {"light", times(ahead, -1)}},
        {Motion::light_up, {"light", up}},
        {Motion::light_down, {"light", times(up, -1)}},
    };
    ASSERT_TRUE(cases.count(binding.motion)) << "no test for what this key does";
    const Case& c = cases.at(binding.motion);
    press(binding);
    window->settle();
    const auto now = window->state();
    const Point moved = minus(now[c.moves], was[c.moves]);
    ASSERT_GT(length(moved), 1e-3);
    EXPECT_GT(dot(unit(moved), c.along), 0.99);
    const Point eye_moved = minus(now["eye"], eye), target_moved = minus(now["target"], target);
    if (c.moves == std::string("light")) {
        EXPECT_EQ(now["eye"], was["eye"]);
        EXPECT_EQ(now["target"], was["target"]);
    } else {
        EXPECT_EQ(now["light"], was["light"]);
        if (c.moves == std::string("target"))
            EXPECT_EQ(now["eye"], was["eye"]);
        else
            EXPECT_LT(length(minus(eye_moved, target_moved)), 1e-4);  // the viewing direction stays
    }
}

void KeyMaps::check_sides(const KeyBinding& binding) {
    ASSERT_TRUE(reaches("comparing", false));
    if (binding.name == std::string("C")) {
        press(binding);
        EXPECT_TRUE(reaches("comparing", true));
        press(binding);
        EXPECT_TRUE(reaches("comparing", false));
        return;
    }
    ASSERT_EQ(window->command("compare b"), "");
    ASSERT_EQ(window->command("set depth 2"), "");
    const auto depths = [&](int main, int other) {
        return window->reaches(
            [&](const nlohmann::json& state) {
                return state["depth"] == main && state.contains("other") && state["other"]["depth"] == other;
            },
            20);
    };
    const int depth = window->state()["depth"];
    EXPECT_TRUE(depths(depth, 2));
    press(binding);
    EXPECT_TRUE(depths(2, depth));
    press(binding);
    EXPECT_TRUE(depths(depth, 2));
    ASSERT_EQ(window->command("compare off"), "");
}

void KeyMaps::check_inspector(const KeyBinding& binding) {
    window->move(window->place_of_pixel(20, 20));
    press(binding);
    ASSERT_TRUE(reaches("inspect_hover", true));
    for (const auto& [x, y] : {std::pair(30, 40), std::pair(60, 50)}) {
        window->move(window->place_of_pixel(x, y));
        window->settle();
        const auto inspection = window->query("inspection");
        EXPECT_EQ(inspection["x"], x);
        EXPECT_EQ(inspection["y"], y);
    }
    press(binding);
    ASSERT_TRUE(reaches("inspect_hover", false));
    window->move(window->place_of_pixel(10, 10));
    window->settle();
    EXPECT_EQ(window->query("inspection")["x"], 60);
}

void KeyMaps::check_saving(const KeyBinding& binding) {
    const fs::path path = fs::path(window->folder()) / "started_in/clarity_0001.png";
    EXPECT_FALSE(fs::exists(path));
    press(binding);
    window->settle();
    ASSERT_TRUE(fs::exists(path)) << window->errors();
    EXPECT_EQ(difference(window->picture(), read_png(path), 0), 0);
    fs::remove(path);
}

void KeyMaps::check_saved_scene(const KeyBinding& binding) {
    const std::string original = source_path("scenes/primitives.scene");
    const fs::path own = fs::path(window->folder()) / "own.scene";
    std::ofstream(own) << "sphere center 0 1 0 radius 1\nlight point position 0 5 5\n";
    ASSERT_EQ(window->command("open " + own.string()), "");
    window->settle();
    const auto bytes = fs::file_size(own);
    press(binding);
    window->settle();
    EXPECT_GT(fs::file_size(own), bytes) << "it has the camera of the window now";
    ASSERT_EQ(window->command("open " + original), "");
    window->settle();
}

void KeyMaps::check_undo() {
    const int depth = window->state()["depth"];
    ASSERT_NE(depth, 2);
    ASSERT_EQ(window->command("set depth 2"), "");
    ASSERT_TRUE(reaches("depth", 2));
    window->key("ctrl+z");
    EXPECT_TRUE(reaches("depth", depth));
    window->key("ctrl+y");
    EXPECT_TRUE(reaches("depth", 2));
    window->key("ctrl+z");
    EXPECT_TRUE(reaches("depth", depth));
}

// Checks bookmarks. They come after the cameras of the file: main, left, top.
void KeyMaps::check_views(const KeyBinding& binding) {
    if (binding.name == std::string("B")) {
        const int count = window->state()["bookmarks"];
        press(binding);
        EXPECT_TRUE(reaches("bookmarks", count + 1));
        return;
    }
    std::vector<Point> eyes;
    const int count = window->state()["bookmarks"];
    for (int i = 0; i < 4 + count; ++i) {
        press(binding);
        window->settle();
        eyes.push_back(window->state()["eye"]);
    }
    EXPECT_LT(length(minus(eyes[1], {-7, 2.4, 5.5})), 1e-3);
    EXPECT_LT(length(minus(eyes[2], {0, 12, 0.01})), 1e-3);
    EXPECT_EQ(eyes.back(), eyes.front());
}

// Plays and steps a scene that moves; in one that does not, the keys do nothing.
void KeyMaps::check_time(const KeyBinding& binding) {
    press(binding);
    EXPECT_EQ(window->query("timeline")["clips"].size(), 0u);
    // The same scene with a camera that moves: it is traced by the same kernels.
    const fs::path scenes = fs::path(window->folder()) / "scenes", moving = scenes / "primitives.scene";
    if (!fs::exists(scenes)) {
        fs::copy(source_path("scenes"), scenes, fs::copy_options::recursive);
        std::ofstream(moving, std::ios::app) << "\nanimate main translate 0 0 5 11.8  2 3 5 11.8\n";
    }
    ASSERT_EQ(window->command("open " + moving.string()), "");
    window->settle();
    if (binding.name == std::string("Space")) {
        press(binding);
        EXPECT_TRUE(window->query("timeline")["playing"]);
        EXPECT_TRUE(window->reaches([&](const nlohmann::json& state) { return state["eye"][0] > 0; }));
        press(binding);
        EXPECT_FALSE(window->query("timeline")["playing"]);
    } else {
        ASSERT_EQ(window->command("time 0.5"), "");
        press(binding);
        EXPECT_EQ(window->query("timeline")["time_s"], (binding.name == std::string(",") ? 11 : 13) / 24.0);
    }
    ASSERT_EQ(window->command("open " + source_path("scenes/primitives.scene")), "");
    window->settle();
}

void KeyMaps::check_common(const KeyBinding& binding) {
    const std::string key = binding.name;
    if (key == "F") {
        press(binding);
        EXPECT_NE(window->line("fps ", 20), "");
    } else if (key.size() == 1 && std::isdigit(key[0])) {
        const long level = key == "0" ? 0xffffffffL : key[0] - '1';
        press(binding);
        EXPECT_TRUE(reaches("level", level));
        press(binding);
        EXPECT_TRUE(reaches("level", -1));
    } else if (key == "Home") {
        const auto was = window->state();
        window->key(std::string(GetParam()) == "viewer" ? "d" : "Right");
        window->settle();
        ASSERT_NE(window->state()["eye"], was["eye"]);
        press(binding);
        EXPECT_TRUE(reaches("eye", was["eye"]));
    } else if (key == "Esc") {  // tested in robustness_test
        window->key("F1");
        ASSERT_TRUE(reaches("keys_open", true));
        press(binding);
        EXPECT_TRUE(reaches("keys_open", false));
    } else if (key == "F1") {
        press(binding);
        EXPECT_TRUE(reaches("keys_open", true));
        press(binding);
        EXPECT_TRUE(reaches("keys_open", false));
    } else if (key == "F2") {
        const double width = window->state()["area"][2];
        press(binding);
        EXPECT_TRUE(reaches("panel_visible", false));
        EXPECT_GT(double(window->state()["area"][2]), width + 50);
        press(binding);
        EXPECT_TRUE(reaches("panel_visible", true));
    } else if (key == "Ctrl+Z" || key == "Ctrl+Y") {
        check_undo();
    } else if (key == "Ctrl+O") {
        press(binding);
        EXPECT_TRUE(reaches("browser_open", true));
        window->key("Escape");
        EXPECT_TRUE(reaches("browser_open", false));
    } else if (key == "Ctrl+S") {
        check_saving(binding);
    } else if (key == "Ctrl+E") {
        check_saved_scene(binding);
    } else if (key == "M") {
        press(binding);
        EXPECT_TRUE(reaches("move_handles", true));
        press(binding);
        EXPECT_TRUE(reaches("move_handles", false));
    } else if (key == "C" || key == "X") {
        check_sides(binding);
    } else if (key == "R") {
        check_inspector(binding);
    } else if (key == "L") {
        EXPECT_TRUE(window->query("layout")["handles"].empty());
        press(binding);
        EXPECT_TRUE(reaches("show_lights", true));
        EXPECT_EQ(window->query("layout")["handles"].size(), 2u);
        press(binding);
        EXPECT_TRUE(reaches("show_lights", false));
    } else if (key == "V") {
        const auto traced = [this] { return std::string(window->query("command_line a.png")["command"]); };
        ASSERT_EQ(window->command("part .25,.25,.5,.5"), "");
        EXPECT_NE(traced().find("--crop"), std::string::npos);
        press(binding);
        EXPECT_EQ(traced().find("--crop"), std::string::npos);
        window->settle();
    } else if (key == "B" || key == "N") {
        check_views(binding);
    } else if (key == "Space" || key == "," || key == ".") {
        check_time(binding);
    } else if (key == "G") {
        const Point eye = window->state()["eye"];
        press(binding);
        window->settle();
        const Point framed = window->state()["eye"];
        EXPECT_GT(length(minus(framed, eye)), 1e-3);
        window->wheel(window->place_of_pixel(40, 30), -4);
        press(binding);
        window->settle();
        EXPECT_LT(length(minus(Point(window->state()["eye"]), framed)),
                  1e-3);  // the result does not depend on how far away the eye was
    } else {
        ADD_FAILURE() << "no test for what this key does";
    }
}

void KeyMaps::check(const KeyMap& map, const KeyBinding& binding) {
    binding.motion != Motion::none ? check_motion(map, binding) : check_common(binding);
}

TEST_P(KeyMaps, EveryKeyDoesWhatItsHelpSays) {
    window = open_scene(source_path("scenes/primitives.scene"), "96x72");
    ASSERT_EQ(window->command("map " + GetParam()), "");
    const KeyMap* map = find_key_map(GetParam());
    ASSERT_NE(map, nullptr);
    for (const KeyBinding& binding : map->bindings) {
        SCOPED_TRACE(std::string(binding.name) + ": " + binding.help);
        check(*map, binding);
        EXPECT_EQ(window->state()["message"], "");
        if (HasFatalFailure()) return;
        window->key("Home");
    }
}

INSTANTIATE_TEST_SUITE_P(All, KeyMaps, ::testing::Values("thesis", "viewer"), [](const auto& info) { return info.param; });

TEST(KeyMapNames, EveryMapIsTested) {
    EXPECT_EQ(key_maps().size(), 2u) << "name the new one above";
}

}  // namespace
}  // namespace clarity::ui
