// import_digest_test.cpp -- the digest of a scene tells pictures apart, and nothing else.
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <new>

#include "import/wire.hpp"
#include "support/scenes.hpp"
#include "support/scratch.hpp"

using namespace clarity;
using namespace clarity::test;
using import::scene_digest;

namespace {

constexpr const char* kText =
    "camera main eye 0 1 6 target 0 1 0 fov 40\n"
    "light point position 3 6 4\n"
    "material mirror color .2 .2 .2 reflect .8\n"
    "sphere center 0 1 0 radius 1 material mirror\n"
    "load cube.obj name car\n"
    "animate car translate 0 0 0 0  2 1 0 0\n";

// The scene as a user has it in some folder.
Scene scene_of(const Scratch& folder, const std::string& below = "") {
    folder.write(below + "cube.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    return *load_scene(folder.write(below + "a.scene", kText));
}

}  // namespace

TEST(SceneDigest, IsThatOfTheSameFilesElsewhere) {
    const Scratch here, there;
    const std::string first = scene_digest(scene_of(here));
    EXPECT_EQ(first.size(), 32u);
    EXPECT_EQ(scene_digest(scene_of(there, "a longer name/")), first);
}

// Bytes that no member of a struct owns must not count: malloc() fills its memory with other values each time.
TEST(SceneDigest, HasNoPadding) {
    const Scratch folder;
    std::vector<std::string> digests;
    for (const char* fill : {"1", "85", "170"}) {
        Environment environment;
        environment.set("MALLOC_PERTURB_", fill);  // of the import worker, which starts anew
        digests.push_back(scene_digest(scene_of(folder)));
    }
    EXPECT_EQ(digests[1], digests[0]);
    EXPECT_EQ(digests[2], digests[0]);
}

TEST(SceneDigest, ChangesWithAllThatIsSeen) {
    const Scratch folder;
    const Scene scene = scene_of(folder);
    const std::string digest = scene_digest(scene);
    ASSERT_FALSE(scene.motion.channels.empty());
    const std::vector<std::pair<const char*, std::function<void(Scene&)>>> changes = {
        {"a vertex", [](Scene& s) { s.positions.own()[0] += 1e-6f; }},
        {"a triangle", [](Scene& s) { std::swap(s.triangles.own()[0], s.triangles.own()[1]); }},
        {"a sphere", [](Scene& s) { s.spheres[0].radius *= 2; }},
        {"a material", [](Scene& s) { s.materials.back().values.reflect = 0.5f; }},
        {"a light", [](Scene& s) { s.lights[0].values.color[2] = 0; }},
        {"a camera", [](Scene& s) { s.cameras[0].eye[1] = 3; }},
        {"a camera's name", [](Scene& s) { s.cameras[0].name = "niam"; }},
        {"an instance", [](Scene& s) { s.instances[0].world_from_object[3] = 1; }},
        {"the background", [](Scene& s) { s.background[0] = 1; }},
        {"the sky", [](Scene& s) { s.sky.values.kind = RT_SKY_CONSTANT; }},
        {"a texel of the sky", [](Scene& s) { s.sky.texels = {1, 2, 3}; }},
        {"a key", [](Scene& s) { s.motion.key_values.own().back() += 1; }},
        {"a clip's name", [](Scene& s) { s.motion.clips[0].name = "walk"; }},
        {"an edit", [](Scene& s) { s.edits.push_back({"light.0", "off", "a.scene:1:1"}); }}};
    for (const auto& [what, change] : changes) {
        Scene changed = scene;
        change(changed);
        EXPECT_NE(scene_digest(changed), digest) << what;
    }
}

TEST(SceneDigest, LeavesOutWhatIsNotSeen) {
    const Scratch folder;
    const Scene scene = scene_of(folder);
    Scene changed = scene;
    for (Material& material : changed.materials) material.name += " copy";
    for (Mesh& mesh : changed.meshes) mesh.name = "/another/folder/mesh";
    for (Instance& instance : changed.instances) instance.name.clear();
    changed.warnings.push_back("a.scene:3:1: a warning");
    changed.sky.file = "/another/folder/sky.hdr";
    changed.sources = {"/another/folder/a.scene"};
    EXPECT_EQ(scene_digest(changed), scene_digest(scene));
}
