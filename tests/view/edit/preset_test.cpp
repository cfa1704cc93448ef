// Presets as JSON and as command lines.
#include "view/edit/preset.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "plugin/parameters.hpp"
#include "scene/motion/pose.hpp"
#include "support/generated.hpp"
#include "support/scenes.hpp"
#include "support/scratch.hpp"
#include "view/camera_path.hpp"
#include "view/edit/edit.hpp"

namespace clarity::test {
namespace {

const PluginRegistry& plugins() {
    return Workbench::get().plugins();
}

Preset unusual() {
    Preset preset;
    preset.device = "0:0";
    preset.settings = make_settings({{"depth", "7"}, {"packet", "8x2"}, {"lanes", "4"}, {"tone", "aces"}, {"exposure", "0.1"}});
    preset.settings.accel = "spheres";
    preset.settings.accel_params = default_parameters(*plugins().accel("spheres"));
    set_parameter(*plugins().accel("spheres"), preset.settings.accel_params, "max_leaf", "7");
    preset.edits = {{"camera", "0,0,5,0,0,0,45,0,1,0"}, {"light.0", "point,1,2,3,1,1,1"}, {"light.0", "off"}};
    return preset;
}

void expect_same(const Preset& a, const Preset& b) {
    EXPECT_EQ(a.device, b.device);
    EXPECT_EQ(a.settings.accel, b.settings.accel);
    EXPECT_EQ(a.settings.accel_params, b.settings.accel_params);
    for (const Setting& row : settings_table()) EXPECT_EQ(row.get(a.settings), row.get(b.settings)) << row.key;
    ASSERT_EQ(a.edits.size(), b.edits.size());
    for (size_t i = 0; i < a.edits.size(); ++i) {
        EXPECT_EQ(a.edits[i].key, b.edits[i].key);
        EXPECT_EQ(a.edits[i].value, b.edits[i].value);
    }
}

TEST(Preset, IsReadBackFromJson) {
    expect_same(parse_preset(plugins(), preset_json(plugins(), unusual()), "round trip"), unusual());
}

TEST(Preset, MissingKeysHaveDefaults) {
    const Preset preset = parse_preset(plugins(), R"({"clarity_preset": 1})", "short");
    EXPECT_EQ(preset.settings.accel, "bvh8");
    EXPECT_EQ(preset.settings.depth, Settings().depth);
    EXPECT_TRUE(preset.edits.empty());
}

TEST(Preset, RefusesUnknownKeysAndValues) {
    const std::vector<std::pair<std::string, std::string>> wrong = {
        {"", "no preset"},
        {"[]", "no preset"},
        {"{}", "no preset"},
        {R"({"clarity_preset": 2})", "version 2"},
        {R"({"clarity_preset": 1, "scene": "x"})", "`scene`"},
        {R"({"clarity_preset": 1, "settings": {"deepth": "3"}})", "deepth"},
        {R"({"clarity_preset": 1, "settings": {"depth": "300"}})", "depth"},
        {R"({"clarity_preset": 1, "settings": []})", "no object"},
        {R"({"clarity_preset": 1, "accel": {"id": "no_such_tree"}})", "no_such_tree"},
        {R"({"clarity_preset": 1, "accel": {"id": "bvh2", "leaves": "3"}})", "leaves"},
        {R"({"clarity_preset": 1, "edits": [["depth", "3"]]})", "no edit"},
        {R"({"clarity_preset": 1, "edits": [["light.0"]]})", "no edit"},
        {R"({"clarity_preset": 1, "edits": 5})", "no edit"},
        {R"({"clarity_preset": 1, "device": 5})", "no preset"},
        {R"({"clarity_preset": 1, "pose": {"clip": "walk"}})", "no preset"},
        {R"({"clarity_preset": 1, "pose": {"time_s": "now"}})", "no preset"},
    };
    for (const auto& [json, says] : wrong) {
        try {
            parse_preset(plugins(), json, "wrong.json");
            ADD_FAILURE() << json << " was taken";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), Exit::usage);
            EXPECT_EQ(std::string(error.what()).find("wrong.json"), 0u) << error.what();
            EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
        }
    }
}

// The text of a value other than the default.
std::string another_value(const Setting& row) {
    const std::string now = row.get(Settings());
    if (row.kind == Setting::Kind::choice) return now == row.choices.front() ? row.choices.back() : row.choices.front();
    if (row.kind == Setting::Kind::boolean) return now == "true" ? "false" : "true";
    return row.kind == Setting::Kind::size ? "7x5" : exact_text(row.max);
}

// The window compares and copies values without their texts.
TEST(Settings, EqualAndCopyConcernTheirOwnValueOnly) {
    for (const Setting& changed : settings_table()) {
        Settings settings;
        changed.set(settings, another_value(changed));
        for (const Setting& row : settings_table()) {
            EXPECT_EQ(row.equal(settings, Settings()), row.get(settings) == row.get(Settings()))
                << changed.key << " " << row.key;
            Settings copy;
            row.copy(copy, settings);
            EXPECT_EQ(row.get(copy), row.get(settings)) << changed.key << " " << row.key;
            EXPECT_EQ(changed.equal(copy, settings), row.key == changed.key) << changed.key << " " << row.key;
        }
    }
}

// The window also passes settings as text. With 1/512 rounded to six digits, more rays were followed.
TEST(Settings, NumbersWrittenAsTextAreReadBackBitByBit) {
    for (const Setting& row : settings_table()) {
        if (row.kind != Setting::Kind::real) continue;
        for (const double value : {1.0 / 512, 1.0 / 3, 0.1, 1e-300, 0.123456789012345678, row.max}) {
            Settings settings, again;
            row.set(settings, exact_text(value));
            row.set(again, row.get(settings));
            EXPECT_EQ(row.get(again), exact_text(value)) << row.key;
            EXPECT_EQ(number_of(again, "min_weight"), number_of(settings, "min_weight"));
            EXPECT_EQ(again.exposure, settings.exposure);
            EXPECT_EQ(again.scale_max, settings.scale_max);
        }
    }
}

// A time and a clip. At rest there are neither.
TEST(Preset, HoldsThePose) {
    Preset preset = unusual();
    preset.pose.clip = "walk";
    EXPECT_EQ(render_command(plugins(), preset, {"a.scene"}, "out.png").find("walk"), std::string::npos);
    preset.pose.time_s = -1.0 / 3;
    const Preset back = parse_preset(plugins(), preset_json(plugins(), preset), "pose");
    EXPECT_EQ(back.pose.time_s, -1.0 / 3);
    EXPECT_EQ(back.pose.clip, "walk");
    const std::string line = render_command(plugins(), preset, {"a.scene"}, "out.png");
    EXPECT_NE(line.find(" --time=-0.3333333333333333 --clip=walk"), std::string::npos) << line;
}

TEST(RenderCommand, ListsSettingsThatAreNotTheDefault) {
    Preset plain;
    plain.settings.accel_params = default_parameters(*plugins().accel("bvh8"));
    EXPECT_EQ(render_command(plugins(), plain, {"a.scene"}, "out.png"), "clarity render a.scene -o out.png");
    const std::string line = render_command(plugins(), unusual(), {"it's a file.obj", "b.scene"}, "my out.png");
    EXPECT_EQ(line.find("clarity render 'it'\\''s a file.obj' b.scene -o 'my out.png' --device 0:0 --accel spheres,max_leaf=7"),
              0u)
        << line;
    for (const char* part : {" --set depth=7", " --set packet=8x2", " --set lanes=4", " --set tone=aces", " --set exposure=0.1",
                             " --set light.0=point,1,2,3,1,1,1 --set light.0=off"})
        EXPECT_NE(line.find(part), std::string::npos) << line;
    EXPECT_EQ(line.find("shadows"), std::string::npos);
}

// Cameras that move from key to key: as text, and as the text scene that is made of them.

Camera camera(const std::array<float, 3>& eye, const std::array<float, 3>& target, float fov_deg = 45,
              const std::array<float, 3>& up = {0, 1, 0}) {
    Camera camera;
    camera.eye = eye;
    camera.target = target;
    camera.up = up;
    camera.fov_y_rad = fov_deg * 3.14159265f / 180;
    return camera;
}

CameraPath three_keys() {
    CameraPath path;
    path.set(2, camera({4, 1, 0}, {0, 1, 0}, 30));
    path.set(0, camera({0, 1, 4}, {0, 1, 0}));
    path.set(3.5, camera({0, 5, 0.5f}, {0, 0, 0}, 60, {0, 0, -1}));
    return path;
}

std::array<double, 3> forward(const Camera& c) {
    std::array<double, 3> w{};
    double size = 0;
    for (int k = 0; k < 3; ++k) {
        w[k] = double(c.target[k]) - c.eye[k];
        size += w[k] * w[k];
    }
    for (double& x : w) x /= std::sqrt(size);
    return w;
}

TEST(CameraPath, KeysAreKeptByTime) {
    CameraPath path = three_keys();
    ASSERT_EQ(path.keys.size(), 3u);
    EXPECT_EQ(path.keys[1].time_s, 2);
    EXPECT_EQ(path.key_at(3.5), 2);
    EXPECT_EQ(path.key_at(1), -1);
    path.set(2, camera({9, 9, 9}, {0, 0, 0}));
    EXPECT_EQ(path.keys.size(), 3u);
    EXPECT_EQ(path.at(2).eye, (std::array<float, 3>{9, 9, 9}));
}

TEST(CameraPath, GoesEvenlyFromKeyToKeyAndRestsOutside) {
    const CameraPath path = three_keys();
    EXPECT_EQ(path.at(-1).eye, path.keys[0].camera.eye);
    EXPECT_EQ(path.at(9).target, path.keys[2].camera.target);
    const Camera half = path.at(1);
    EXPECT_NEAR(half.eye[0], 2, 1e-5);
    EXPECT_NEAR(half.eye[2], 2, 1e-5);
    EXPECT_NEAR(half.fov_y_rad, 37.5 * 3.14159265 / 180, 1e-5);
    // From looking along -z to looking along -x: half way between them.
    EXPECT_NEAR(forward(half)[0], -std::sqrt(0.5), 1e-5);
    EXPECT_NEAR(forward(half)[2], -std::sqrt(0.5), 1e-5);
}

TEST(CameraPath, IsReadBackFromItsText) {
    const CameraPath path = three_keys();
    EXPECT_TRUE(read_path(path_text(path)) == path) << path_text(path);
    EXPECT_TRUE(read_path("").empty());
    for (const char* wrong :
         {"0", "0:1,2,3", "x:0,0,5,0,0,0,45,0,1,0", "1:0,0,5,0,0,0,45,0,1,0;1:0,0,5,0,0,0,45,0,1,0", "0:0,0,5,0,0,0,200,0,1,0"})
        EXPECT_THROW(read_path(wrong), Error) << wrong;
}

// The text scene's `animate` shows the same camera at all times.
TEST(CameraPath, ATextSceneMovesItsCameraAlike) {
    const Scratch scratch;
    const CameraPath path = three_keys();
    const ScenePtr scene = load_scene(scratch.write("path.scene", animate_lines(path, "flight") + "sphere\n"));
    for (double time = -0.5; time < 4.5; time += 0.125) {
        const Camera ours = path.at(time), theirs = evaluate(*scene, {}, time).cameras.at(0);
        EXPECT_NEAR(ours.fov_y_rad, theirs.fov_y_rad, 1e-5) << time;
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(ours.eye[k], theirs.eye[k], 1e-5) << time;
            EXPECT_NEAR(forward(ours)[k], forward(theirs)[k], 1e-5) << time;
        }
        // The upright axis of the picture.
        Camera a = ours, b = theirs;
        double along = 0, size_a = 0, size_b = 0;
        const auto wa = forward(a), wb = forward(b);
        double da = 0, db = 0;
        for (int k = 0; k < 3; ++k) {
            da += a.up[k] * wa[k];
            db += b.up[k] * wb[k];
        }
        for (int k = 0; k < 3; ++k) {
            const double x = a.up[k] - da * wa[k], y = b.up[k] - db * wb[k];
            along += x * y;
            size_a += x * x;
            size_b += y * y;
        }
        EXPECT_NEAR(along / std::sqrt(size_a * size_b), 1, 1e-5) << time;
    }
    EXPECT_EQ(animate_lines({}, "flight"), "");
}

// Presets and command lines carry it. A camera that is set after the path has left it.
TEST(CameraPath, IsAnEdit) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    EditedView edited;
    edited.view = make_view(*scene, 1);
    const View base = edited.view;
    apply_edit(*scene, edited, "camera_path", path_text(three_keys()));
    EXPECT_TRUE(edited.follows_path);
    EditedView from;
    from.view = base;
    std::vector<Word> words = edits_between(*scene, from, edited);
    ASSERT_EQ(words.size(), 1u);
    EXPECT_EQ(words[0].key, "camera_path");
    apply_edit(*scene, edited, "camera", "0,0,5,0,0,0,45,0,1,0");
    EXPECT_FALSE(edited.follows_path);
    words = edits_between(*scene, from, edited);
    ASSERT_EQ(words.size(), 2u);
    EXPECT_EQ(words[1].key, "camera");
    EXPECT_TRUE(is_edit("camera_path"));
}

}  // namespace
}  // namespace clarity::test
