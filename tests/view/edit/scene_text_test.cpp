// Scenes that are saved with their edits: loading the saved file gives the same picture.
#include "view/edit/edit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>

#include "base/error.hpp"
#include "import/import.hpp"
#include "scene/light_kinds.hpp"
#include "scene/sky_kinds.hpp"
#include "support/scratch.hpp"
#include "support/workbench.hpp"

namespace clarity::test {
namespace {

// A mesh that three nodes place, one below another, and a camera.
const char* const kGltf = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,2]}],
"nodes":[{"name":"left","mesh":0,"translation":[-1.5,0,0],"children":[1]},
 {"name":"above","mesh":0,"translation":[0,1.2,0],"rotation":[0,0.3826834,0,0.9238795]},
 {"name":"right","mesh":0,"translation":[1,0,0],"scale":[1.5,1.5,1.5]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],
"materials":[{"name":"clay","pbrMetallicRoughness":{"baseColorFactor":[0.8,0.4,0.2,1],"metallicFactor":0}}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},
 {"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],
"buffers":[{"byteLength":72,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAACAAEAAAABAAMAAAADAAIAAQACAAMA"}]})";

const char* const kObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
const char* const kScene =
    "# by hand\n"
    "camera main eye 0 1.5 6 target 0 .5 0 fov 40\n"
    "light point position 3 5 4 color .9 .8 .7 name lamp\n"
    "light directional direction -1 -2 -1 color .3 .3 .4\n"
    "background .1 .2 .4\n"
    "material red color .8 .2 .1\n"
    "load part.obj translate -1 0 0 material red\n"
    "load part.obj translate 1 0 0 scale 1.5\n"
    "sphere center 0 1.6 0 radius .4\n"
    "plane offset -.2\n";

class SceneTextTest : public ::testing::Test {
 protected:
    SceneTextTest() {
        scratch.write("part.obj", kObj);
        settings.accel = "bvh2";
    }
    Scene load(const std::vector<std::string>& files, const std::vector<PictureFile>& pictures = {}) {
        import::ImportOptions options;
        options.pictures = pictures;
        options.in_process = true;
        options.log_warnings = false;
        Progress progress;
        return import::import_scene(Workbench::get().plugins(), files, options, progress);
    }
    // As `clarity render` sees it.
    EditedView first(const Scene& scene) {
        EditedView edited;
        edited.view = make_view(scene, 4.0f / 3.0f);
        apply_scene_edits(scene, edited);
        return edited;
    }
    ByteImage picture(const Scene& scene, const EditedView& edited) {
        const auto shown = std::make_shared<const Scene>(edited_scene(scene, edited));
        return Workbench::get().display(shown, settings, visible_view(edited));
    }
    void edit(const Scene& scene, EditedView& edited, const std::vector<Word>& words) {
        for (const Word& word : words) apply_edit(scene, edited, word.key, word.value);
    }
    // The saved file shows what is shown now. Returns how it reads.
    std::string expect_saved(const Scene& scene, const std::vector<std::string>& files, const EditedView& edited,
                             const std::string& name) {
        const std::string path = scratch.path(name);
        save_scene({scene, files, edited}, path);
        const Scene again = load({path});
        const ByteImage wanted = picture(scene, edited), got = picture(again, first(again));
        EXPECT_EQ(got.pixels.size(), wanted.pixels.size());
        int worst = 0;
        for (size_t i = 0; i < std::min(got.pixels.size(), wanted.pixels.size()); ++i)
            worst = std::max(worst, std::abs(int(got.pixels[i]) - int(wanted.pixels[i])));
        EXPECT_LE(worst, 1) << scratch.read(name);
        return scratch.read(name);
    }
    Scratch scratch;
    Settings settings = make_settings({{"size", "64x48"}, {"spp", "1"}});
};

TEST_F(SceneTextTest, ATextSceneKeepsItsTextAndGetsTheEdits) {
    const std::string path = scratch.write("hand.scene", kScene);
    const Scene scene = load({path});
    EditedView edited = first(scene);
    const ByteImage before = picture(scene, edited);
    edit(scene, edited,
         {{"camera", "0.5,1.2,5,0,0.4,0,45,0,1,0"},
          {"background", "0.3,0.1,0.1"},
          {"light.0", "point,-3,4,5,1,0.5,0.25"},
          {"light.1", "off"},
          {"light.2", "directional,0,-1,0,0.2,0.2,0.2"},
          {"material.1.color", "0.1,0.7,0.2"},
          {"instance.1.translate", "0.25,0.5,-0.125"},
          {"instance.1.rotate", "10,20,30"},
          {"instance.1.scale", "0.5"}});
    EXPECT_FALSE(picture(scene, edited).pixels == before.pixels);
    // Beside it, it is loaded; its lights are edited there.
    const std::string beside = expect_saved(scene, {path}, edited, "beside.scene");
    EXPECT_NE(beside.find("load \"hand.scene\""), std::string::npos) << beside;
    EXPECT_NE(beside.find("edit instance 1  translate 0.25 0.5 -0.125  rotate 10 20 30  scale 0.5 0.5 0.5"), std::string::npos)
        << beside;
    // In its own place its text stays.
    const std::string own = expect_saved(scene, {path}, edited, "hand.scene");
    EXPECT_NE(own.find("# by hand\n"), std::string::npos) << own;
    EXPECT_NE(own.find("load part.obj translate -1 0 0 material red\n"), std::string::npos) << own;
    EXPECT_EQ(own.find("background .1"), std::string::npos) << own;

    // Once more: edits are replaced and taken back, not piled up.
    const Scene saved = load({path});
    EditedView again = first(saved);
    EXPECT_TRUE(again.instances == edited.instances);
    edit(saved, again, {{"instance.1.translate", "0,0,0"}, {"hide", "0"}});
    const std::string nested = expect_saved(saved, {path}, again, "nested.scene");
    EXPECT_NE(nested.find("edit instance 1  translate 0 0 0\n"), std::string::npos) << nested;
    const std::string twice = expect_saved(saved, {path}, again, "hand.scene");
    EXPECT_EQ(twice.find("translate 0.25"), std::string::npos) << twice;
    EXPECT_NE(twice.find("edit instance 0  hidden 1\n"), std::string::npos) << twice;
    EXPECT_EQ(twice.find("camera saved_view"), twice.rfind("camera saved_view")) << twice;
}

TEST_F(SceneTextTest, TexturesOfMaterialsAreSaved) {
    const std::string red = scratch.write("red.ppm", std::string("P6 1 1 255\n") + "\xff\x10\x10"),
                      blue = scratch.write("blue sky.ppm", std::string("P6 1 1 255\n") + "\x10\x10\xff");
    const std::string path = scratch.write("pictures.scene",
                                           "camera main eye 0 0 5 fov 40\nlight directional direction 0 0 -1\n"
                                           "texture wood \"red.ppm\" scale 2\n"
                                           "material a model lambert color_map wood\nmaterial b model lambert color 1\n"
                                           "polygon vertices -2 -1 0  0 -1 0  0 1 0  -2 1 0 material a\n"
                                           "polygon vertices 0 -1 0  2 -1 0  2 1 0  0 1 0 material b\n");
    const std::vector<Word> words = {{"material.1.color_map", blue}, {"material.2.color_map", "wood"}};
    EXPECT_EQ(pictures_of(words), (std::vector<PictureFile>{{blue, RT_SPACE_SRGB}}));
    EXPECT_EQ(pictures_of({{"material.1.normal_map", blue}, {"material.1.color", "1"}, {"hide", blue}}),
              (std::vector<PictureFile>{{blue, RT_SPACE_LINEAR}}));
    const Scene scene = load({path}, pictures_of(words));
    EditedView edited = first(scene);
    const ByteImage before = picture(scene, edited);
    edit(scene, edited, words);
    const ByteImage swapped = picture(scene, edited);
    EXPECT_FALSE(swapped.pixels == before.pixels);
    const std::string beside = expect_saved(scene, {path}, edited, "beside.scene");
    EXPECT_NE(beside.find("texture picture_1 \"blue sky.ppm\"\n"), std::string::npos) << beside;
    EXPECT_NE(beside.find("edit material 2  color_map \"wood\""), std::string::npos) << beside;
    expect_saved(scene, {path}, edited, "pictures.scene");

    // Once more, with another picture, and taken back.
    const std::vector<Word> others = {{"material.1.color_map", red}, {"material.2.color_map", "none"}};
    const Scene saved = load({path}, pictures_of(others));
    EditedView again = first(saved);
    EXPECT_EQ(again.maps.given.size(), 2u);
    edit(saved, again, others);
    const std::string twice = expect_saved(saved, {path}, again, "pictures.scene");
    EXPECT_NE(twice.find("texture picture_2 \"red.ppm\"\n"), std::string::npos) << twice;
    EXPECT_EQ(twice.find("edit material 2"), std::string::npos) << twice;
    expect_saved(saved, {path}, again, "nested.scene");
}

// Two textures of a file have the same name if they differ in how they are wrapped: the second one is known by its number.
TEST_F(SceneTextTest, TexturesWithoutANameOfTheirOwnAreSaved) {
    scratch.write("red.ppm", std::string("P6 1 1 255\n") + "\xff\x10\x10");
    const std::string path = scratch.write("twice.scene",
                                           "camera main eye 0 0 5 fov 40\nlight directional direction 0 0 -1\n"
                                           "material a texture red.ppm\nmaterial b texture red.ppm wrap clamp\nmaterial c\n"
                                           "sphere radius 1 material c\n");
    const Scene scene = load({path});
    ASSERT_EQ(scene.textures.size(), 2u);
    for (const char* name : {"beside.scene", "twice.scene"})
        for (const rt_u32 texture : {0u, 1u}) {
            EditedView edited = first(scene);
            edited.maps.give(scene, 3, RT_MAP_COLOR, texture);
            const std::string text = expect_saved(scene, {path}, edited, name);
            const Scene again = load({scratch.path(name)});
            EXPECT_TRUE(first(again).maps == edited.maps) << text;
        }
}

TEST_F(SceneTextTest, LightsAndModelsOfAllKindsAreSaved) {
    const std::string path = scratch.write("hand.scene", kScene);
    const Scene scene = load({path});
    EditedView edited = first(scene);
    std::vector<Word> words = {
        {"material.1.model", "conductor"}, {"material.1.roughness", "0.3"}, {"camera.aperture", "0.125"}};
    size_t next = edited.view.lights.size();
    for (const LightKind& kind : light_kinds()) words.push_back({"light." + std::to_string(next++), kind.name});
    words.push_back({"light." + std::to_string(next - 3) + ".two_sided", "true"});
    words.push_back({"light." + std::to_string(next - 5) + ".falloff", "square"});
    edit(scene, edited, words);
    const std::string text = expect_saved(scene, {path}, edited, "hand.scene");
    const EditedView again = first(load({path}));
    ASSERT_EQ(again.view.lights.size(), edited.view.lights.size()) << text;
    for (size_t i = 0; i < again.view.lights.size(); ++i)
        EXPECT_EQ(std::memcmp(&again.view.lights[i], &edited.view.lights[i], sizeof(rt_light)), 0) << i << "\n" << text;
    EXPECT_EQ(std::memcmp(&again.view.materials[1], &edited.view.materials[1], sizeof(rt_material)), 0) << text;
    EXPECT_EQ(again.view.camera.aperture, 0.125f);
}

TEST_F(SceneTextTest, TheSkyIsSavedWhereverItComesFrom) {
    scratch.write("sky.pfm", "PF\n2 1\n-1.0\n" + std::string(24, '\0'));
    const std::string rest = std::string(kScene) + "sky gradient zenith 1 2 3 ground .5 strength 2\n";
    const std::string gradient = scratch.write("hand.scene", rest), plain = scratch.write("plain.scene", kScene),
                      picture = scratch.write("picture.scene", std::string(kScene) + "sky sky.pfm rotate 20\n");
    const std::vector<Word> strength = {{"sky.strength", "0.25"}, {"sky.visible", "false"}};
    const std::vector<Word> other = {{"sky", "constant"}, {"sky.color", "0.1,0.2,0.3"}}, none = {{"sky", "background"}};
    for (const auto& [path, words] : std::vector<std::pair<std::string, std::vector<Word>>>{
             {gradient, strength}, {gradient, other}, {gradient, none}, {plain, other}, {picture, {{"sky.rotate", "-30"}}}}) {
        const Scene scene = load({path});
        EditedView edited = first(scene);
        edit(scene, edited, words);
        ASSERT_FALSE(same_sky(sky_of(scene, edited.view), scene.sky.values)) << path;
        const std::string text = scratch.read(std::filesystem::path(path).filename().string());
        for (const std::string& name : {std::string("beside.scene"), std::filesystem::path(path).filename().string()}) {
            save_scene({scene, {path}, edited}, scratch.path(name));
            const Scene again = load({scratch.path(name)});
            EXPECT_TRUE(same_sky(sky_of(again, first(again).view), sky_of(scene, edited.view))) << scratch.read(name);
            EXPECT_TRUE(same_sky(with_scene_edits(again).sky.values, sky_of(scene, edited.view))) << scratch.read(name);
        }
        scratch.write(std::filesystem::path(path).filename().string(), text);
    }
}

TEST_F(SceneTextTest, NodesOfALoadedFileAreMovedAndHidden) {
    const std::string path = scratch.write("nodes.gltf", kGltf);
    const Scene scene = load({path});
    ASSERT_EQ(scene.instances.size(), 3u);
    EditedView edited = first(scene);
    edit(scene, edited,
         {{"instance.1.translate", "0.5,0.25,0"},
          {"instance.1.rotate", "0,0,45"},
          {"instance.2.scale", "1,2,1"},
          {"hide", "0"},
          {"material.1.color", "0.2,0.3,0.9"},
          {"material.1.reflect", "0.25"}});
    expect_saved(scene, {path}, edited, "nodes.scene");
    // Two files: the numbers run on.
    const std::string hand = scratch.write("hand.scene", kScene);
    const Scene both = load({hand, path});
    ASSERT_EQ(both.instances.size(), 5u);
    EditedView view = first(both);
    edit(both, view, {{"instance.0.translate", "0,0,1"}, {"instance.4.translate", "0,1,0"}, {"hide", "2"}});
    expect_saved(both, {hand, path}, view, "both.scene");
}

TEST_F(SceneTextTest, AFileIsWrittenWholeOrNotAtAll) {
    const std::string path = scratch.write("hand.scene", kScene);
    const Scene scene = load({path});
    const EditedView edited = first(scene);
    EXPECT_THROW(save_scene({scene, {path}, edited}, scratch.path("missing/out.scene")), Error);
    EXPECT_FALSE(std::filesystem::exists(scratch.path("missing")));
    EXPECT_THROW(save_scene({scene, {path}, edited}, scratch.path("out.obj")), Error);
    EXPECT_FALSE(std::filesystem::exists(scratch.path("out.obj")));
    EXPECT_EQ(scratch.read("hand.scene"), kScene);
    EXPECT_EQ(folders_outside({path, "/elsewhere/a.obj"}, scratch.path("out.scene")), (std::vector<std::string>{"/elsewhere"}));
}

TEST_F(SceneTextTest, WrongEditsAreRefusedWithTheirPlace) {
    const auto why = [&](const std::string& line) -> std::string {
        const std::string path = scratch.write("wrong.scene", "load part.obj\n" + line + "\n");
        try {
            const Scene scene = load({path});
            scene_edits(scene, {});
        } catch (const Error& e) {
            return e.what();
        }
        return {};
    };
    EXPECT_EQ(why("edit instance 0 translate 1 2 3"), "");
    for (const auto& [line, expected] : std::vector<std::pair<std::string, std::string>>{
             {"edit instance 1 translate 1 2 3", "wrong.scene:2:1: `instance.1.translate`: there are 1 instances"},
             {"edit material 3 color 1", "there are 1 materials"},
             {"edit material 0 color_map wood", "wrong.scene:2:1: material.0.color_map"},
             {"edit light 3 off", "wrong.scene:2:1: light.3"},
             {"edit instance 0 radius 3", "wrong.scene:2:17: unknown key `radius`"},
             {"edit instance 0.5 hidden 1", "whole number"},
             {"edit instance 0 hidden yes", "`yes` is no value of `hidden`"},
             {"edit sphere 0", "`sphere` is no object to edit"}})
        EXPECT_NE(why(line).find(expected), std::string::npos) << line << ": " << why(line);
}

}  // namespace
}  // namespace clarity::test
