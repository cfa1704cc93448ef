// Tests of the window's parts which need no screen.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "base/text.hpp"
#include "ui/app/preferences.hpp"
#include "ui/session/camera_control.hpp"
#include "ui/threads/frame_thread.hpp"
#include "ui/widgets/fonts.hpp"
#include "ui/widgets/key_map.hpp"
#include "ui/widgets/rect.hpp"

namespace clarity::ui {
namespace {

namespace fs = std::filesystem;

float distance(const Vec3& a, const Vec3& b) {
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

Camera camera_along_minus_z() {
    Camera camera;
    camera.eye = {0, 1, 5};
    camera.target = {0, 1, 0};
    return camera;
}

TEST(CameraControl, MovesInXAndZAtAnyPitch) {
    Camera camera = camera_along_minus_z();
    turn_camera(camera, 0, -0.7f);
    const Vec3 eye = camera.eye;
    move_camera(camera, {2, 0, 3});
    EXPECT_NEAR(camera.eye[0], eye[0] + 2, 1e-5);
    EXPECT_NEAR(camera.eye[1], eye[1], 1e-5);
    EXPECT_NEAR(camera.eye[2], eye[2] - 3, 1e-5);
}

TEST(CameraControl, TurnsKeepEyeAndDistance) {
    Camera camera = camera_along_minus_z();
    turn_camera(camera, 0.5f, 0.25f);
    EXPECT_EQ(camera.eye, camera_along_minus_z().eye);
    EXPECT_NEAR(distance(camera.eye, camera.target), 5, 1e-4);
    EXPECT_LT(camera.target[0], 0);  // yaw to the left
    EXPECT_GT(camera.target[1], 1);  // pitch upwards
}

TEST(CameraControl, PitchStaysBelowTheVertical) {
    Camera camera = camera_along_minus_z();
    for (int i = 0; i < 200; ++i) turn_camera(camera, 0.01f, 0.2f);
    EXPECT_GT(camera.target[1] - camera.eye[1], 4.9f);
    const CameraAxes axes = camera_axes(camera);
    EXPECT_GT(axes.up[1], 0.01f);
    for (int i = 0; i < 200; ++i) orbit_camera(camera, 0.01f, -0.2f);
    EXPECT_NEAR(distance(camera.eye, camera.target), 5, 1e-3);
    for (const float x : camera.eye) EXPECT_TRUE(std::isfinite(x));
}

TEST(CameraControl, DegenerateCamerasStayFinite) {
    Camera camera;
    camera.eye = camera.target = {1, 2, 3};
    camera.up = {0, 0, 0};
    turn_camera(camera, 1, 1);
    move_camera(camera, {1, 1, 1});
    orbit_camera(camera, 1, 1);
    Camera down = camera_along_minus_z();
    down.target = {0, -4, 5};  // straight along up
    move_camera(down, {1, 0, 1});
    for (const Camera& c : {camera, down})
        for (int i = 0; i < 3; ++i) EXPECT_TRUE(std::isfinite(c.eye[size_t(i)]) && std::isfinite(c.target[size_t(i)]));
}

TEST(CameraControl, UpMayBeZ) {
    Camera camera;
    camera.eye = {0, -5, 1};
    camera.target = {0, 0, 1};
    camera.up = {0, 0, 1};
    move_camera(camera, {1, 2, 3});
    EXPECT_NEAR(camera.eye[0], 1, 1e-5);
    EXPECT_NEAR(camera.eye[1], -2, 1e-5);
    EXPECT_NEAR(camera.eye[2], 3, 1e-5);
}

TEST(CameraControl, DirectionalLightsStayUnitVectors) {
    rt_light light{};
    light.kind = RT_LIGHT_DIRECTIONAL;
    light.position[1] = 1;
    move_light(light, camera_along_minus_z(), {5, 0, 2}, 10);
    const Vec3 direction = {light.position[0], light.position[1], light.position[2]};
    EXPECT_NEAR(distance(direction, {0, 0, 0}), 1, 1e-5);
    EXPECT_GT(direction[0], 0.1f);
    EXPECT_LT(direction[2], -0.05f);
}

TEST(KeyMap, ThesisKeysAreTheDefault) {
    ASSERT_FALSE(key_maps().empty());
    EXPECT_STREQ(key_maps().front().id, "thesis");
    EXPECT_EQ(find_key_map("nothing"), nullptr);
}

TEST(KeyMap, NoKeyHasTwoMeanings) {
    for (const KeyMap& map : key_maps())
        for (size_t i = 0; i < map.bindings.size(); ++i)
            EXPECT_EQ(map.find(map.bindings[i].key, map.bindings[i].ctrl), &map.bindings[i])
                << map.id << " " << map.bindings[i].name;
}

TEST(KeyMap, ReleasedKeysAreNoLongerHeld) {
    const KeyMap& map = key_maps().front();
    HeldKeys held;
    held.press(map.bindings[0].key);
    EXPECT_TRUE(held.any_held(map));
    EXPECT_EQ(held.value(map, map.bindings[0].motion), 1);
    held.release(map.bindings[0].key);
    held.release(map.bindings[0].key);
    EXPECT_FALSE(held.any_held(map));
    held.press(map.bindings[1].key);
    held.clear();
    EXPECT_FALSE(held.any_held(map));
}

TEST(Viewport, LetterBoxKeepsTheAspectInside) {
    for (const float aspect : {0.5f, 1.0f, 1.7f, 4.0f}) {
        const Rect box = letter_box({10, 20, 800, 600}, aspect);
        EXPECT_NEAR(box.width / box.height, aspect, 1e-3);
        EXPECT_GE(box.x, 10);
        EXPECT_GE(box.y, 20);
        EXPECT_LE(box.x + box.width, 810.01f);
        EXPECT_LE(box.y + box.height, 620.01f);
        EXPECT_TRUE(std::abs(box.width - 800) < 1e-2 || std::abs(box.height - 600) < 1e-2);
    }
}

TEST(FrameSettings, AppliesOnlySettingsThatNeedNoPreparation) {
    Settings prepared, desired_now;
    prepared.lanes = 16;
    prepared.aov = "color";
    desired_now.lanes = 4;
    desired_now.aov = "normal";
    desired_now.depth = 9;
    desired_now.width = 77;
    const Settings settings = frame_settings(prepared, desired_now);
    EXPECT_EQ(settings.depth, 9);
    EXPECT_EQ(settings.width, 77);
    EXPECT_EQ(settings.lanes, 16);
    EXPECT_EQ(settings.aov, "color");
}

TEST(Preferences, AreReadBackUnchanged) {
    const fs::path folder = fs::path(::testing::TempDir()) / "clarity_preferences_test";
    fs::create_directories(folder);
    Preferences written;
    written.width = 1000;
    written.key_map = "viewer";
    written.text_scale = 1.5f;
    written.panel_visible = false;
    save_preferences(folder.string(), written);
    const Preferences read = load_preferences(folder.string());
    EXPECT_EQ(read.width, 1000);
    EXPECT_EQ(read.key_map, "viewer");
    EXPECT_EQ(read.text_scale, 1.5f);
    EXPECT_FALSE(read.panel_visible);
    for (const char* damaged : {"{", "[1,2]", R"({"width": "wide"})", R"({"width": -5, "text_scale": 1e9})"}) {
        std::ofstream(folder / "window.json") << damaged;
        const Preferences p = load_preferences(folder.string());
        EXPECT_GE(p.width, 640) << damaged;
        EXPECT_LE(p.text_scale, 2) << damaged;
    }
    fs::remove_all(folder);
}

// Of a damaged file, the readable entries are used and the file itself is kept.
TEST(Preferences, KeepADamagedFileAside) {
    const fs::path folder = fs::path(::testing::TempDir()) / "clarity_damaged_preferences_test";
    fs::remove_all(folder);
    fs::create_directories(folder);
    Bookmark bookmark{"from above", {}};
    bookmark.camera.eye = {1, 2, 3};
    Preferences written;
    written.text_scale = 1.5f;
    written.bookmarked = {"/a.obj", "/b.obj"};
    written.bookmarks = {{"/a.obj", {bookmark, bookmark}}, {"/b.obj", {bookmark}}};
    nlohmann::json json = to_json(written);
    const std::string whole = json.dump();
    json["width"] = "wide";
    json["bookmarks"][0]["views"][1]["camera"]["eye"] = "nowhere";
    std::ofstream(folder / "window.json") << json.dump();
    std::string notice;
    for (const Preferences& p : {load_preferences(folder.string(), &notice), load_preferences(folder.string())}) {
        EXPECT_EQ(p.text_scale, 1.5f);
        EXPECT_EQ(p.width, Preferences{}.width);
        EXPECT_EQ(p.bookmarked, written.bookmarked);
        EXPECT_EQ(p.bookmarks.at("/a.obj").size(), 1u);
        EXPECT_EQ(p.bookmarks.at("/b.obj").size(), 1u);
    }
    EXPECT_NE(notice.find("window.damaged-1.json"), std::string::npos) << notice;
    EXPECT_NE(notice.find("width"), std::string::npos) << notice;
    const auto text_of = [&](const char* name) {
        std::ifstream in(folder / name);
        return std::string(std::istreambuf_iterator<char>(in), {});
    };
    EXPECT_EQ(text_of("window.damaged-1.json"), json.dump());
    // A file cut off, as by a full disk, is kept too: the next save must not destroy it.
    const std::string half = whole.substr(0, whole.size() / 2);
    std::ofstream(folder / "window.json") << half;
    save_preferences(folder.string(), load_preferences(folder.string()));
    EXPECT_EQ(text_of("window.damaged-2.json"), half);
    EXPECT_TRUE(fs::exists(folder / "window.json"));
    EXPECT_FALSE(fs::exists(folder / "window.damaged-3.json"));
    fs::remove_all(folder);
}

TEST(Preferences, AreInTheConfigurationFolder) {
    const fs::path folder = fs::path(::testing::TempDir()) / "clarity_xdg_test";
    setenv("XDG_CONFIG_HOME", folder.c_str(), 1);
    unsetenv("CLARITY_UI_NO_SAVE");
    EXPECT_EQ(preferences_folder(), (folder / "clarity").string());
    setenv("CLARITY_UI_NO_SAVE", "1", 1);
    EXPECT_EQ(preferences_folder(), "");
    unsetenv("CLARITY_UI_NO_SAVE");
    unsetenv("XDG_CONFIG_HOME");
    fs::remove_all(folder);
}

// The window draws with the fonts in the program alone: they have every sign that its sources name, and those of file names.
TEST(Fonts, HaveEverySignOfTheWindow) {
    std::set<unsigned> signs = {'A', '~', 0xe9, 0x3b1, 0x436};
    for (const auto& entry : fs::recursive_directory_iterator(CLARITY_UI_SOURCES)) {
        if (!entry.is_regular_file()) continue;
        std::ifstream in(entry.path());
        const std::string text(std::istreambuf_iterator<char>(in), {});
        for (size_t at = 0; (at = text.find("\\u", at)) != std::string::npos; at += 2)
            signs.insert(static_cast<unsigned>(std::stoul(text.substr(at + 2, 4), nullptr, 16)));
    }
    EXPECT_GT(signs.size(), 12u) << "arrows, folds, dashes";
    ImFontAtlas atlas;
    for (const Face face : {Face::text, Face::bold, Face::mono}) {
        ImFont* const font = add_font(atlas, face, 14);
        ASSERT_NE(font, nullptr);
        ASSERT_TRUE(atlas.Build());
        for (const unsigned sign : signs)
            EXPECT_TRUE(font->FindGlyphNoFallback(static_cast<ImWchar>(sign))) << std::hex << sign << " face " << int(face);
    }
}

TEST(Plurals, OneIsNotMany) {
    EXPECT_EQ(plural(1, "ray"), "1 ray");
    EXPECT_EQ(plural(0, "ray"), "0 rays");
    EXPECT_EQ(plural(2, "ray was", "rays were"), "2 rays were");
    EXPECT_EQ(plural(1, "ray was", "rays were"), "1 ray was");
    EXPECT_EQ(noun(1, "face"), "face");
}

}  // namespace
}  // namespace clarity::ui
