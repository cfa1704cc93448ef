// The project's own scenes through the built plugins and the worker process, and the messages that a user sees for broken ones.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <ostream>

#include "base/error.hpp"
#include "import/import.hpp"

namespace {

using namespace clarity;
using namespace clarity::import;
namespace fs = std::filesystem;

Scene import_file(const std::string& path) {
    static const PluginRegistry plugins = PluginRegistry::discover();
    Progress progress;
    ImportOptions options;
    if (const char* worker = std::getenv("CLARITY_WORKER")) options.worker = worker;
    return import_scene(plugins, {path}, options, progress);
}

// The expected values come from other sources: statements of the scene files, assimp's own loading of the models with their
// node transforms applied, and formulas for the areas of spheres and polygons. Some faces of spot.obj are not planar; their
// area depends on the triangulation.
struct Golden {
    const char* file;
    size_t meshes, instances, spheres, planes, polygons, lights, cameras, textures;
    uint64_t triangles;
    double area, area_tolerance;  // relative
    std::array<float, 3> min, max;
    bool has_models;  // true: the scene needs other importers too
};

void PrintTo(const Golden& golden, std::ostream* out) {
    *out << golden.file;
}

// clang-format off
const Golden kGoldens[] = {
    {"spheres21.scene", 0, 0, 21, 1, 0, 2, 2, 0, 0, 72.0518, 1e-5, {-3.639f, 0, -3.639f}, {3.639f, 2.3f, 3.639f}, false},
    {"cornell.scene", 0, 0, 2, 0, 6, 1, 1, 0, 0, 23.58086, 1e-5, {-1, 0, -1}, {1, 2, 1}, false},
    {"primitives.scene", 2, 4, 7, 1, 4, 2, 3, 1, 1120, 80.14, 1e-2, {-5.75f, -.0386875f, -5.81664f}, {5.8f, 2.57604f, 3.6f}, true},
    {"showpiece.scene", 17, 36, 15, 0, 0, 3, 4, 1, 16196, 893.16, 1e-4, {-6.2f, -.15f, -5}, {6.8f, 4, 8.9f}, true},
    {"showpiece_sky.scene", 17, 36, 15, 0, 0, 3, 4, 1, 16196, 893.16, 1e-4, {-6.2f, -.15f, -5}, {6.8f, 4, 8.9f}, true},
    {"spheres_sky.scene", 0, 0, 7, 0, 1, 0, 1, 0, 0, 1627.5204, 1e-6, {-20, 0, -20}, {20, 1.2f, 20}, false},
    {"veach.scene", 0, 0, 0, 0, 6, 4, 1, 0, 0, 443.947, 1e-5, {-9, 0, -5}, {9, 9, 9}, false},
    {"shapes.scene", 0, 0, 0, 1, 0, 2, 2, 1, 0, 0, 0, {-4.1f, 0, -1.66476f}, {4.67204f, 2.22952f, 2.78f}, false},
};
// clang-format on

class SceneFiles : public testing::TestWithParam<Golden> {};

TEST_P(SceneFiles, MatchTheirGoldenFiles) {
    const Golden& golden = GetParam();
#ifndef CLARITY_HAVE_MODEL_IMPORTERS
    if (golden.has_models) GTEST_SKIP() << "SKIPPED: the importers assimp and openmesh are not built";
#endif
    const Scene scene = import_file(std::string(CLARITY_SOURCE_DIR "/scenes/") + golden.file);
    EXPECT_EQ(scene.meshes.size(), golden.meshes);
    EXPECT_EQ(scene.instances.size(), golden.instances);
    EXPECT_EQ(scene.spheres.size(), golden.spheres);
    EXPECT_EQ(scene.planes.size(), golden.planes);
    EXPECT_EQ(scene.polygons.size(), golden.polygons);
    EXPECT_EQ(scene.lights.size(), golden.lights);
    EXPECT_EQ(scene.cameras.size(), golden.cameras);
    EXPECT_EQ(scene.textures.size(), golden.textures);
    EXPECT_EQ(scene.placed_triangle_count(), golden.triangles);
    EXPECT_NEAR(scene.surface_area(), golden.area, golden.area_tolerance * golden.area);
    const Bounds bounds = scene.bounds();
    const double tolerance = 1e-5 * std::hypot(golden.max[0] - golden.min[0], golden.max[1] - golden.min[1]);
    for (size_t axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(bounds.min[axis], golden.min[axis], tolerance) << "axis " << axis;
        EXPECT_NEAR(bounds.max[axis], golden.max[axis], tolerance) << "axis " << axis;
    }
    EXPECT_EQ(scene.up_axis, 1u);
    for (const std::string& warning : scene.warnings) ADD_FAILURE() << "warning: " << warning;
}

INSTANTIATE_TEST_SUITE_P(Golden, SceneFiles, testing::ValuesIn(kGoldens), [](const auto& info) {
    const std::string file = info.param.file;
    return file.substr(0, file.find('.'));
});

TEST(SceneFolder, HasAGoldenForEveryScene) {
    for (const auto& entry : fs::directory_iterator(CLARITY_SOURCE_DIR "/scenes")) {
        if (entry.path().extension() != ".scene") continue;
        const std::string name = entry.path().filename().string();
        if (name == "plaster_sky.scene") continue;  // holds no surface
        EXPECT_TRUE(std::any_of(std::begin(kGoldens), std::end(kGoldens), [&](const Golden& g) { return name == g.file; }))
            << name;
    }
}

TEST(SceneFolder, DegenerateSceneIsKeptAndFinite) {
    const Scene scene = import_file(CLARITY_SOURCE_DIR "/tests/plugins/scene_format/degenerate.scene");
    EXPECT_EQ(scene.placed_triangle_count(), 9u);
    EXPECT_EQ(scene.spheres.size(), 5u);
    EXPECT_EQ(scene.polygons.size(), 3u);
    EXPECT_TRUE(std::isfinite(scene.surface_area()));
    EXPECT_TRUE(std::isfinite(scene.bounds().diagonal()));
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("degenerate.scene:12:"), std::string::npos) << scene.warnings[0];
}

// Writes the files of one test into a folder of its own.
class Scenes : public testing::Test {
 protected:
    void SetUp() override { fs::create_directories(folder_ / "parts"); }
    void TearDown() override { fs::remove_all(folder_); }
    std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name, std::ios::binary) << text;
        return (folder_ / name).string();
    }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    static std::string error_of(const std::string& file) {
        try {
            import_file(file);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), Exit::import_failed);
            return error.what();
        }
        return "no error";
    }

    fs::path folder_ = fs::temp_directory_path() / ("clarity_scenes_" + std::to_string(getpid()));
};

TEST_F(Scenes, TexturesByUse) {
    fs::copy_file(CLARITY_SOURCE_DIR "/scenes/textures/grid.png", folder_ / "grid.png");
    const std::string text =
        write("own.scene",
              "texture wood grid.png scale 2 .5 rotate 30 wrap clamp\n"
              "texture dents grid.png uv 1 strength .5 filter nearest\n"
              "material m model gltf color_map wood normal_map dents metallic_roughness_map dents emission_map plain\n"
              "texture plain grid.png\nsphere material m\n");
    const Scene scene = import_file(text);
    EXPECT_TRUE(scene.warnings.empty());
    // Wood, dents, and plain as a colour; the first and the last differ in how they wrap.
    EXPECT_EQ(scene.texture_names, (std::vector<std::string>{"wood", "dents", "plain"}));
    ASSERT_EQ(scene.textures.size(), 3u);
    EXPECT_EQ(scene.textures[0].first, scene.textures[2].first) << "a picture is there once for each colour space";
    EXPECT_NE(scene.textures[0].first, scene.textures[1].first);
    EXPECT_EQ(scene.textures[1].flags, RT_TEXTURE_LINEAR | RT_TEXTURE_NEAREST);
    const MaterialMaps& maps = scene.materials.at(1).maps;
    ASSERT_EQ(scene.maps.size(), 4u);
    EXPECT_EQ(scene.maps.at(maps[RT_MAP_COLOR]).texture, 0u);
    EXPECT_NEAR(scene.maps[maps[RT_MAP_COLOR]].matrix[0], 2 * std::cos(3.14159265 / 6), 1e-6);
    EXPECT_NEAR(scene.maps[maps[RT_MAP_COLOR]].matrix[1], -0.5 * std::sin(3.14159265 / 6), 1e-6);
    EXPECT_EQ(scene.maps.at(maps[RT_MAP_NORMAL]).scale, 0.5f);
    EXPECT_EQ(scene.maps.at(maps[RT_MAP_METALLIC_ROUGHNESS]).set, 1u);
    EXPECT_EQ(scene.maps.at(maps[RT_MAP_EMISSION]).texture, 2u);
    EXPECT_EQ(scene.materials[1].values.roughness, 1) << "times the texture";
    // A file that is not there is a warning that names it, and the material stays without it.
    const Scene without = import_file(write("gone.scene", "texture t gone.png\nmaterial m normal_map t\nsphere material m\n"));
    ASSERT_EQ(without.warnings.size(), 1u);
    EXPECT_NE(without.warnings[0].find("gone.png"), std::string::npos) << without.warnings[0];
    EXPECT_EQ(without.materials.at(1).maps, no_maps());
}

TEST_F(Scenes, ErrorIsOneLineThatNamesThePlaceOnce) {
    const std::string file = write("bad.scene", "sphere\nsphere radious 1\n");
    EXPECT_EQ(error_of(file),
              file + ":2:8: unknown key `radious`; did you mean `radius`? (keys of sphere: center, radius, material)");
}

TEST_F(Scenes, MissingFileNamesTheLineThatLoadsIt) {
    const std::string file = write("main.scene", "sphere\nload \"gone.scene\"\n");
    EXPECT_EQ(error_of(file).find(file + ":2:6: cannot load 'gone.scene': "), 0u) << error_of(file);
}

TEST_F(Scenes, ErrorInALoadedFileNamesBothPlaces) {
    write("parts/part.scene", "sphere\n\nsphere radius -1\n");
    const std::string file = write("main.scene", "load parts/part.scene\n");
    const std::string error = error_of(file);
    EXPECT_EQ(error.find(file + ":1:6: cannot load 'parts/part.scene': "), 0u) << error;
    EXPECT_NE(error.find("part.scene:3:15: a radius is positive"), std::string::npos) << error;
}

TEST_F(Scenes, ScenesThatLoadEachOtherAreErrors) {
    write("b.scene", "load a.scene\n");
    const std::string file = write("a.scene", "load b.scene\n");
    EXPECT_NE(error_of(file).find("circle: a.scene -> b.scene -> a.scene"), std::string::npos) << error_of(file);
}

TEST_F(Scenes, LoadedScenesArePlacedAndKeepTheirOwnNames) {
    write("parts/pair.scene",
          "material m color 1 0 0\nbackground 1\ncamera inner eye 0 0 3\n"
          "sphere center 1 0 0 radius .5 material m\npolygon vertices 0 0 0 1 0 0 0 1 0\n");
    const std::string file = write("main.scene",
                                   "load parts/pair.scene translate 10 0 0 rotate 0 1 0 90 scale 2\n"
                                   "load parts/pair.scene material m\n"
                                   "material m color 0 1 0\nbackground .25\ncamera outer\n");
    const Scene scene = import_file(file);
    ASSERT_EQ(scene.spheres.size(), 2u);
    const Sphere& moved = scene.spheres[0];
    EXPECT_NEAR(moved.center[0], 10, 1e-5);
    EXPECT_NEAR(moved.center[2], -2, 1e-5);  // x turns to -z about +y
    EXPECT_NEAR(moved.radius, 1, 1e-6);
    EXPECT_EQ(scene.materials.at(moved.material).values.color[0], 1);
    EXPECT_EQ(scene.materials.at(scene.spheres[1].material).values.color[1], 1);
    EXPECT_EQ(scene.background[0], 0.25f);
    ASSERT_GE(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.cameras[0].name, "outer");
}

TEST_F(Scenes, MissingTextureIsAWarning) {
    const Scene scene = import_file(write("main.scene", "material m texture gone.png\nsphere material m\n"));
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("gone.png"), std::string::npos) << scene.warnings[0];
}

}  // namespace
