// catalog_test.cpp -- finding scenes, the messages for missing ones, and the cases of each suite.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "base/error.hpp"
#include "stand/ray_sets.hpp"
#include "support/scenes.hpp"
#include "tools/bench/run/bench.hpp"
#include "tools/bench/scenes/zoo_scenes.hpp"

namespace {

using namespace clarity;
using namespace clarity::bench;
using namespace clarity::import;
using namespace clarity::test;
namespace fs = std::filesystem;

class Catalog : public testing::Test {
 protected:
    Catalog() : folder_(fs::temp_directory_path() / ("clarity-catalog-" + std::to_string(getpid()))) {
        fs::create_directories(folder_ / "bench");
    }
    ~Catalog() override { fs::remove_all(folder_); }

    void write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name, std::ios::binary) << text;
    }
    SceneCatalog shared() const { return SceneCatalog(source_file("scenes"), folder_.string()); }

    const fs::path folder_;
};

const SceneCatalog& project() {
    static const SceneCatalog catalog(source_file("scenes"), "");
    return catalog;
}

Suite suite_of(const std::vector<std::string>& suites, const std::vector<std::string>& files = {},
               const std::vector<std::string>& accels = {}) {
    BenchRequest request;
    request.suites = suites;
    request.files = files;
    request.accels = accels;
    return make_suite(request, project(), Workbench::get().plugins());
}

TEST_F(Catalog, ListsTheSixScenesOfTheThesis) {
    const auto scenes = project().thesis();
    ASSERT_EQ(scenes.size(), 6u);
    for (const BenchScene& scene : scenes) {
        EXPECT_EQ(scene.missing, "") << scene.name;
        ASSERT_EQ(scene.files.size(), 1u);
        EXPECT_TRUE(fs::exists(scene.files[0]));
    }
}

TEST_F(Catalog, MissingScenesNameTheirPath) {
    const BenchScene scene = project().project("thesis/7_nothing");
    EXPECT_NE(scene.missing.find("thesis/7_nothing"), std::string::npos) << scene.missing;
    EXPECT_NE(scene.missing.find("CLARITY_SCENES"), std::string::npos) << scene.missing;
    const auto none = project().shared();
    ASSERT_EQ(none.size(), 1u);
    EXPECT_NE(none[0].missing.find("CLARITY_SHARED"), std::string::npos) << none[0].missing;
}

TEST_F(Catalog, ReadsCamerasAndModelsOfTheSharedFolder) {
    write("one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write("two.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write("bench/cameras.json",
          "{\"scenes\": {\"pair\": {\"file\": \"one.obj + two.obj (gunzip; then some)\", \"position\": [0, 0.5, 2.75],"
          "\"look_at\": [0, 0, -1], \"vfov_deg\": 45, \"light\": [1, 2, 3]},"
          "\"gone\": {\"file\": \"gone.ply.gz\", \"position\": [1, 1, 1], \"look_at\": [0, 0, 0], \"vfov_deg\": 30,"
          "\"light\": [0, 0, 0]}}}");
    const auto scenes = shared().shared();
    ASSERT_EQ(scenes.size(), 2u);
    const BenchScene& pair = scenes[0].name == "pair" ? scenes[0] : scenes[1];
    const BenchScene& gone = scenes[0].name == "pair" ? scenes[1] : scenes[0];
    EXPECT_EQ(pair.files.size(), 2u);
    EXPECT_EQ(pair.camera, "0,0.5,2.75,0,0,-1,45");
    EXPECT_EQ(pair.light, "1,2,3");
    EXPECT_NE(gone.missing.find("gone.ply.gz is not there"), std::string::npos) << gone.missing;

    Progress progress;
    const LoadedScene loaded = load_scene(Workbench::get().plugins(), pair, 1, ImportOptions{}, progress);
    EXPECT_EQ(loaded.scene->placed_triangle_count(), 2u);
    EXPECT_FLOAT_EQ(loaded.view.camera.eye[2], 2.75f);
    EXPECT_FLOAT_EQ(loaded.view.lights[0].position[1], 2);
}

TEST_F(Catalog, ABrokenCameraFileGivesOneNote) {
    for (const char* text : {"", "[]", "{\"scenes\": {\"a\": {}}}", "{\"scenes\": {\"a\": {\"file\": 7}}}", "{\"scenes\":"}) {
        write("bench/cameras.json", text);
        const auto scenes = shared().shared();
        ASSERT_EQ(scenes.size(), 1u) << text;
        EXPECT_NE(scenes[0].missing.find("cameras.json"), std::string::npos) << scenes[0].missing;
    }
}

TEST_F(Catalog, CompressedModelsAreLoaded) {
    write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    if (std::system(("gzip -k '" + (folder_ / "a.obj").string() + "'").c_str()) != 0) GTEST_SKIP() << "SKIPPED: no gzip";
    const BenchScene scene = scene_of_file((folder_ / "a.obj.gz").string());
    EXPECT_EQ(scene.name, "a");
    Progress progress;
    EXPECT_EQ(load_scene(Workbench::get().plugins(), scene, 1, ImportOptions{}, progress).scene->triangle_count(), 1u);
    write("broken.obj.gz", "no gzip at all");
    const BenchScene broken = scene_of_file((folder_ / "broken.obj.gz").string());
    EXPECT_THROW(load_scene(Workbench::get().plugins(), broken, 1, ImportOptions{}, progress), Error);
}

// Scenes that are computed have no file that an importer would check.
TEST(Zoo, ScenesAreSoundAndOfAboutTheirSize) {
    for (const char* name : {"stadium", "hair", "city", "height field", "soup"})
        for (const uint64_t triangles : {2'000u, 20'000u}) {
            Scene scene, again;
            add_zoo_scene(name, triangles, scene);
            add_zoo_scene(name, triangles, again);
            const std::string what = std::string(name) + ", " + std::to_string(triangles);
            EXPECT_EQ(validate(scene), Problem()) << what;
            EXPECT_GT(scene.triangle_count(), triangles / 2) << what;
            EXPECT_LT(scene.triangle_count(), 2 * triangles) << what;
            EXPECT_FALSE(scene.bounds().empty) << what;
            EXPECT_TRUE(
                std::equal(scene.positions.begin(), scene.positions.end(), again.positions.begin(), again.positions.end()))
                << what << ": the same each time";
        }
    Scene none;
    EXPECT_THROW(add_zoo_scene("none", 1, none), std::out_of_range);
}

// Each mesh is on its shape, as closely as it says: errors fall by the square of the number of parts.
TEST(Shapes, MeshesComeNearerTheMorePartsTheyHave) {
    for (const MeshedShape& kind : meshed_shapes()) {
        double before = 0;
        for (const unsigned parts : {16u, 64u}) {
            Scene scene;
            const double error = add_shape_mesh(kind.name, parts, scene);
            EXPECT_EQ(validate(scene), Problem()) << kind.name;
            if (before > 0) {
                EXPECT_GT(before, 10 * error) << kind.name;
                EXPECT_LT(before, 22 * error) << kind.name;
            }
            before = error;
        }
    }
    Scene none;
    EXPECT_THROW(add_shape_mesh("none", 8, none), std::out_of_range);
}

// Rays that hit a shape hit its finest mesh at the same distance, but for its error and the slant of the surface.
TEST(Shapes, AreTheSameAsTheirMeshes) {
    const SceneCatalog catalog(source_file("scenes"), "");
    Progress progress;
    for (const MeshedShape& kind : meshed_shapes()) {
        std::vector<rt_hit> hits[2];
        Scene mesh;
        const double error = add_shape_mesh(kind.name, 128, mesh);
        const BenchScene shape = catalog.project(std::string("shapes/") + kind.name);
        ASSERT_EQ(shape.missing, "");
        const ScenePtr scenes[2] = {load_scene(Workbench::get().plugins(), shape, 1, ImportOptions{}, progress).scene,
                                    std::make_shared<const Scene>(std::move(mesh))};
        std::vector<rt_ray> rays;
        for (int i = 0; i < 400; ++i) {
            const float x = 1.8f * float(i % 20) / 19 - 0.9f, y = 1.6f * float(i / 20) / 19;
            rays.push_back({{0.3f * x, y + 0.2f, 3}, 0, {0.1f * x, -0.1f, -1}, INFINITY});
        }
        Settings settings;
        settings.accel = "bvh2";
        settings.lanes = 1;
        for (int i = 0; i < 2; ++i) hits[i] = Workbench::get().rays(scenes[i], settings, rays, RayQuery{});
        size_t both = 0, one = 0;
        for (size_t i = 0; i < rays.size(); ++i) {
            const bool a = hits[0][i].prim >= 0, b = hits[1][i].prim >= 0;
            both += a && b && std::fabs(hits[0][i].t - hits[1][i].t) < 5 * error + 1e-4;
            one += a || b;
        }
        EXPECT_GT(one, 40u) << kind.name;
        EXPECT_GT(both, 0.93 * double(one)) << kind.name;
        // Both scatter rays alike: shapes have no normals on the host, so they are found by rays.
        constexpr int kSize = 48;
        const RaySet primary = camera_rays(make_view(*scenes[0], 1).camera, kSize, kSize);
        std::vector<RaySet> scattered[2];
        for (int i = 0; i < 2; ++i)
            scattered[i] =
                secondary_rays(*scenes[i], whitted_light(RT_LIGHT_POINT, {6, 9, 7}, {1, 1, 1}), primary, kSize, kSize,
                               [&](const auto& some) { return Workbench::get().rays(scenes[i], settings, some, RayQuery{}); });
        size_t alike = 0, active = 0;
        for (size_t i = 0; i < primary.rays.size(); ++i) {
            const rt_ray &a = scattered[0][2].rays[i], &b = scattered[1][2].rays[i];
            if (!is_active(a) || !is_active(b)) continue;
            ++active;
            alike +=
                a.direction[0] * b.direction[0] + a.direction[1] * b.direction[1] + a.direction[2] * b.direction[2] > 0.99f;
        }
        EXPECT_GT(active, 200u) << kind.name;
        EXPECT_GT(alike, 0.95 * double(active)) << kind.name;
    }
}

TEST(Suites, AllHaveValidSettings) {
    for (const std::string& name : suite_names()) {
        const Suite suite = suite_of({name});
        EXPECT_FALSE(suite.cases.empty()) << name;
        EXPECT_GT(suite.time_limit_s, 0) << name;
        std::set<std::string> names;
        for (const BenchCase& c : suite.cases) {
            EXPECT_EQ(c.suite, name);
            EXPECT_LT(c.scene, suite.scenes.size());
            EXPECT_TRUE(names.insert(c.name).second) << c.name;
            ASSERT_FALSE(c.variants.empty()) << c.name;
            std::set<std::string> labels;
            for (const Variant& variant : c.variants) {
                EXPECT_TRUE(labels.insert(variant.label).second) << c.name << " " << variant.label;
                EXPECT_NO_THROW(variant_settings(Workbench::get().plugins(), BenchRequest{}, variant)) << c.name;
            }
        }
    }
}

TEST(Suites, TheThesisHasSixTestsOfFourStepsThenAndNow) {
    std::map<std::string, std::set<int>> steps;
    for (const BenchCase& c : suite_of({"thesis"}).cases) {
        if (c.measure != "frame" || c.name.find("spheres21") == 0 || c.name.find("aim") == 0) continue;
        ASSERT_EQ(c.variants.size(), 2u);
        const Settings now = variant_settings(Workbench::get().plugins(), {}, c.variants[0]);
        const Settings then = variant_settings(Workbench::get().plugins(), {}, c.variants[1]);
        EXPECT_EQ(now.depth, then.depth);
        EXPECT_EQ(now.width, 1024);
        EXPECT_EQ(now.height, 768);
        EXPECT_EQ(then.accel, "spheres");
        EXPECT_EQ(then.lanes, 1);
        EXPECT_EQ(then.packet_w, 4);
        steps[c.name.substr(0, c.name.find('/'))].insert(now.depth);
    }
    EXPECT_EQ(steps.size(), 6u);
    for (const auto& [scene, depths] : steps) EXPECT_EQ(depths, (std::set<int>{1, 2, 3, 4})) << scene;
}

TEST(Suites, CpuHasBaselineFramesOfNearAndFarViews) {
    const Suite suite = suite_of({"cpu"}, {}, {"bvh2", "bvh8"});
    std::map<std::string, std::set<std::string>> measures;
    for (const BenchCase& c : suite.cases) {
        ASSERT_EQ(c.variants.size(), 2u);
        EXPECT_FALSE(c.baseline_qualities.empty()) << c.name;
        measures[suite.scenes[c.scene].source.name].insert(c.measure);
        if (c.measure != "whitted") continue;
        EXPECT_EQ(variant_settings(Workbench::get().plugins(), {}, c.variants[1]).depth, 5);
        EXPECT_EQ(variant_settings(Workbench::get().plugins(), {}, c.variants[1]).accel, "bvh8");
    }
    // Without the shared folder, the project's scenes are left.
    EXPECT_EQ(measures.count("skull near"), 1u);
    EXPECT_EQ(measures.count("spot far_1M"), 1u);
    for (const auto& [scene, found] : measures)
        EXPECT_EQ(found, (std::set<std::string>{"build", "primary", "shadow", "diffuse", "whitted"})) << scene;
    EXPECT_FALSE(suite.notes.empty());
    EXPECT_EQ(suite_of({"cpu"}).cases[0].variants.at(0).accel, "bvh8");
}

TEST_F(Catalog, MissingModelsOfViewsAreReported) {
    fs::create_directories(folder_ / "scenes/models");
    write("scenes/models/fandisk.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    size_t there = 0;
    for (const BenchView& view : shared().views()) {
        there += view.scene.missing.empty();
        Scene nothing;
        EXPECT_NO_THROW(make_view(nothing, 1, view.scene.camera, view.scene.light)) << view.scene.name;
        if (view.scene.missing.empty()) continue;
        EXPECT_NE(view.scene.missing.find("is not there"), std::string::npos);
    }
    EXPECT_EQ(there, 3u);
    EXPECT_GE(shared().views().size(), 8u);
}

TEST(Suites, OnlyKeepsTheCasesThatMatch) {
    BenchRequest request;
    request.suites = {"quick"};
    request.only = {"skull/sh", "/4 steps"};
    const Suite suite = make_suite(request, project(), Workbench::get().plugins());
    ASSERT_EQ(suite.cases.size(), 3u);
    for (const BenchCase& c : suite.cases) EXPECT_TRUE(c.name == "skull/shadow" || c.measure == "frame") << c.name;
    request.only = {"nothing of the kind"};
    EXPECT_THROW(make_suite(request, project(), Workbench::get().plugins()), Error);
}

TEST(Suites, FilesReplaceScenesAndAccelsBecomeVariants) {
    const Suite suite = suite_of({"accel"}, {"a.obj", "b.scene"}, {"bvh2,max_leaf=2", "bvh2,max_leaf=7"});
    ASSERT_EQ(suite.scenes.size(), 2u);
    EXPECT_EQ(suite.scenes[1].source.name, "b");
    for (const BenchCase& c : suite.cases) EXPECT_EQ(c.variants.size(), 2u) << c.name;
    EXPECT_EQ(suite_of({}, {"a.obj"}).cases.front().suite, "accel");
    EXPECT_THROW(suite_of({"fastest"}), Error);
}

TEST(Suites, UserSettingsHoldUnlessACaseSetsThem) {
    BenchRequest request;
    request.settings = {{"size", "64x48"}, {"depth", "9"}};
    const Settings s = variant_settings(Workbench::get().plugins(), request, {"x", "bvh2", {{"depth", "2"}}, false});
    EXPECT_EQ(s.width, 64);
    EXPECT_EQ(s.depth, 2);
    EXPECT_THROW(variant_settings(Workbench::get().plugins(), request, {"x", "bvh2,max_leaf=99", {}, false}), Error);
    EXPECT_THROW(variant_settings(Workbench::get().plugins(), request, {"x", "none", {}, false}), Error);
}

}  // namespace
