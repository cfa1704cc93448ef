// fbx_surface_test.cpp -- physically based materials of FBX files, as Maya, Arnold and 3ds Max write them.
#include <gtest/gtest.h>

#include <cmath>

#include "fbx_model.hpp"

namespace clarity::test {
namespace {

class FbxSurface : public FbxForms {
 protected:
    // A square of a material with these properties, and pictures of these properties.
    Scene square(const std::vector<FbxNode>& properties, const std::vector<std::string>& pictures = {}) {
        folder_.write("dot.ppm", "P6 1 1 255\nabc");
        const FbxNode uvs = node("LayerElementUV", {whole(0)},
                                 {node("MappingInformationType", {text("ByPolygonVertex")}),
                                  node("ReferenceInformationType", {text("Direct")}), node("UV", {Numbers(12, 0.5)})});
        std::vector<FbxNode> objects = {geometry(1, {uvs}), model(2, "A"),
                                        node("Material", {whole(3), text("Material::M"), text("")},
                                             {node("Version", {whole(102)}), node("Properties70", {}, properties)})};
        std::vector<FbxNode> links = {link(2, 0), link(1, 2), link(3, 2)};
        for (const std::string& property : pictures) {
            const int64_t id = 10 + static_cast<int64_t>(objects.size());
            objects.push_back(
                node("Texture", {whole(id), text("Texture::T"), text("")}, {node("FileName", {text("dot.ppm")})}));
            links.push_back(link(id, 3, property));
        }
        return import(objects, links);
    }
};
INSTANTIATE_TEST_SUITE_P(Forms, FbxSurface, kFbxForms, fbx_form_name);

TEST_P(FbxSurface, HighlightsOfPhongAreReflections) {
    const std::vector<FbxNode> phong = {property("DiffuseColor", {0.5, 0.5, 0.5}), property("SpecularColor", {1, 0.5, 0}),
                                        property("SpecularFactor", {0.25}), property("ShininessExponent", {98})};
    const MaterialValues m = square(phong).materials.back().values;
    EXPECT_EQ(m.model, RT_MODEL_GLTF);
    EXPECT_FLOAT_EQ(m.roughness, std::sqrt(std::sqrt(2 / 100.0f)));
    EXPECT_FLOAT_EQ(m.layers.specular_weight, 0.5f);
    for (size_t k = 0; k < 3; ++k) EXPECT_FLOAT_EQ(m.layers.specular_color[k], (std::array{1.0f, 0.5f, 0.0f}[k]));
    EXPECT_FLOAT_EQ(m.specular[1], 0.125f) << "Whitted's highlight is that of the file";
    EXPECT_EQ(m.shininess, 98);
    EXPECT_EQ(square({property("DiffuseColor", {0.5, 0.5, 0.5})}).materials.back().values.model, RT_MODEL_WHITTED);
    std::vector<FbxNode> mirror = phong;
    mirror.push_back(property("ReflectionColor", {1, 1, 1}));
    mirror.push_back(property("ReflectionFactor", {0.5}));
    const Scene mapped = square(phong, {"SpecularColor"}), left_out = square(mirror, {"SpecularColor"});
    EXPECT_TRUE(mapped.warnings.empty()) << mapped.warnings[0];
    EXPECT_NE(mapped.materials.back().maps[RT_MAP_SPECULAR_COLOR], RT_NONE);
    EXPECT_FLOAT_EQ(mapped.materials.back().values.specular[2], 0.25f) << "the picture replaces the colour";
    EXPECT_EQ(left_out.materials.back().values.model, RT_MODEL_WHITTED);
    EXPECT_EQ(left_out.materials.back().maps[RT_MAP_SPECULAR_COLOR], RT_NONE);
    ASSERT_EQ(left_out.warnings.size(), 1u);
    EXPECT_NE(left_out.warnings[0].find("'M': left out SpecularColor"), std::string::npos) << left_out.warnings[0];
}

TEST_P(FbxSurface, StandardSurfaceOfMaya) {
    const Scene scene =
        square({property("Maya|base", {0.5}), property("Maya|baseColor", {0.8, 0.6, 0.4}), property("Maya|specular", {0.7}),
                property("Maya|specularColor", {1, 0.5, 0.25}), property("Maya|specularRoughness", {0.35}),
                property("Maya|specularIOR", {1.6}), property("Maya|specularAnisotropy", {0.4}),
                property("Maya|specularRotation", {0.25}), property("Maya|metalness", {0.9}), property("Maya|coat", {0.3}),
                property("Maya|coatRoughness", {0.15}), property("Maya|sheen", {0.5}), property("Maya|sheenColor", {1, 1, 0.5}),
                property("Maya|sheenRoughness", {0.45}), property("Maya|emission", {2}),
                property("Maya|emissionColor", {1, 0.5, 0}), property("Maya|opacity", {0.25, 0.25, 0.25}),
                property("Maya|thinFilmThickness", {300}), property("Maya|thinFilmIOR", {1.4})});
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.at(0);
    const MaterialValues m = scene.materials.back().values;
    EXPECT_EQ(m.model, RT_MODEL_GLTF);
    EXPECT_FLOAT_EQ(m.color[1], 0.3f);
    EXPECT_FLOAT_EQ(m.layers.specular_weight, 0.7f);
    EXPECT_FLOAT_EQ(m.layers.specular_color[2], 0.25f);
    EXPECT_FLOAT_EQ(m.roughness, 0.35f);
    EXPECT_FLOAT_EQ(m.ior, 1.6f);
    EXPECT_FLOAT_EQ(m.layers.anisotropy, 0.4f);
    EXPECT_FLOAT_EQ(m.layers.anisotropy_rotation, 90);
    EXPECT_FLOAT_EQ(m.layers.metallic, 0.9f);
    EXPECT_FLOAT_EQ(m.layers.clearcoat, 0.3f);
    EXPECT_FLOAT_EQ(m.layers.clearcoat_roughness, 0.15f);
    EXPECT_FLOAT_EQ(m.layers.sheen_color[0], 0.5f);
    EXPECT_FLOAT_EQ(m.layers.sheen_color[2], 0.25f);
    EXPECT_FLOAT_EQ(m.layers.sheen_roughness, 0.45f);
    EXPECT_FLOAT_EQ(m.emission[0], 2);
    EXPECT_FLOAT_EQ(m.emission[1], 1);
    EXPECT_EQ(m.alpha, RT_ALPHA_BLEND);
    EXPECT_FLOAT_EQ(m.opacity, 0.25f);
    EXPECT_FLOAT_EQ(m.layers.iridescence, 1);
    EXPECT_FLOAT_EQ(m.layers.iridescence_thickness, 300);
    EXPECT_FLOAT_EQ(m.layers.iridescence_ior, 1.4f);
}

// The colour of what light goes through is reached after a depth, or else at the surface.
TEST_P(FbxSurface, TransmissionOfStandardSurface) {
    const auto glass = [&](double depth, double thin) {
        return square({property("Maya|baseColor", {1, 1, 1}), property("Maya|transmission", {1}),
                       property("Maya|transmissionColor", {0.5, 1, 1}), property("Maya|transmissionDepth", {depth}),
                       property("Maya|thinWalled", {thin})})
            .materials.back()
            .values;
    };
    const MaterialValues solid = glass(2, 0), sheet = glass(0, 1);
    EXPECT_FLOAT_EQ(solid.layers.transmission, 1);
    EXPECT_TRUE(solid.layers.flags & RT_LAYERS_SOLID);
    EXPECT_NEAR(solid.absorption[0], std::log(2) / 2, 1e-6);
    EXPECT_EQ(solid.absorption[1], 0);
    EXPECT_EQ(solid.color[0], 1);
    EXPECT_FALSE(sheet.layers.flags & RT_LAYERS_SOLID);
    EXPECT_FLOAT_EQ(sheet.color[0], 0.5f);
    EXPECT_EQ(sheet.absorption[0], 0);
}

TEST_P(FbxSurface, PhysicalMaterialOf3dsMax) {
    const std::string of = "3dsMax|Parameters|";
    const MaterialValues m =
        square({property(of + "base_color", {0.2, 0.4, 0.6, 1}), property(of + "base_weight", {1}),
                property(of + "roughness", {0.3}), property(of + "roughness_inv", {1}), property(of + "metalness", {0.5}),
                property(of + "reflectivity", {0.8}), property(of + "trans_ior", {1.7}), property(of + "transparency", {0.6}),
                property(of + "trans_color", {1, 1, 1, 1}), property(of + "coating", {0.4}),
                property(of + "coat_roughness", {0.1}), property(of + "emission", {3}),
                property(of + "emit_color", {0, 1, 0, 1}), property(of + "base_color_map", {0})})
            .materials.back()
            .values;
    EXPECT_EQ(m.model, RT_MODEL_GLTF);
    EXPECT_NEAR(m.color[0], 0.2f + 0.6f * 0.8f, 1e-6);
    EXPECT_FLOAT_EQ(m.roughness, 0.7f);
    EXPECT_FLOAT_EQ(m.layers.metallic, 0.5f);
    EXPECT_FLOAT_EQ(m.layers.specular_weight, 0.8f);
    EXPECT_FLOAT_EQ(m.ior, 1.7f);
    EXPECT_FLOAT_EQ(m.layers.transmission, 0.6f);
    EXPECT_FLOAT_EQ(m.layers.clearcoat, 0.4f);
    EXPECT_FLOAT_EQ(m.layers.clearcoat_roughness, 0.1f);
    EXPECT_FLOAT_EQ(m.emission[1], 3);
}

TEST_P(FbxSurface, GltfMaterialOf3dsMaxHasSwitches) {
    const auto coated = [&](double on) {
        return square({property("3dsMax|main|baseColor", {1, 1, 1, 1}), property("3dsMax|extension|enableClearCoat", {on}),
                       property("3dsMax|extension|clearcoat", {0.9}), property("3dsMax|extension|enableSheen", {on}),
                       property("3dsMax|extension|sheenColor", {0.4, 0.4, 0.4, 1})})
            .materials.back()
            .values.layers;
    };
    EXPECT_FLOAT_EQ(coated(1).clearcoat, 0.9f);
    EXPECT_FLOAT_EQ(coated(1).sheen_color[0], 0.4f);
    EXPECT_EQ(coated(0).clearcoat, 0);
    EXPECT_EQ(coated(0).sheen_color[0], 0);
}

// By the name of the property, whichever program wrote it. The value beside a picture means nothing.
TEST_P(FbxSurface, PicturesByTheirProperties) {
    const std::pair<const char*, rt_u32> kNames[] = {{"Maya|specularRoughness", RT_MAP_ROUGHNESS},
                                                     {"3dsMax|Parameters|roughness_map", RT_MAP_ROUGHNESS},
                                                     {"3dsMax|main|metalnessMap", RT_MAP_METALLIC},
                                                     {"Maya|TEX_metallic_map", RT_MAP_METALLIC},
                                                     {"Maya|normalCamera|file", RT_MAP_NORMAL},
                                                     {"3dsMax|Parameters|bump_map", RT_MAP_NORMAL},
                                                     {"Maya|emissionColor", RT_MAP_EMISSION},
                                                     {"Maya|coat", RT_MAP_CLEARCOAT},
                                                     {"3dsMax|extension|clearcoatNormalMap", RT_MAP_CLEARCOAT_NORMAL},
                                                     {"Maya|transmission", RT_MAP_TRANSMISSION},
                                                     {"3dsMax|Parameters|cutout_map", RT_MAP_OPACITY},
                                                     {"Maya|TEX_ao_map", RT_MAP_OCCLUSION}};
    for (const auto& [name, use] : kNames) {
        const Scene scene = square({property("Maya|baseColor", {1, 1, 1}), property("Maya|emission", {1})}, {name});
        EXPECT_TRUE(scene.warnings.empty()) << name << ": " << scene.warnings.at(0);
        EXPECT_NE(scene.materials.back().maps[use], RT_NONE) << name;
        EXPECT_EQ(scene.textures.size(), 1u) << name;
    }
    const MaterialValues rough =
        square({property("Maya|baseColor", {1, 1, 1}), property("Maya|specularRoughness", {0})}, {"Maya|specularRoughness"})
            .materials.back()
            .values;
    EXPECT_EQ(rough.roughness, 1);
    const Scene colored =
        square({property("3dsMax|Parameters|base_color", {0, 0, 0, 1})}, {"3dsMax|Parameters|base_color_map"});
    EXPECT_EQ(colored.materials.back().values.color[0], 1);
    EXPECT_NE(colored.materials.back().values.texture, RT_NONE);
}

TEST_P(FbxSurface, WhatIsLeftOutIsOneWarning) {
    const Scene scene = square(
        {property("Maya|baseColor", {1, 1, 1}), property("Maya|subsurface", {0.5}), property("Maya|coatAnisotropy", {0})},
        {"Maya|subsurfaceColor", "DisplacementColor"});
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_TRUE(warns_of(scene, "'M': left out Maya|subsurfaceColor, DisplacementColor, subsurface")) << scene.warnings[0];
    const Scene coated =
        square({property("Maya|baseColor", {1, 1, 1}), property("Maya|coat", {1}), property("Maya|coatColor", {1, 0.5, 0.5}),
                property("Maya|coatIOR", {1.8}), property("Maya|opacity", {0.5, 1, 1})});
    ASSERT_EQ(coated.warnings.size(), 1u);
    EXPECT_TRUE(warns_of(coated, "'M': left out hue of opacity, coatcolor, coatior")) << coated.warnings[0];
    const Scene plain = square({property("Maya|baseColor", {1, 1, 1}), property("Maya|coat", {0}),
                                property("Maya|coatColor", {1, 0.5, 0.5}), property("Maya|coatIOR", {1.5})});
    EXPECT_TRUE(plain.warnings.empty()) << plain.warnings.at(0);
    const Scene red = square({property("TransparentColor", {0.5, 0, 0}), property("TransparencyFactor", {1})});
    EXPECT_TRUE(warns_of(red, "'M': left out hue of TransparentColor"));
    EXPECT_TRUE(square({property("DiffuseColor", {1, 1, 1})}).warnings.empty());
}

TEST_P(FbxSurface, BumpsHaveAFactor) {
    const Scene scene = square({property("BumpFactor", {0.25})}, {"Bump"});
    EXPECT_EQ(scene.maps.at(scene.materials.back().maps[RT_MAP_NORMAL]).scale, 0.25f);
}

}  // namespace
}  // namespace clarity::test
