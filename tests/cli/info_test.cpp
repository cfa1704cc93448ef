// info_test.cpp -- `clarity info` on scenes with numbers computed by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"
#include "support/scratch.hpp"

namespace {

constexpr double kPi = 3.14159265358979;

// A unit cube of six quads, from 0 to 1.
constexpr const char* kCube =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

nlohmann::json info_of(const std::string& file) {
    const ProgramResult result = run_program({"info", file, "--json"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(result.out, nullptr, false);
}

}  // namespace

TEST(Info, CountsAndMeasuresAPlacedModel) {
    const Scratch scratch;
    scratch.write("cube.obj", kCube);
    const std::string scene = scratch.write("a.scene",
                                            "camera main eye 0 0 9 target 0 0 0 fov 30\n"
                                            "light point position 0 9 0\n"
                                            "load cube.obj\n"
                                            "load cube.obj translate 5 0 0 scale 2\n"
                                            "sphere center -3 0 0 radius 1\n"
                                            "polygon vertices 0 0 -4  2 0 -4  2 3 -4  0 3 -4\n"
                                            "plane normal 0 1 0 offset -2\n");
    const nlohmann::json info = info_of(scene);
    ASSERT_TRUE(info.is_object());
    EXPECT_EQ(info["triangles"], 24);
    EXPECT_EQ(info["instances"], 2);
    EXPECT_EQ(info["spheres"], 1);
    EXPECT_EQ(info["polygons"], 1);
    EXPECT_EQ(info["planes"], 1);
    EXPECT_EQ(info["lights"], 1);
    EXPECT_EQ(info["cameras"], 1);
    EXPECT_GE(info["materials"], 1);
    EXPECT_GE(info["meshes"], 1);
    EXPECT_EQ(info["bounds"]["min"], nlohmann::json({-4, -1, -4}));
    EXPECT_EQ(info["bounds"]["max"], nlohmann::json({7, 3, 2}));
    EXPECT_NEAR(info["surface_area"].get<double>(), 6 + 24 + 4 * kPi + 6, 1e-4);
    EXPECT_EQ(info["up_axis"], "y");
    EXPECT_TRUE(info["unit_scale"].is_null());
    EXPECT_EQ(info["warnings"], nlohmann::json::array());
}

// What `path` draws light from, and what it only finds.
TEST(Info, LightsAreCountedByKind) {
    const Scratch scratch;
    const std::string scene = scratch.write("lit.scene",
                                            "light point position 0 9 0\nlight point position 1 9 0\n"
                                            "light rect center 0 3 0 u 1 0 0 v 0 0 1\n"
                                            "material glow emission 1 1 1\nmaterial leaf emission 1 1 1 alpha mask\n"
                                            "sphere center 9 0 0 material leaf\n"
                                            "plane normal 0 1 0 offset -2 material glow\nsphere radius 1 material glow\n"
                                            "polygon vertices 0 0 0  2 0 0  2 2 0  1 .5 0 material glow\n"
                                            "polygon vertices 0 0 9  2 0 9  2 2 9  1 .5 9 material glow\n");
    const nlohmann::json info = info_of(scene);
    EXPECT_EQ(info["lights"], 3);
    EXPECT_EQ(info["light_kinds"], (nlohmann::json{{"point", 2}, {"rect", 1}}));
    EXPECT_EQ(info["emissive"]["spheres"], 1);
    EXPECT_EQ(info["emissive"]["planes"], 1);
    EXPECT_EQ(info["emissive"]["bent_polygons"], 2);
    EXPECT_EQ(info["emissive"]["cut_out"], 1);
    EXPECT_EQ(info["emissive"]["by_rays_alone"], 4);
    EXPECT_EQ(info["materials_with_alpha"], 1);
    const std::string text = run_program({"info", scene}).out;
    EXPECT_NE(text.find("3, 2 point, 1 rect\n"), std::string::npos) << text;
    EXPECT_NE(text.find("1 plane, 2 polygons that are not convex, 1 surface that is cut out or has textures of varnish: "),
              std::string::npos)
        << text;
}

// Of each material the model and what differs from defaults; what only Whitted's tracers read follows other models.
TEST(Info, ListsMaterials) {
    const Scratch scratch;
    const std::string scene = scratch.write("layers.scene",
                                            "material steel model gltf metallic 1 roughness .25 sheen_color 0 .5 0\n"
                                            "material glow emission 1 2 3 reflect .5\n"
                                            "sphere radius 1 material steel\nsphere radius 2 material glow\n");
    const nlohmann::json list = info_of(scene)["material_list"];
    ASSERT_EQ(list.size(), 3u);
    EXPECT_EQ(list[1], nlohmann::json::parse(
                           R"({"name":"steel","model":"gltf","roughness":0.25,"metallic":1.0,"sheen_color":[0.0,0.5,0.0]})"));
    EXPECT_EQ(list[2], nlohmann::json::parse(R"({"name":"glow","model":"whitted","emission":[1.0,2.0,3.0],"reflect":0.5})"));
    const std::string text = run_program({"info", scene}).out;
    std::filesystem::copy_file(CLARITY_SOURCE_DIR "/scenes/textures/grid.png", scratch.path("grid.png"));
    const std::string mapped = scratch.write("mapped.scene",
                                             "texture wood grid.png uv 1 offset .5 0 strength .5\n"
                                             "material m normal_map wood\nsphere material m\n");
    EXPECT_EQ(info_of(mapped)["material_list"][1]["normal_map"],
              nlohmann::json::parse(R"({"texture":0,"name":"wood","uv":1,"strength":0.5,"matrix":[1.0,0.0,0.5,0.0,1.0,0.0]})"));
    EXPECT_NE(text.find("steel: gltf, roughness 0.25, metallic 1, sheen_color 0 0.5 0\n"), std::string::npos) << text;
}

// With each material what its importer did not understand.
TEST(Info, SaysWhatIsLeftOutOfAMaterial) {
    const Scratch scratch;
    scratch.write("a.mtl", "newmtl known\nKd 1 0 0\nnewmtl strange\nKd 0 1 0\nfresnel_sheen 3\n");
    const std::string file =
        scratch.write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl known\nf 1 2 3\nusemtl strange\nf 3 2 1\n");
    const nlohmann::json list = info_of(file)["material_list"];
    ASSERT_EQ(list.size(), 3u);
    EXPECT_FALSE(list[1].contains("left_out")) << list[1];
    EXPECT_EQ(list[2]["left_out"], "fresnel_sheen");
    const std::string text = run_program({"info", file}).out;
    EXPECT_NE(text.find("; left out: fresnel_sheen\n"), std::string::npos) << text;
}

TEST(Info, SeveralFilesAreOneScene) {
    const Scratch scratch;
    const std::string a = scratch.write("a.obj", kCube), b = scratch.write("b.scene", "sphere center 4 0 0 radius 2\n");
    const ProgramResult result = run_program({"info", "--json", a, b});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const nlohmann::json info = nlohmann::json::parse(result.out);
    EXPECT_EQ(info["triangles"], 12);
    EXPECT_EQ(info["spheres"], 1);
    EXPECT_EQ(info["bounds"]["max"], nlohmann::json({6, 2, 2}));
}

TEST(Info, ASceneOfPlanesHasNoBounds) {
    const Scratch scratch;
    const nlohmann::json info = info_of(scratch.write("a.scene", "plane normal 0 1 0 offset 0\n"));
    EXPECT_TRUE(info["bounds"].is_null());
    EXPECT_EQ(info["surface_area"], 0);
}

TEST(Info, TextListsCountsWithoutZeros) {
    const Scratch scratch;
    const std::string file = scratch.write("cube.obj", kCube);
    const ProgramResult result = run_program({"info", file});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out.rfind(file + "\n", 0), 0u) << result.out;
    EXPECT_NE(result.out.find("triangles     12, from 6 faces"), std::string::npos) << result.out;
    EXPECT_EQ(result.out.find("spheres"), std::string::npos) << "counts of 0 are not printed";
    EXPECT_EQ(result.out.find('\033'), std::string::npos);
}

// A file gives the same scene in the worker process as in the program's own process.
TEST(Info, ImportInProcessGivesTheSameScene) {
    const Scratch scratch;
    const std::string file = scratch.write("cube.obj", kCube);
    EXPECT_EQ(run_program({"info", "--json", file}).out, run_program({"info", "--json", "--import-in-process", file}).out);
}

// A triangle whose morph target, of weight 1, lifts it by 2: at rest it is lifted, and --undeformed shows it as stored.
TEST(Info, ShowsMeshesAsStoredOnRequest) {
    const Scratch scratch;
    const std::string file =
        scratch.write("lifted.gltf", R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"weights": [1], "primitives": [{"attributes": {"POSITION": 0}, "targets": [{"POSITION": 1}]}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 36}],
        "buffers": [{"byteLength": 72, "uri": "data:,%00%00%00%00%00%00%00%00%00%00%00%00%00%00%80%3f%00%00%00%00%00%00%00%00%00%00%00%00%00%00%80%3f%00%00%00%00%00%00%00%00%00%00%00%00%00%00%00%40%00%00%00%00%00%00%00%00%00%00%00%40%00%00%00%00%00%00%00%00%00%00%00%40"}]})");
    const auto height = [&](const std::vector<std::string>& words) {
        std::vector<std::string> all = {"info", file, "--json"};
        all.insert(all.end(), words.begin(), words.end());
        const ProgramResult result = run_program(all);
        EXPECT_EQ(result.exit_code, 0) << result.err;
        return nlohmann::json::parse(result.out)["bounds"]["max"][2].get<double>();
    };
    EXPECT_EQ(height({}), 2);
    EXPECT_EQ(height({"--undeformed"}), 0);
    EXPECT_EQ(height({"--importer", "gltf,undeformed=true"}), 0);
    EXPECT_EQ(height({"--importer", "any,undeformed=1"}), 0);
    EXPECT_EQ(height({"--importer", "gltf,undeformed=true", "--importer", "gltf,undeformed=false"}), 2);
    EXPECT_EQ(height({"--importer", "scene,undeformed=true"}), 2) << "that is another importer";
    EXPECT_EQ(height({"--undeformed", "--time", "0"}), 2) << "poses are of all that moves";
    EXPECT_EQ(run_program({"info", file, "--importer", "any,units=1"}).exit_code, 2);
    const ProgramResult wrong = run_program({"info", file, "--importer", "gltf,undeformed=maybe"});
    EXPECT_EQ(wrong.exit_code, 2);
    EXPECT_NE(wrong.err.find("undeformed=maybe: expected true or false"), std::string::npos) << wrong.err;
}
