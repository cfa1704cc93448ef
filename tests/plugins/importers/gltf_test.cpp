// gltf_test.cpp -- small glTF files made here: what the format can say about a triangle, and what is wrong in a broken file.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "base/error.hpp"
#include "gltf_model.hpp"
#include "import/import.hpp"
#include "measure.hpp"
#include "support/errors.hpp"

namespace clarity::test {
namespace {

class Gltf : public testing::Test {
 protected:
    Scene import(const std::string& bytes, const std::string& name = "model.gltf") {
        return import_file(folder_.write(name, bytes));
    }
    void expect_refused(const std::string& bytes, const std::string& part, const std::string& name = "model.gltf") {
        expect_error([&] { import(bytes, name); }, {name + ": ", part});
    }
    Scratch folder_;
};

TEST_F(Gltf, ReadsStripsAndFans) {
    for (const int mode : {5, 6}) {
        Model model = quad();
        model.primitive()["mode"] = mode;
        model.indices(mode == 5 ? std::vector<uint16_t>{0, 1, 2, 3} : std::vector<uint16_t>{0, 1, 3, 2});
        const Scene scene = import(model.text());
        EXPECT_EQ(scene.triangle_count(), 2u);
        EXPECT_NEAR(scene.surface_area(), 1, 1e-6) << "mode " << mode;
        for (size_t t = 0; t < 2; ++t) {  // all of them show the same side
            const rt_u32* v = &scene.triangles[3 * t];
            const float* p = scene.positions.data();
            const float cross = (p[3 * v[1]] - p[3 * v[0]]) * (p[3 * v[2] + 1] - p[3 * v[0] + 1]) -
                                (p[3 * v[1] + 1] - p[3 * v[0] + 1]) * (p[3 * v[2]] - p[3 * v[0]]);
            EXPECT_GT(cross, 0) << "mode " << mode << ", triangle " << t;
        }
    }
}

TEST_F(Gltf, PlacesWhatStandsStill) {
    Model model = quad();
    model.indices({0, 1, 2, 1, 3, 2});
    model["extensions"] = {{"KHR_lights_punctual", {{"lights", {{{"type", "directional"}}, {{"type", "point"}}}}}}};
    model["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}}};
    const double half = std::sqrt(0.5);
    // A quarter turn about y, and a matrix (column by column) that doubles and moves by (0, 1, 0).
    model["nodes"] = {{{"translation", {4, 5, 6}}, {"rotation", {0, half, 0, half}}, {"children", {1, 2, 3}}},
                      {{"mesh", 0}, {"matrix", {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 1, 0, 1}}},
                      {{"camera", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}},
                      {{"translation", {0, 0, 1}}, {"extensions", {{"KHR_lights_punctual", {{"light", 1}}}}}}};
    const Scene scene = import(model.text());
    EXPECT_TRUE(scene.motion.nodes.empty());
    const std::array<float, 3> min = {4, 6, 4}, max = {4, 8, 6};
    for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(scene.bounds().min[k], min[k], 1e-5);
        EXPECT_NEAR(scene.bounds().max[k], max[k], 1e-5);
    }
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_NEAR(scene.cameras[0].eye[1], 5, 1e-6);
    EXPECT_NEAR(scene.cameras[0].target[0] - scene.cameras[0].eye[0], -1, 1e-6);  // along -z of the turned node
    ASSERT_EQ(scene.lights.size(), 2u);
    EXPECT_NEAR(scene.lights[0].values.position[0], 1, 1e-6);  // towards the light
    EXPECT_NEAR(scene.lights[0].values.position[1], 0, 1e-6);
    EXPECT_NEAR(scene.lights[1].values.position[0], 5, 1e-6);
}

TEST_F(Gltf, SpotsKeepTheirCones) {
    Model model = quad();
    model.indices({0, 1, 2});
    const json cone = {{"outerConeAngle", 0.5}, {"innerConeAngle", 0.25}};
    model["extensions"] = {{"KHR_lights_punctual", {{"lights", {{{"type", "spot"}, {"spot", cone}}, {{"type", "spot"}}}}}}};
    const double half = std::sqrt(0.5);
    model["nodes"] = {{{"mesh", 0}, {"children", {1, 2}}},
                      {{"translation", {4, 5, 6}},
                       {"rotation", {0, half, 0, half}},
                       {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}},
                      {{"extensions", {{"KHR_lights_punctual", {{"light", 1}}}}}}};
    const Scene scene = import(model.text());
    EXPECT_TRUE(scene.warnings.empty());
    ASSERT_EQ(scene.lights.size(), 2u);
    const rt_light &light = scene.lights[0].values, &usual = scene.lights[1].values;
    EXPECT_EQ(light.kind, RT_LIGHT_SPOT);
    EXPECT_NEAR(light.position[2], 6, 1e-6);
    EXPECT_NEAR(light.normal[0], -1, 1e-6) << "along -z of the turned node";
    EXPECT_NEAR(light.cos_outer, std::cos(0.5), 1e-6);
    EXPECT_NEAR(light.cos_inner, std::cos(0.25), 1e-6);
    EXPECT_EQ(light.flags, RT_LIGHT_FALLOFF);
    EXPECT_NEAR(usual.cos_outer, half, 1e-6) << "the format's own: a quarter of half a turn";
    EXPECT_EQ(usual.cos_inner, 1);
}

// KHR_lights_punctual: candela and lux. Bright ones are no reason to change others.
TEST_F(Gltf, LightsKeepTheirUnits) {
    Model model = quad();
    model.indices({0, 1, 2});
    model["extensions"] = {{"KHR_lights_punctual",
                            {{"lights",
                              {{{"type", "point"}, {"intensity", 800}, {"color", {1, 0.5, 0.25}}, {"range", 12.5}},
                               {{"type", "spot"}, {"intensity", 20}},
                               {{"type", "directional"}, {"intensity", 3}},
                               {{"type", "point"}}}}}}};
    model["nodes"] = {{{"mesh", 0}}};
    for (int i = 0; i < 4; ++i) {
        const nlohmann::json own = {{"KHR_lights_punctual", {{"light", i}}}};
        model["nodes"].push_back({{"translation", {0, 3, 0}}, {"extensions", own}});
    }
    model["scenes"][0]["nodes"] = {0, 1, 2, 3, 4};
    const Scene scene = import(model.text());
    EXPECT_TRUE(scene.warnings.empty());
    ASSERT_EQ(scene.lights.size(), 4u);
    const auto light = [&](size_t i) -> const rt_light& { return scene.lights[i].values; };
    EXPECT_EQ(light(0).kind, RT_LIGHT_POINT);
    EXPECT_EQ(light(0).flags, RT_LIGHT_FALLOFF);
    EXPECT_EQ(light(0).color[0], 800);
    EXPECT_EQ(light(0).color[2], 200);
    EXPECT_EQ(light(0).range, 12.5f);
    EXPECT_EQ(light(1).range, 0);
    EXPECT_EQ(light(1).kind, RT_LIGHT_SPOT);
    EXPECT_EQ(light(1).flags, RT_LIGHT_FALLOFF);
    EXPECT_EQ(light(1).color[1], 20);
    EXPECT_EQ(light(2).kind, RT_LIGHT_SUN) << "its colour is an irradiance";
    EXPECT_EQ(light(2).color[1], 3);
    EXPECT_EQ(light(2).angle, 0);
    EXPECT_EQ(light(2).position[2], 1) << "it shines along -z";
    EXPECT_EQ(light(3).color[1], 1);
}

TEST_F(Gltf, LeavesPointsAndLinesOutWithOneWarning) {
    Model model = quad();
    model.indices({0, 1, 2});
    json line = model.primitive();
    line["mode"] = 1;
    model["meshes"][0]["primitives"].push_back(line);
    model["meshes"][0]["primitives"].push_back(line);
    const Scene scene = import(model.text());
    EXPECT_EQ(scene.triangle_count(), 1u);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("points and lines"), std::string::npos);
}

TEST_F(Gltf, ReadsSparseAccessorsAlsoWithoutAView) {
    Model model = quad();
    model.indices({0, 1, 2});
    const std::vector<uint8_t> where = {1, 2};
    const size_t places = model.add(where, "SCALAR", 5121, 1);
    const size_t values = model.add(std::vector<float>{3, 0, 0, 0, 2, 0}, "VEC3", 5126, 3);
    const auto view = [&](size_t accessor) { return model["accessors"][accessor]["bufferView"]; };
    json& positions = model["accessors"][0];
    positions["sparse"] = {{"count", 2},
                           {"indices", {{"bufferView", view(places)}, {"componentType", 5121}}},
                           {"values", {{"bufferView", view(values)}}}};
    EXPECT_NEAR(import(model.text()).surface_area(), 3, 1e-6);
    positions.erase("bufferView");  // the others are zeros
    EXPECT_NEAR(import(model.text()).surface_area(), 3, 1e-6);
    positions["sparse"]["count"] = 3;
    expect_refused(model.text(), "accessors[0].sparse.indices: found 3 elements of 1 bytes");
}

TEST_F(Gltf, ReadsQuantizedStridedPositions) {
    Model model;
    // Normalised 16-bit integers, 8 bytes apart; the fourth number of each is padding.
    const std::vector<int16_t> values = {0, 0, 0, 9, 32767, 0, 0, 9, 0, -32768, 0, 9};
    model.primitive()["attributes"]["POSITION"] = model.add(values, "VEC3", 5122, 4);
    model["accessors"][0]["normalized"] = true;
    model["bufferViews"][0]["byteStride"] = 8;
    model["extensionsRequired"] = {"KHR_mesh_quantization"};
    const Scene scene = import(model.text());
    EXPECT_NEAR(scene.surface_area(), 0.5, 1e-6);
    EXPECT_FLOAT_EQ(scene.bounds().min[1], -1);
    model["bufferViews"][0]["byteStride"] = 4;
    expect_refused(model.text(), "bufferViews[0].byteStride: found 4, expected 6");
}

TEST_F(Gltf, TransformsTextureCoordinates) {
    Model model = quad();
    model.indices({0, 1, 2});
    model.primitive()["attributes"]["TEXCOORD_1"] = model.add(std::vector<float>{0, 0, 1, 0, 0, 1, 1, 1}, "VEC2", 5126, 2);
    model.primitive()["material"] = 0;
    model["materials"] = {{{"pbrMetallicRoughness",
                            {{"baseColorTexture",
                              {{"index", 0},
                               {"extensions",
                                {{"KHR_texture_transform",
                                  {{"texCoord", 1}, {"offset", {.25, .5}}, {"rotation", M_PI / 2}, {"scale", {2, 1}}}}}}}}}}}};
    model["textures"] = {{{"source", 0}}};
    model["images"] = {
        {{"uri", "data:image/tga;base64," + base64(std::string("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\x18\0abc", 21))}}};
    const Scene scene = import(model.text());
    ASSERT_EQ(scene.maps.size(), 1u);
    EXPECT_EQ(scene.materials.at(1).maps[RT_MAP_COLOR], 0u);
    EXPECT_EQ(scene.materials[1].values.texture, RT_NONE);
    EXPECT_EQ(scene.maps[0].set, 0u) << "the only set that the material uses";
    const auto at = [&](size_t vertex, int k) {
        const float* const m = scene.maps[0].matrix + 3 * k;
        return m[0] * scene.uvs[2 * vertex] + m[1] * scene.uvs[2 * vertex + 1] + m[2];
    };
    // u = 1 becomes 2 by the scale. A quarter of a turn counter-clockwise, where v points down, leads it to v = -2.
    EXPECT_NEAR(at(1, 0), .25, 1e-5);
    EXPECT_NEAR(at(1, 1), 1 - (.5 - 2), 1e-5);
    EXPECT_NEAR(at(2, 0), .25 + 1, 1e-5);
    EXPECT_NEAR(at(2, 1), 1 - .5, 1e-5);
}

TEST_F(Gltf, ReadsChunksAndFilesBesideTheScene) {
    Model model = quad();
    model.indices({0, 1, 2});
    EXPECT_NEAR(import(model.glb(), "model.glb").surface_area(), .5, 1e-6);
    json text = json::parse(model.text());
    text["buffers"][0]["uri"] = "some%20data.bin";
    folder_.write("some data.bin", model.bytes());
    EXPECT_NEAR(import(text.dump()).surface_area(), .5, 1e-6);
    folder_.write("some data.bin", model.bytes().substr(1));
    expect_refused(text.dump(), "buffers[0].byteLength: found 54, expected at most 53");
    for (const char* uri : {"../data.bin", "/etc/hostname", "http://localhost/data.bin", "a/../../data.bin"}) {
        text["buffers"][0]["uri"] = uri;
        expect_refused(text.dump(),
                       std::string("buffers[0].uri: found '") + uri + "', expected the name of a file in the scene's folder");
    }
    text["buffers"][0]["uri"] = "none.bin";
    expect_refused(
        text.dump(),
        "buffers[0].uri: found 'none.bin', expected a file in the scene's folder, or data; cannot open the file: No such file");
}

TEST_F(Gltf, NamesTheLineOfBrokenJson) {
    // The place is where the parser stops: behind the word that it did not expect.
    expect_refused("{\n \"asset\": {\"version\": \"2.0\"}\n \"nodes\": []\n}",
                   "line 3, column 8 (byte 38): found string literal, expected '}'");
    expect_refused("{\n \"asset\": {\"version\": \"2.0\"},\n}",
                   "line 3, column 1 (byte 32): found '}', expected string literal");
    expect_refused("{\"asset\": {\"version\": 2.}}", "found invalid number, expected digit after '.'; last read: '2.}'");
    expect_refused("{\"asset\": {\"version\": \"2.0", "found invalid string: missing closing quote; last read: '\"2.0'");
    expect_refused("{\"asset\": {\"version\": \"" + std::string(200, '2'), "2222...', expected JSON");
    expect_refused("{\"asset\": {\"version\": \"2; expected 3", "last read: '\"2; expected 3', expected JSON");
    expect_refused("{\"asset\": {\"version\": \"" + std::string(100000, 'x'), "...");
    expect_refused("{\"asset\": \"\xC3\x28\"}", "ill-formed UTF-8");
    expect_refused("{\"asset\":\n[1e999]}", "line 2, column 2 (byte 11): found '1e999', expected a number");
    expect_refused("{\"a\":\n" + std::string(100000, '['),
                   "line 2, column 128 (byte 133): found another level, expected at most 128");
    expect_refused("{\"a\": \"\\\"[[\", \"b\": " + std::string(127, '[') + std::string(127, ']') + "}", "asset");
    expect_refused("", "the file is empty");
    expect_refused("[]", "the top level: found an array");
}

TEST_F(Gltf, NamesTheByteOfABrokenContainer) {
    Model model = quad();
    const std::string good = model.glb();
    expect_refused(good.substr(0, good.size() - 8), "byte 8: found a length of", "model.glb");
    std::string bytes = good;
    bytes[4] = 1;
    expect_refused(bytes, "byte 4: found version 1", "model.glb");
    bytes = good;
    bytes[15] = 0x7F;
    expect_refused(bytes, "byte 12: found a chunk of", "model.glb");
    bytes = good;
    bytes[16] = 'X';
    expect_refused(bytes, "byte 16: found a chunk of type 'XSON'", "model.glb");
    expect_refused(good.substr(0, 14), "byte 14: found the end of the file", "model.glb");
}

TEST_F(Gltf, NamesThePlaceOfWrongContent) {
    const auto broken = [&](const char* part, const std::function<void(Model&)>& edit) {
        Model model = quad();
        model.indices({0, 1, 2});
        edit(model);
        expect_refused(model.text(), part);
    };
    broken("accessors[0].bufferView: found 17, expected the index of one of 2 bufferViews",
           [](Model& m) { m["accessors"][0]["bufferView"] = 17; });
    broken("accessors[0]: found 5 elements of 12 bytes, 12 apart, from byte 0",
           [](Model& m) { m["accessors"][0]["count"] = 5; });
    broken("accessors[0].count: found -3, expected a whole number", [](Model& m) { m["accessors"][0]["count"] = -3; });
    broken("expected at most 4194304 in an accessor without a bufferView", [](Model& m) {
        m["accessors"][0].erase("bufferView");
        m["accessors"][0]["count"] = 4000000000u;
    });
    broken("accessors[0].type: found 'VEC2', expected VEC3 for meshes[0].primitives[0].attributes.POSITION",
           [](Model& m) { m["accessors"][0]["type"] = "VEC2"; });
    broken("accessors[1].componentType: found 5126, expected 5121, 5123 or 5125",
           [](Model& m) { m["accessors"][1]["componentType"] = 5126; });
    broken("nodes[2].children[0]: found 0, which is a child of nodes[1], too", [](Model& m) {
        m["nodes"] = {{{"mesh", 0}}, {{"children", {0}}}, {{"children", {0}}}};
        m["scenes"][0]["nodes"] = {1, 2};
    });
    broken("meshes[0].primitives[0]: found the index 70 at position 1 of its indices, expected one below 4",
           [](Model& m) { m.indices({0, 70, 1}); });
    broken("nodes[1]: found a cycle of children",
           [](Model& m) { m["nodes"] = {{{"mesh", 0}}, {{"children", {2}}}, {{"children", {1}}}}; });
    broken("extensionsRequired[0]: found 'KHR_draco_point_compression'",
           [](Model& m) { m["extensionsRequired"] = {"KHR_draco_point_compression"}; });
    broken("bufferViews[0].extensions.EXT_meshopt_compression: found no member 'buffer'",
           [](Model& m) { m["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = json::object(); });
    broken("asset.version: found '1.0'", [](Model& m) { m["asset"]["version"] = "1.0"; });
    broken("meshes[0]: found no member 'primitives'", [](Model& m) { m["meshes"][0].erase("primitives"); });
    broken("nodes[0].rotation: found an array of 3, expected 4 numbers",
           [](Model& m) { m["nodes"][0]["rotation"] = {0, 0, 1}; });
}

TEST_F(Gltf, LeavesFacesOfMissingVerticesOut) {
    Model model = quad();
    model.indices({0, 1, 2, 0, 2, 77});
    const Scene scene = import(model.text());
    EXPECT_EQ(scene.triangle_count(), 1u);
    ASSERT_EQ(scene.warnings.size(), 2u);
    EXPECT_NE(scene.warnings[0].find("meshes[0].primitives[0]: found the index 77 at position 5"), std::string::npos)
        << scene.warnings[0];
}

}  // namespace
}  // namespace clarity::test
