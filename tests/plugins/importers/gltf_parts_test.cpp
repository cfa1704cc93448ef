// gltf_parts_test.cpp -- one wrong part of a file costs that part, with a warning of its place, and the rest is read.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "base/error.hpp"
#include "gltf_model.hpp"
#include "import/import.hpp"
#include "measure.hpp"
#include "support/errors.hpp"

namespace clarity::test {
namespace {

// A picture of two by two texels, as TGA: red, green / blue, white from the top left.
std::string four_texels() {
    std::string tga = {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2, 0, 24, 0x20};
    return tga + std::string("\x00\x00\xff\x00\xff\x00\xff\x00\x00\xff\xff\xff", 12);
}

// The square with a material that has everything, a camera and a light.
Model rich() {
    Model model = quad();
    model.indices({0, 1, 3, 0, 3, 2});
    model.primitive()["attributes"]["NORMAL"] =
        model.add(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 5126, 3);
    model.primitive()["attributes"]["TEXCOORD_0"] = model.add(std::vector<float>{0, 1, 1, 1, 0, 0, 1, 0}, "VEC2", 5126, 2);
    model.primitive()["material"] = 0;
    model["images"] = {{{"uri", "data:image/tga;base64," + base64(four_texels())}}};
    model["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}}};
    model["textures"] = {{{"source", 0}, {"sampler", 0}}};
    model["materials"] = {
        {{"name", "paint"},
         {"emissiveFactor", {0.5, 0.25, 0}},
         {"pbrMetallicRoughness",
          {{"baseColorFactor", {0.5, 0.5, 0.5, 1}}, {"baseColorTexture", {{"index", 0}}}, {"metallicFactor", 0}}}}};
    model["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}}};
    model["extensions"] = {{"KHR_lights_punctual", {{"lights", {{{"type", "point"}}}}}}};
    model["nodes"] = {{{"mesh", 0}}, {{"camera", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}}};
    model["scenes"][0]["nodes"] = {0, 1};
    return model;
}

class GltfParts : public testing::Test {
 protected:
    Scene import(Model& model) { return import_file(folder_.write("model.gltf", model.text())); }
    // The scene after an edit, which has a warning with these words.
    Scene spared(const std::string& warning, const std::function<void(Model&)>& edit) {
        SCOPED_TRACE(warning);
        Model model = rich();
        edit(model);
        try {
            const Scene scene = import(model);
            EXPECT_EQ(scene.placed_triangle_count(), 2u);
            EXPECT_NEAR(scene.surface_area(), 1, 1e-6);
            EXPECT_TRUE(has_warning(scene, warning)) << (scene.warnings.empty() ? "no warning" : scene.warnings[0]);
            return scene;
        } catch (const Error& error) {
            ADD_FAILURE() << error.what();
            return {};
        }
    }
    static bool has_warning(const Scene& scene, const std::string& part) {
        return std::any_of(scene.warnings.begin(), scene.warnings.end(),
                           [&](const std::string& warning) { return warning.find(part) != std::string::npos; });
    }
    Scratch folder_;
};

TEST_F(GltfParts, AreAllReadWhereNothingIsWrong) {
    Model model = rich();
    model["extensionsUsed"] = {"KHR_materials_nobody_knows", "KHR_lights_punctual"};
    model["extras"] = 5;
    model["materials"][0]["extensions"]["KHR_materials_nobody_knows"] = {{"factor", "often"}};
    model["materials"][0]["extras"] = "x";
    const Scene scene = import(model);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("material 'paint': left out KHR_materials_nobody_knows"), std::string::npos);
    EXPECT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.lights.size(), 1u);
    ASSERT_EQ(scene.textures.size(), 1u);
    EXPECT_EQ(scene.textures[0].wrap, RT_WRAP_CLAMP + RT_WRAP_ALONG_V * RT_WRAP_MIRROR);
    EXPECT_FALSE(scene.normals.empty());
    EXPECT_FALSE(scene.uvs.empty());
}

TEST_F(GltfParts, CostCamerasAndLights) {
    EXPECT_TRUE(
        spared("nodes[1].camera: found 3, expected the index of one of 1 cameras; the camera is left out", [](Model& m) {
            m["nodes"][1]["camera"] = 3;
        }).cameras.empty());
    EXPECT_TRUE(spared("cameras[0].perspective.yfov: found 'wide', expected a number; the camera", [](Model& m) {
                    m["cameras"][0]["perspective"]["yfov"] = "wide";
                }).cameras.empty());
    const Scene dark = spared(
        "extensions.KHR_lights_punctual.lights[0].type: found 'area', expected 'directional', 'point' or "
        "'spot'; the light is left out",
        [](Model& m) { m["extensions"]["KHR_lights_punctual"]["lights"][0]["type"] = "area"; });
    EXPECT_TRUE(dark.lights.empty());
    EXPECT_EQ(dark.cameras.size(), 1u);
    EXPECT_TRUE(spared("light: found 1, expected the index of one of 1", [](Model& m) {
                    m["nodes"][1]["extensions"]["KHR_lights_punctual"]["light"] = 1;
                }).lights.empty());
    EXPECT_TRUE(spared("color: found an array of 2, expected 3 numbers", [](Model& m) {
                    m["extensions"]["KHR_lights_punctual"]["lights"][0]["color"] = {1, 1};
                }).lights.empty());
}

TEST_F(GltfParts, CostValuesOfMaterials) {
    const Scene plain = spared("baseColorFactor: found an array of 3, expected 4 numbers; the material keeps the default there",
                               [](Model& m) { m["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {1, 0, 0}; });
    ASSERT_EQ(plain.materials.size(), 2u);
    EXPECT_EQ(plain.materials[1].values.color[0], 1);
    EXPECT_EQ(plain.materials[1].values.emission[0], 0.5f) << "the rest of it";
    EXPECT_NE(plain.materials[1].values.texture, RT_NONE);
    spared("emissiveFactor: found 'much', expected an array", [](Model& m) { m["materials"][0]["emissiveFactor"] = "much"; });
    spared("metallicFactor: found null, expected a number",
           [](Model& m) { m["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] = nullptr; });
    const Scene none = spared(
        "meshes[0].primitives[0].material: found 4, expected the index of one of 1 materials; it gets the "
        "default material",
        [](Model& m) { m.primitive()["material"] = 4; });
    ASSERT_FALSE(none.triangle_materials.empty());
    EXPECT_EQ(none.triangle_materials[0], 0u);
}

TEST_F(GltfParts, CostTexturesAndImages) {
    const auto texture_of = [](const Scene& scene) { return scene.materials.at(1).values.texture; };
    EXPECT_EQ(texture_of(spared("baseColorTexture.index: found 9, expected the index of one of 1 textures",
                                [](Model& m) { m["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 9; })),
              RT_NONE);
    EXPECT_EQ(texture_of(spared("images[0]: found no member 'uri', expected it there; the image is left out",
                                [](Model& m) { m["images"][0] = json::object(); })),
              RT_NONE);
    EXPECT_EQ(texture_of(spared("at character 23, expected base64; the image is left out",
                                [](Model& m) { m["images"][0]["uri"] = "data:image/png;base64,A!BC"; })),
              RT_NONE);
    EXPECT_EQ(texture_of(spared("'gone.png'", [](Model& m) { m["images"][0]["uri"] = "gone.png"; })), RT_NONE);
    EXPECT_EQ(texture_of(spared("images[0].bufferView: found 44", [](Model& m) { m["images"][0] = {{"bufferView", 44}}; })),
              RT_NONE);
    EXPECT_EQ(texture_of(spared("left out baseColorTexture (its picture is of KHR_texture_basisu alone)",
                                [](Model& m) {
                                    m["textures"][0].erase("source");
                                    m["textures"][0]["extensions"] = {{"KHR_texture_basisu", {{"source", 0}}}};
                                })),
              RT_NONE);
    const Scene wrong = spared(
        "samplers[0].wrapT: found 7, expected 10497 (repeat), 33071 (clamp to edge) or 33648 (mirrored "
        "repeat); the texture repeats",
        [](Model& m) { m["samplers"][0]["wrapT"] = 7; });
    EXPECT_NE(texture_of(wrong), RT_NONE);
    spared("textures[0].sampler: found 2, expected the index of one of 1 samplers",
           [](Model& m) { m["textures"][0]["sampler"] = 2; });
}

TEST_F(GltfParts, CostNormalsAndTextureCoordinates) {
    EXPECT_TRUE(
        spared("attributes.NORMAL: found 99", [](Model& m) { m.primitive()["attributes"]["NORMAL"] = 99; }).normals.empty());
    EXPECT_FALSE(
        spared("attributes: the material names TEXCOORD_3, which is missing; TEXCOORD_0 takes its place", [](Model& m) {
            m["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 3;
        }).uvs.empty());
    EXPECT_TRUE(spared("; the texture coordinates are left out", [](Model& m) { m["accessors"][3]["count"] = 3; }).uvs.empty());
}

TEST_F(GltfParts, CostListsThatAreNone) {
    for (const char* name : {"cameras", "animations", "textures", "images", "samplers"})
        spared(std::string(name) + ": found an object, expected an array; it counts as empty",
               [&](Model& m) { m[name] = json::object(); });
    EXPECT_EQ(spared("materials: found 5, expected an array", [](Model& m) { m["materials"] = 5; }).triangle_materials[0], 0u);
    spared("extensions.KHR_lights_punctual.lights: found null, expected an array; the light is left out",
           [](Model& m) { m["extensions"]["KHR_lights_punctual"]["lights"] = nullptr; });
}

// What nothing uses is not looked at; names are only names.
TEST_F(GltfParts, ThatNothingUsesAreIgnored) {
    Model model = rich();
    model["accessors"].push_back({{"bufferView", 1000}, {"componentType", 1}, {"count", -4}, {"type", "VEC9"}});
    model["bufferViews"].push_back({{"buffer", 7}, {"byteLength", "long"}});
    model["skins"] = {{{"joints", {55}}}};
    model["images"].push_back({{"uri", "gone.png"}});
    model["textures"].push_back({{"source", 44}});
    model["materials"].push_back({{"pbrMetallicRoughness", 5}});
    model["cameras"].push_back(17);
    model["meshes"].push_back({{"name", 5}});
    model["nodes"][0]["name"] = 12;
    const Scene scene = import(model);
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
    EXPECT_EQ(scene.placed_triangle_count(), 2u);
}

TEST_F(GltfParts, AStrideOfZeroIsPacked) {
    Model model = rich();
    for (json& view : model["bufferViews"]) view["byteStride"] = 0;
    const Scene scene = import(model);
    EXPECT_NEAR(scene.surface_area(), 1, 1e-6);
    EXPECT_TRUE(has_warning(scene, "bufferViews[0].byteStride: found 0, expected 12 or more")) << scene.warnings.at(0);
    EXPECT_EQ(scene.warnings.size(), 4u) << "one for each view";
}

TEST_F(GltfParts, AlphaCountsAsItsModeSays) {
    const auto read = [&](const std::function<void(json&)>& edit) {
        Model model = rich();
        edit(model["materials"][0]);
        model["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 0.75};
        const Scene scene = import(model);
        EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.at(0);
        return scene.materials.back().values;
    };
    EXPECT_EQ(read([](json&) {}).alpha, RT_ALPHA_OPAQUE);
    EXPECT_EQ(read([](json& m) { m["alphaMode"] = "OPAQUE"; }).alpha, RT_ALPHA_OPAQUE);
    const rt_material mask = read([](json& m) { m["alphaMode"] = "MASK"; });
    EXPECT_EQ(mask.alpha, RT_ALPHA_MASK);
    EXPECT_EQ(mask.opacity, 0.75f);
    EXPECT_EQ(mask.cutoff, 0.5f);
    EXPECT_EQ(read([](json& m) { m["alphaMode"] = "MASK", m["alphaCutoff"] = 0.25; }).cutoff, 0.25f);
    EXPECT_GT(read([](json& m) { m["alphaMode"] = "MASK", m["alphaCutoff"] = 7; }).cutoff, 1) << "nothing is left";
    const rt_material blend = read([](json& m) { m["alphaMode"] = "BLEND"; });
    EXPECT_EQ(blend.alpha, RT_ALPHA_BLEND);
    EXPECT_EQ(blend.opacity, 0.75f);
    EXPECT_EQ(blend.refract, 0);
    spared("materials[0].alphaMode: found 'GLASS'", [](Model& m) { m["materials"][0]["alphaMode"] = "GLASS"; });
}

// Each property that the importer knows reaches its key, with a value that no default has.
TEST_F(GltfParts, MaterialsHaveTheLayersOfTheirExtensions) {
    const auto read = [&](const std::string& extensions, const std::string& core = "{}") {
        Model model = rich();
        json& m = model["materials"][0];
        m["pbrMetallicRoughness"] = json::parse(core);
        m["extensions"] = json::parse(extensions);
        return import(model).materials.back().values;
    };
    const MaterialValues plain = read("{}");
    EXPECT_EQ(plain.model, RT_MODEL_GLTF);
    EXPECT_EQ(plain.layers.metallic, 1) << "as the specification has it";
    EXPECT_EQ(plain.roughness, 1);
    EXPECT_EQ(plain.ior, 1.5f);
    const MaterialValues core = read("{}", R"({"metallicFactor": 0.25, "roughnessFactor": 0.5})");
    EXPECT_EQ(core.layers.metallic, 0.25f);
    EXPECT_EQ(core.roughness, 0.5f);
    EXPECT_EQ(core.reflect, 0.125f) << "what Whitted's tracers show";
    const MaterialValues gloss =
        read(R"({"KHR_materials_pbrSpecularGlossiness": {"specularFactor": [0.04, 0.02, 0.5], "glossinessFactor": 0.75}})");
    EXPECT_EQ(gloss.layers.metallic, 0);
    EXPECT_EQ(gloss.roughness, 0.25f);
    for (size_t k = 0; k < 3; ++k) EXPECT_FLOAT_EQ(gloss.layers.specular_color[k], (std::array{1.0f, 0.5f, 12.5f}[k]));
    EXPECT_EQ(read(R"({"KHR_materials_unlit": {}})").model, RT_MODEL_UNLIT);
    EXPECT_EQ(read(R"({"KHR_materials_ior": {"ior": 1.25}})").ior, 1.25f);
    EXPECT_EQ(read(R"({"KHR_materials_ior": {"ior": 0}})").ior, 1e-3f) << "reflects all";
    const MaterialValues glass = read(
        R"({"KHR_materials_transmission": {"transmissionFactor": 0.75}, "KHR_materials_volume": {"thicknessFactor": 1,
            "attenuationDistance": 2, "attenuationColor": [0.5, 1, 0.25]}})");
    EXPECT_EQ(glass.layers.transmission, 0.75f);
    EXPECT_EQ(glass.refract, 0.75f);
    EXPECT_EQ(glass.layers.flags, RT_LAYERS_SOLID);
    EXPECT_FLOAT_EQ(glass.absorption[0], float(std::log(2.0) / 2)) << "half is left after two units";
    EXPECT_EQ(glass.absorption[1], 0);
    EXPECT_FLOAT_EQ(glass.absorption[2], float(std::log(2.0)));
    const rt_layers more = read(R"({"KHR_materials_specular": {"specularFactor": 0.125, "specularColorFactor": [0.5, 2, 0.25]},
        "KHR_materials_clearcoat": {"clearcoatFactor": 0.375, "clearcoatRoughnessFactor": 0.625},
        "KHR_materials_sheen": {"sheenColorFactor": [0.25, 0.5, 0.75], "sheenRoughnessFactor": 0.875},
        "KHR_materials_anisotropy": {"anisotropyStrength": 0.5, "anisotropyRotation": 1},
        "KHR_materials_iridescence": {"iridescenceFactor": 0.75, "iridescenceIor": 1.75, "iridescenceThicknessMinimum": 50,
                                      "iridescenceThicknessMaximum": 250}})")
                               .layers;
    EXPECT_EQ(more.flags, 0u) << "a sheet";
    const float found[] = {more.specular_weight,
                           more.specular_color[1],
                           more.clearcoat,
                           more.clearcoat_roughness,
                           more.sheen_color[2],
                           more.sheen_roughness,
                           more.anisotropy,
                           more.anisotropy_rotation,
                           more.iridescence,
                           more.iridescence_ior,
                           more.iridescence_thickness_min,
                           more.iridescence_thickness};
    const float expected[] = {0.125f, 2, 0.375f, 0.625f, 0.75f, 0.875f, 0.5f, 57.29578f, 0.75f, 1.75f, 50, 250};
    for (size_t i = 0; i < std::size(expected); ++i) EXPECT_FLOAT_EQ(found[i], expected[i]) << i;
    spared("material 'paint': left out EXT_a, EXT_b", [](Model& m) {
        m["materials"][0]["extensions"] = json::parse(R"({"EXT_a": {}, "KHR_materials_sheen": {}, "EXT_b": {}})");
    });
    spared("materials[0].extensions.KHR_materials_clearcoat.clearcoatFactor: found 'much'", [](Model& m) {
        m["materials"][0]["extensions"] = json::parse(R"({"KHR_materials_clearcoat": {"clearcoatFactor": "much"}})");
    });
}

// Specification, section 3.7.2.1: floats or shares of an integer's range, with or without alpha, linear, limited to 0..1.
TEST_F(GltfParts, ColoursOfVerticesAreReadInEveryForm) {
    const auto colors = [&](const std::function<size_t(Model&)>& add) {
        Model model = rich();
        model.primitive()["attributes"]["COLOR_0"] = add(model);
        return import(model).colors.copy();
    };
    const std::vector<float> plain =
        colors([](Model& m) { return m.add(std::vector<float>{1, 0.25f, 0, 2, -1, 0, 0, 0, 0, 0, 0, 1}, "VEC3", 5126, 3); });
    EXPECT_EQ(plain, (std::vector<float>{1, 0.25f, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 1}));
    const auto of_bytes = colors([](Model& m) {
        const size_t at = m.add(std::vector<uint8_t>{255, 51, 0, 102, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 255}, "VEC4", 5121, 4);
        m["accessors"][at]["normalized"] = true;
        return at;
    });
    EXPECT_EQ((std::vector<float>(of_bytes.begin(), of_bytes.begin() + 4)), (std::vector<float>{1, 0.2f, 0, 0.4f}));
    const auto of_words = colors([](Model& m) {
        const size_t at = m.add(std::vector<uint16_t>{13107, 65535, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC4", 5123, 4);
        m["accessors"][at]["normalized"] = true;
        return at;
    });
    EXPECT_EQ((std::vector<float>(of_words.begin(), of_words.begin() + 4)), (std::vector<float>{0.2f, 1, 0, 0}));
    spared("the colours of vertices are left out",
           [](Model& m) { m.primitive()["attributes"]["COLOR_0"] = m.add(std::vector<float>(8, 1), "VEC2", 5126, 2); });
}

// A second primitive without colours keeps those of its material.
TEST_F(GltfParts, VerticesWithoutColoursAreWhite) {
    Model model = rich();
    nlohmann::json other = model.primitive();
    model.primitive()["attributes"]["COLOR_0"] = model.add(std::vector<float>(12, 0.5f), "VEC3", 5126, 3);
    model["meshes"][0]["primitives"].push_back(other);
    const Scene scene = import(model);
    ASSERT_EQ(scene.colors.size(), 32u);
    EXPECT_EQ(scene.colors[0], 0.5f);
    EXPECT_EQ(scene.colors[16], 1);
    EXPECT_EQ(scene.colors[31], 1);
}

// What makes geometry doubtful stays an error.
TEST_F(GltfParts, OfGeometryAreStillRefused) {
    const auto refused = [&](const std::string& part, const std::function<void(Model&)>& edit) {
        Model model = rich();
        edit(model);
        expect_error([&] { import(model); }, {part});
    };
    refused("accessors[0].bufferView: found 90", [](Model& m) { m["accessors"][0]["bufferView"] = 90; });
    refused("bufferViews[0].byteStride: found 4", [](Model& m) { m["bufferViews"][0]["byteStride"] = 4; });
    refused("meshes[0].primitives[0].indices: found 70", [](Model& m) { m.primitive()["indices"] = 70; });
    refused("nodes[0].translation", [](Model& m) { m["nodes"][0]["translation"] = {1, 2}; });
    refused("nodes[0].skin: found 3", [](Model& m) { m["nodes"][0]["skin"] = 3; });
}

TEST_F(GltfParts, TexturesThatDifferInWrapShareTheirPicture) {
    Model model = rich();
    model["samplers"].push_back({{"wrapS", 10497}});
    model["textures"].push_back({{"source", 0}, {"sampler", 1}});
    model["textures"].push_back({{"source", 0}});
    model["textures"].push_back({{"source", 0}, {"sampler", 0}});
    json second = model.primitive();
    for (size_t i = 1; i < 4; ++i) {
        model["materials"].push_back(model["materials"][0]);
        model["materials"][i]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = i;
        second["material"] = i;
        model["meshes"][0]["primitives"].push_back(second);
    }
    const Scene scene = import(model);
    ASSERT_EQ(scene.textures.size(), 2u);
    EXPECT_EQ(scene.textures[0].first, scene.textures[1].first);
    EXPECT_EQ(scene.texels.size(), 5u) << "four, and their mean";
    EXPECT_NE(scene.materials.at(1).values.texture, scene.materials.at(2).values.texture);
    EXPECT_EQ(scene.materials.at(2).values.texture, scene.materials.at(3).values.texture);
    EXPECT_EQ(scene.materials.at(1).values.texture, scene.materials.at(4).values.texture);
}

// ---- URIs

class GltfUri : public GltfParts {
 protected:
    // Whether the square is found in a file of this name that `uri` names.
    void expect_found(const std::string& file, const std::string& uri) {
        Model model = quad();
        model.indices({0, 1, 3, 0, 3, 2});
        json text = json::parse(model.text());
        text["buffers"][0]["uri"] = uri;
        std::filesystem::create_directories(std::filesystem::path(folder_.path(file)).parent_path());
        folder_.write(file, model.bytes());
        try {
            EXPECT_NEAR(import_file(folder_.write("model.gltf", text.dump())).surface_area(), 1, 1e-6) << uri;
        } catch (const Error& error) {
            ADD_FAILURE() << uri << ": " << error.what();
        }
        std::filesystem::remove(folder_.path(file));
    }
};

TEST_F(GltfUri, MayBePercentEncodedOrNot) {
    expect_found("a b.bin", "a%20b.bin");
    expect_found("a b.bin", "a b.bin");
    expect_found("100%.bin", "100%25.bin");
    expect_found("100%.bin", "100%.bin");
    expect_found("a%20b.bin", "a%2520b.bin");
    expect_found("a%20b.bin", "a%20b.bin");
    expect_found("p\xC5\x99\xC3\xADvod.bin", "p%C5%99%C3%ADvod.bin");
    expect_found("p\xC5\x99\xC3\xADvod.bin", "p%c5%99%c3%advod.bin");
    expect_found("p\xC5\x99\xC3\xADvod.bin", "p\xC5\x99\xC3\xADvod.bin");
    expect_found("\xE6\xA8\xA1\xE5\x9E\x8B.bin", "%E6%A8%A1%E5%9E%8B.bin");
    expect_found("parts/one.bin", "parts%2Fone.bin");
    expect_found("parts/one.bin", "./parts/../parts/one.bin");
    expect_found("parts/one.bin", "parts\\one.bin");
    expect_found("a#1+b.bin", "a%231+b.bin");
    expect_found("a#1.bin", "a#1.bin");
    expect_found("one.bin", "one.bin?v=1");
    expect_found("a:b.bin", "a:b.bin");
}

TEST_F(GltfUri, StaysInTheFolder) {
    Model model = quad();
    model.indices({0, 1, 2});
    std::filesystem::create_directories(folder_.path("in"));
    folder_.write("out.bin", model.bytes());
    json text = json::parse(model.text());
    for (const char* uri : {"..%2Fout.bin", "%2e%2e/out.bin", "a/%2E%2E/../out.bin", "..\\out.bin", "%2Fetc%2Fhostname",
                            "file:///etc/hostname", "out%00.bin"}) {
        text["buffers"][0]["uri"] = uri;
        SCOPED_TRACE(uri);
        expect_error([&] { import_file(folder_.write("in/model.gltf", text.dump())); },
                     {"expected the name of a file in the scene's folder"});
    }
}

TEST_F(GltfUri, MayBeDataInManyForms) {
    Model model = quad();
    model.indices({0, 1, 3, 0, 3, 2});
    json text = json::parse(model.text());
    const std::string plain = base64(model.bytes());
    std::string encoded, broken_lines, percent;
    for (size_t i = 0; i < plain.size(); ++i) {
        const char c = plain[i];
        encoded += c == '+' ? "%2B" : c == '/' ? "%2f" : c == '=' ? "%3D" : std::string(1, c);
        broken_lines += c + std::string(i % 20 == 19 ? "\r\n " : "");
    }
    for (const char c : model.bytes()) {
        char code[4];
        std::snprintf(code, sizeof code, "%%%02x", static_cast<unsigned char>(c));
        percent += code;
    }
    for (const std::string& uri : {"data:;base64," + plain, "DATA:application/gltf-buffer;BASE64," + plain,
                                   "data:;base64," + encoded, "data:application/octet-stream;name=ab.bin;base64," + plain,
                                   "data:a/b;charset=x;base64," + broken_lines, "data:application/octet-stream," + percent}) {
        text["buffers"][0]["uri"] = uri;
        try {
            EXPECT_NEAR(import_file(folder_.write("model.gltf", text.dump())).surface_area(), 1, 1e-6) << uri;
        } catch (const Error& error) {
            ADD_FAILURE() << uri.substr(0, 50) << ": " << error.what();
        }
    }
}

TEST_F(GltfUri, OfImagesAreDecodedToo) {
    Model model = rich();
    for (const auto& [file, uri] : std::vector<std::pair<std::string, std::string>>{{"wood 1.tga", "wood%201.tga"},
                                                                                    {"50%.tga", "50%25.tga"},
                                                                                    {"a%20b.tga", "a%20b.tga"},
                                                                                    {"h\xC3\xA4.tga", "h%C3%A4.tga"}}) {
        folder_.write(file, four_texels());
        model["images"][0] = {{"uri", uri}};
        const Scene scene = import(model);
        EXPECT_EQ(scene.textures.size(), 1u) << uri;
        EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
        std::filesystem::remove(folder_.path(file));
    }
}

// Each use has its own texture, set, transform and space; a normal map has its scale.
TEST_F(GltfParts, TexturesOfAllUses) {
    Model model = rich();
    model.primitive()["attributes"]["TEXCOORD_3"] =
        model.add(std::vector<float>{0, 1, 1, 1, 0, 0.5f, 1, 0.5f}, "VEC2", 5126, 2);
    model["samplers"].push_back({{"magFilter", 9728}});
    model["textures"].push_back({{"source", 0}, {"sampler", 1}});
    model["materials"][0]["emissiveTexture"] = {{"index", 0}, {"texCoord", 3}};
    model["materials"][0]["normalTexture"] = {{"index", 1}, {"scale", 0.5}};
    model["materials"][0]["occlusionTexture"] = {
        {"index", 1}, {"strength", 0.25}, {"extensions", {{"KHR_texture_transform", {{"offset", {0.5, 0.25}}}}}}};
    const Scene scene = import(model);
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
    const Material& material = scene.materials.at(1);
    EXPECT_NE(material.values.texture, RT_NONE) << "the colour's texture is plain";
    EXPECT_EQ(material.values.emission[0], 0.5f) << "the texture multiplies the factor";
    const auto map = [&](rt_u32 use) { return scene.maps.at(material.maps[use]); };
    EXPECT_EQ(map(RT_MAP_EMISSION).set, 1u) << "TEXCOORD_3 is the second set that the material uses";
    ASSERT_EQ(scene.uvs2.size(), 8u);
    EXPECT_EQ(scene.uvs2[5], 0.5f);
    EXPECT_EQ(scene.textures[map(RT_MAP_EMISSION).texture].flags, 0u);
    EXPECT_EQ(scene.textures[map(RT_MAP_NORMAL).texture].flags, RT_TEXTURE_LINEAR | RT_TEXTURE_NEAREST);
    EXPECT_EQ(map(RT_MAP_NORMAL).scale, 0.5f);
    EXPECT_EQ(map(RT_MAP_OCCLUSION).scale, 0.25f);
    EXPECT_EQ(map(RT_MAP_OCCLUSION).matrix[2], 0.5f);
    EXPECT_EQ(map(RT_MAP_OCCLUSION).matrix[5], -0.25f) << "v points up";
    EXPECT_EQ(scene.tangents.size(), 6u);
    EXPECT_NE(scene.tangents[0], 0u);
    spared("emissiveTexture.texCoord: found",
           [](Model& m) { m["materials"][0]["emissiveTexture"] = {{"index", 0}, {"texCoord", "x"}}; });
    spared("emissiveTexture.index: found 7", [](Model& m) { m["materials"][0]["emissiveTexture"] = {{"index", 7}}; });
    // Of three sets the third is left out.
    spared("texCoord: found 5, expected one of the 2 sets that a material may use; the first set is taken", [](Model& m) {
        m["materials"][0]["emissiveTexture"] = {{"index", 0}, {"texCoord", 3}};
        m["materials"][0]["normalTexture"] = {{"index", 0}, {"texCoord", 5}};
    });
}

}  // namespace
}  // namespace clarity::test
