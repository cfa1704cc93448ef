// mtl_test.cpp -- what becomes of the materials of OBJ files.
#include <cmath>

#include "mesh_files.hpp"

namespace clarity::test {
namespace {

class Mtl : public MeshFiles {
 protected:
    // A square of material `a`.
    Scene square_of(const std::string& statements) {
        folder_.write("m.mtl", "newmtl a\n" + statements + "\n");
        return import("a.obj", "mtllib m.mtl\n" + kSquare + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3 4/4\n");
    }
    MaterialValues values_of(const std::string& statements) {
        const Scene scene = square_of(statements);
        EXPECT_TRUE(scene.warnings.empty()) << statements << ": " << scene.warnings.at(0);
        return scene.materials.back().values;
    }
};

// A picture of two texels: PNM.
std::string two_texels() {
    return std::string("P6\n2 1\n255\n") + std::string("\xFF\0\0\0\xFF\0", 6);
}

TEST_F(Mtl, OptionsAreObeyedOrNamed) {
    folder_.write("four.ppm", two_texels());
    folder_.write("4 wood#1 four.ppm", two_texels());
    const std::string mesh = "mtllib m.mtl\n" + kSquare + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n";
    const auto with_map = [&](const std::string& statement) {
        folder_.write("m.mtl", "newmtl m\nKd 1 1 1\n" + statement + "\n");
        return import("a.obj", mesh);
    };
    const auto corner = [](const Scene& scene) {  // uv of (1, 1) on the picture of the colour
        const rt_u32 map = scene.materials.back().maps[RT_MAP_COLOR];
        const rt_map plain{{1, 0, 0, 0, 1, 0}, 0, 0, 1, 0};
        const float* const m = map == RT_NONE ? plain.matrix : scene.maps[map].matrix;
        for (size_t v = 0; v < scene.positions.size() / 3; ++v)
            if (scene.positions[3 * v] == 1 && scene.positions[3 * v + 1] == 1)
                return std::pair<float, float>(m[0] * scene.uvs[2 * v] + m[2], m[4] * scene.uvs[2 * v + 1] + m[5]);
        return std::pair<float, float>(-9, -9);
    };
    using Uv = std::pair<float, float>;
    for (const char* silent :
         {"map_Kd four.ppm", "map_kd \"four.ppm\"", "map_Kd .\\four.ppm \t", "map_Kd 4 wood#1 four.ppm",
          "map_Kd -s 1 1 1 4 wood#1 four.ppm", "map_Kd -o 0 0 4 wood#1 four.ppm", "map_Kd four.ppm # a comment",
          "map_Kd -blendu on -blendv on -mm 0 1.0 -bm 1.000 -cc off four.ppm", "map_Kd C:\\textures\\four.ppm"}) {
        const Scene scene = with_map(silent);
        EXPECT_EQ(scene.textures.size(), 1u) << silent;
        EXPECT_EQ(corner(scene), Uv(1, 1)) << silent;
        EXPECT_TRUE(scene.warnings.empty()) << silent << ": " << scene.warnings[0];
    }
    EXPECT_EQ(corner(with_map("map_Kd -s 2 3 1 four.ppm")), Uv(2, 3));
    EXPECT_EQ(corner(with_map("map_Kd -s -2.000000 four.ppm")), Uv(-2, 1));
    EXPECT_EQ(corner(with_map("map_Kd -o 0.5 0.25 -s 4 4 4 four.ppm")), Uv(4.5f, 4.25f));
    for (const char* option : {"-mm 0.5 2", "-imfchan r", "-type cube_top", "-bm 2", "-texres 512", "-t 1 1 1", "-boost 2.5",
                               "-cc on", "-blendu off"}) {
        const Scene scene = with_map("map_Kd " + std::string(option) + " four.ppm");
        const std::string word = std::string(option).substr(0, std::string(option).find(' '));
        EXPECT_EQ(scene.textures.size(), 1u) << option;
        EXPECT_TRUE(warns(scene, "map_Kd " + word)) << option;
    }
    const Scene halo = with_map("d -halo 0.25");
    EXPECT_TRUE(warns(halo, "d -halo"));
    EXPECT_EQ(halo.materials.back().values.alpha, RT_ALPHA_BLEND);
    EXPECT_FLOAT_EQ(halo.materials.back().values.opacity, 0.25f);
}

// Without glass (illum 4, 6, 7, 9) `d` is the share that is there. A map_d of the same picture means its alpha.
TEST_F(Mtl, SaysHowMuchIsThere) {
    folder_.write("four.ppm", two_texels());
    EXPECT_EQ(values_of("d 1").alpha, RT_ALPHA_OPAQUE);
    EXPECT_EQ(values_of("Tr 0.75").alpha, RT_ALPHA_BLEND);
    EXPECT_FLOAT_EQ(values_of("Tr 0.75").opacity, 0.25f);
    EXPECT_EQ(values_of("illum 6\nNi 1.4\nd 0.25").alpha, RT_ALPHA_OPAQUE);
    EXPECT_FLOAT_EQ(values_of("illum 6\nNi 1.4\nd 0.25").refract, 0.75f);
    EXPECT_FLOAT_EQ(values_of("illum 6\nNi 1.4\nTr 0.75").refract, 0.75f);
    EXPECT_FLOAT_EQ(values_of("illum 6\nTr 0\nKd .1 .1 .1").refract, 0.9f) << "glass without an opacity is clear";
    EXPECT_FLOAT_EQ(values_of("illum 6\nTr 0.1\nd 0.25").refract, 0.75f) << "d counts more";
    const Scene cut = square_of("map_Kd four.ppm\nmap_d four.ppm");
    EXPECT_TRUE(cut.warnings.empty()) << cut.warnings.at(0);
    EXPECT_EQ(cut.materials.back().values.alpha, RT_ALPHA_BLEND);
    EXPECT_EQ(cut.materials.back().values.opacity, 1);
    folder_.write("hole.ppm", two_texels());
    const Scene other = square_of("map_Kd four.ppm\nmap_d hole.ppm");
    EXPECT_TRUE(other.warnings.empty()) << other.warnings.at(0);
    EXPECT_EQ(other.materials.back().values.alpha, RT_ALPHA_BLEND);
    EXPECT_NE(other.materials.back().maps[RT_MAP_OPACITY], RT_NONE);
    EXPECT_EQ(cut.materials.back().maps[RT_MAP_OPACITY], RT_NONE) << "the alpha of the colour's picture";
    const Scene glass = square_of("illum 6\nd .5\nmap_Kd four.ppm\nmap_d hole.ppm");
    EXPECT_TRUE(warns(glass, "'a': left out map_d"));
    EXPECT_EQ(glass.materials.back().maps[RT_MAP_OPACITY], RT_NONE);
}

TEST_F(Mtl, HasMapsOfOtherUses) {
    folder_.write("four.ppm", two_texels());
    folder_.write("grey.ppm", std::string("P6\n4 1\n255\n") + std::string("\0\0\0\x80\x80\x80\xFF\xFF\xFF\x80\x80\x80", 12));
    const Scene glowing = square_of("Ke 0 0 0\nmap_Ke -s 2 2 four.ppm");
    const Material& glows = glowing.materials.back();
    EXPECT_EQ(glows.values.emission[0], 1);
    ASSERT_NE(glows.maps[RT_MAP_EMISSION], RT_NONE);
    EXPECT_EQ(glowing.maps[glows.maps[RT_MAP_EMISSION]].matrix[0], 2);
    const Scene normal = square_of("norm four.ppm");
    EXPECT_EQ(normal.textures[normal.maps[normal.materials.back().maps[RT_MAP_NORMAL]].texture].flags, RT_TEXTURE_LINEAR);
    EXPECT_EQ(normal.texels[0] & 0xffffffu, 0x0000ffu) << "as the file has it";
    const Scene bumped = square_of("map_Bump -bm 0.5 grey.ppm");
    EXPECT_TRUE(bumped.warnings.empty()) << bumped.warnings.at(0);
    const rt_map& bump = bumped.maps[bumped.materials.back().maps[RT_MAP_NORMAL]];
    EXPECT_EQ(bump.scale, 0.5f);
    // Heights 0, 1/2, 1, 1/2 along u: it rises at the second texel, by 1 over two texels, and falls at the fourth. A fiftieth
    // of 4 texels is 0.08: the slope is 0.04.
    const auto x = [&](size_t i) { return 2 * double(bumped.texels[i] & 255u) / 255 - 1; };
    EXPECT_NEAR(x(0), 0, 0.005);
    EXPECT_NEAR(x(1), -0.04, 0.005);
    EXPECT_NEAR(x(3), 0.04, 0.005);
    EXPECT_EQ(bumped.texels[1] >> 16 & 255u, 255u) << "z";
    EXPECT_EQ(square_of("bump four.ppm").texels[0] & 0xffffffu, 0x0000ffu) << "of other colours it is a map of normals already";
}

TEST_F(Mtl, MovesThePictureOfItsOwnFaces) {
    folder_.write("four.ppm", two_texels());
    folder_.write("m.mtl", "newmtl a\nmap_Kd -s 2 2 2 four.ppm\nnewmtl b\nmap_Kd -clamp on four.ppm\n");
    const Scene scene =
        import("a.obj", "mtllib m.mtl\n" + kSquare +
                            "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 3/3 4/4\n");
    ASSERT_EQ(scene.triangle_count(), 2u);
    EXPECT_EQ(scene.triangles[2], scene.triangles[4]) << "the same corner in both";
    ASSERT_EQ(scene.maps.size(), 1u);
    EXPECT_EQ(scene.maps[0].matrix[0], 2);
    EXPECT_EQ(scene.materials[scene.triangle_materials[0]].maps[RT_MAP_COLOR], 0u);
    EXPECT_NE(scene.materials[scene.triangle_materials[1]].values.texture, RT_NONE);
}

// The words of physically based rendering, each with its key of the host, and a value that is not its default.
TEST_F(Mtl, SurfacesOfPhysicallyBasedRendering) {
    const MaterialValues m = values_of("Kd .5 .4 .3\nNs 10\nNi 1.4\nPr .3\nPm .6\nPs .2\nPc .7\nPcr .15\naniso .8\nanisor .25");
    EXPECT_EQ(m.model, RT_MODEL_GLTF);
    EXPECT_FLOAT_EQ(m.color[1], 0.4f);
    EXPECT_FLOAT_EQ(m.ior, 1.4f);
    EXPECT_FLOAT_EQ(m.roughness, 0.3f);
    EXPECT_FLOAT_EQ(m.layers.metallic, 0.6f);
    EXPECT_FLOAT_EQ(m.layers.sheen_color[2], 0.2f);
    EXPECT_FLOAT_EQ(m.layers.clearcoat, 0.7f);
    EXPECT_FLOAT_EQ(m.layers.clearcoat_roughness, 0.15f);
    EXPECT_FLOAT_EQ(m.layers.anisotropy, 0.8f);
    EXPECT_FLOAT_EQ(m.layers.anisotropy_rotation, 90);
    EXPECT_EQ(m.layers.transmission, 0) << "there is no Tf";
    const MaterialValues metal = values_of("pm 1");
    EXPECT_EQ(metal.model, RT_MODEL_GLTF);
    EXPECT_EQ(metal.layers.clearcoat, 0);
    EXPECT_NEAR(values_of("Pm 1\nNs 198").roughness, std::pow(0.01, 0.25), 1e-5) << "of Blinn's exponent";
    EXPECT_EQ(values_of("Kd 1 1 1\nNs 198").model, RT_MODEL_WHITTED);
}

TEST_F(Mtl, GlassAndCutsOfPhysicallyBasedRendering) {
    const MaterialValues glass = values_of("Pr 0\nTf .6 .6 .6\nillum 2\nd 1");
    EXPECT_FLOAT_EQ(glass.layers.transmission, 0.6f);
    EXPECT_TRUE(glass.layers.flags & RT_LAYERS_SOLID);
    EXPECT_EQ(glass.alpha, RT_ALPHA_OPAQUE);
    const MaterialValues cut = values_of("Pr .5\nTf 0 0 0\nillum 9\nd .25");
    EXPECT_EQ(cut.alpha, RT_ALPHA_BLEND);
    EXPECT_FLOAT_EQ(cut.opacity, 0.25f);
    EXPECT_EQ(cut.layers.transmission, 0);
}

// The number beside a map means nothing.
TEST_F(Mtl, MapsOfPhysicallyBasedRendering) {
    folder_.write("four.ppm", two_texels());
    const std::pair<const char*, rt_u32> kWords[] = {{"map_Pr", RT_MAP_ROUGHNESS},
                                                     {"map_Pm", RT_MAP_METALLIC},
                                                     {"map_Ps", RT_MAP_SHEEN_COLOR},
                                                     {"map_Pc", RT_MAP_CLEARCOAT},
                                                     {"map_Pcr", RT_MAP_CLEARCOAT_ROUGHNESS},
                                                     {"map_Tf", RT_MAP_TRANSMISSION}};
    for (const auto& [word, use] : kWords) {
        const Scene scene = square_of("Pm 0\nPr 0\n" + std::string(word) + " -s 2 2 four.ppm");
        EXPECT_TRUE(scene.warnings.empty()) << word << ": " << scene.warnings.at(0);
        const rt_u32 map = scene.materials.back().maps[use];
        ASSERT_NE(map, RT_NONE) << word;
        EXPECT_EQ(scene.maps[map].matrix[0], 2) << word;
        EXPECT_EQ(scene.textures[scene.maps[map].texture].flags & RT_TEXTURE_LINEAR, RT_TEXTURE_LINEAR) << word;
    }
    folder_.write("m.mtl", "");
    const Scene both = square_of("Pm 0\nmap_Pm four.ppm\nPr .2\nmap_Pr four.ppm");
    EXPECT_TRUE(square_of("Pr .2\nKs .5 .5 .5").warnings.empty());
    EXPECT_TRUE(warns(square_of("Pr .2\nKs 1 .5 .5\nillum 9"), "'a': left out Ks, illum"));
    EXPECT_EQ(both.materials.back().values.layers.metallic, 1);
    EXPECT_EQ(both.materials.back().values.roughness, 1);
    EXPECT_EQ(both.textures.size(), 1u) << "one picture";
}

// Wavefront's models: 0 is the colour as it is.
TEST_F(Mtl, ModelsOfIllumination) {
    EXPECT_EQ(values_of("Kd .2 .2 .2\nillum 0").model, RT_MODEL_UNLIT);
    EXPECT_EQ(values_of("Ks .5 .5 .5\nillum 1").specular[0], 0);
    EXPECT_EQ(values_of("Ks .5 .5 .5\nillum 2").specular[0], 0.5f);
    for (const char* mirror : {"3", "5", "8"}) EXPECT_EQ(values_of("Ks .5 .5 .5\nillum " + std::string(mirror)).reflect, 0.5f);
    for (const char* glass : {"4", "6", "7", "9"})
        EXPECT_FLOAT_EQ(values_of("Ks .5 .5 .5\nd .5\nillum " + std::string(glass)).refract, 0.5f);
    EXPECT_TRUE(warns(square_of("illum 10"), "'a': left out illum"));
}

// A strength of 1 is a reflectance of 0.08 straight on: that of glTF's plain surface, 0.04, times weight and colour.
TEST_F(Mtl, HighlightsAreReflections) {
    folder_.write("four.ppm", two_texels());
    const MaterialValues plastic = values_of("Ks .5 .5 .5\nNs 98\nillum 2");
    EXPECT_EQ(plastic.model, RT_MODEL_GLTF);
    EXPECT_FLOAT_EQ(plastic.roughness, std::sqrt(std::sqrt(2 / 100.0f)));
    EXPECT_EQ(plastic.ior, 1.5f);
    EXPECT_EQ(plastic.layers.metallic, 0);
    EXPECT_FLOAT_EQ(plastic.layers.specular_weight, 1);
    EXPECT_FLOAT_EQ(plastic.layers.specular_color[1], 1);
    EXPECT_EQ(plastic.specular[1], 0.5f) << "Whitted's highlight is that of the file";
    EXPECT_EQ(plastic.shininess, 98);
    EXPECT_EQ(plastic.reflect, 0);
    const MaterialValues weak = values_of("Ks .25 .125 0"), strong = values_of("Ks 1 .5 .5");
    EXPECT_FLOAT_EQ(weak.layers.specular_weight, 0.5f);
    for (size_t k = 0; k < 3; ++k) EXPECT_FLOAT_EQ(weak.layers.specular_color[k], (std::array{1.0f, 0.5f, 0.0f}[k]));
    EXPECT_FLOAT_EQ(strong.layers.specular_weight, 1);
    EXPECT_FLOAT_EQ(strong.layers.specular_color[0], 2);
    for (const char* dull : {"Ks 0 0 0\nillum 2", "Ks .5 .5 .5\nillum 1", "Ks .5 .5 .5\nillum 3", "Ks .5 .5 .5\nd .5\nillum 4"})
        EXPECT_EQ(values_of(dull).model, RT_MODEL_WHITTED) << dull;
    const Scene mapped = square_of("map_Ks -s 2 2 four.ppm\nNs 30");
    EXPECT_TRUE(mapped.warnings.empty()) << mapped.warnings[0];
    const Material& m = mapped.materials.back();
    EXPECT_EQ(m.values.specular[0], 1) << "the picture is the strength";
    ASSERT_NE(m.maps[RT_MAP_SPECULAR_COLOR], RT_NONE);
    EXPECT_EQ(mapped.maps[m.maps[RT_MAP_SPECULAR_COLOR]].matrix[0], 2);
    EXPECT_EQ(mapped.textures[mapped.maps[m.maps[RT_MAP_SPECULAR_COLOR]].texture].flags, 0u) << "a colour";
}

// A filter has a hue in clear glass alone; elsewhere that is said. A grey one means nothing, as programs write it beside all.
TEST_F(Mtl, HuesOfFiltersAreShownOrNamed) {
    folder_.write("four.ppm", two_texels());
    const MaterialValues glass = values_of("illum 6\nKd .1 .1 .1\nTf 1 .2 .1");
    EXPECT_FLOAT_EQ(glass.color[1], 0.2f);
    for (const char* lost : {"Tf 1 .2 .1", "illum 2\nd .5\nTf 1 .2 .1", "illum 6\nd .5\nTf 1 .2 .1", "Pr .1\nTf 1 .2 .1"}) {
        const Scene scene = square_of(lost);
        EXPECT_EQ(scene.warnings.size(), 1u) << lost;
        EXPECT_TRUE(warns(scene, "'a': left out hue of Tf")) << lost;
    }
    EXPECT_EQ(values_of("illum 2\nd .5\nTf .5 .5 .5").opacity, 0.5f);
    EXPECT_TRUE(warns(square_of("map_Tf four.ppm"), "'a': left out map_Tf"));
}

// One warning for each material that is used, whatever its number of statements.
TEST_F(Mtl, WhatIsLeftOutIsOneWarningForEachMaterial) {
    folder_.write(
        "m.mtl",
        "newmtl a\nKa 1 1 1\nKs 1 1 1\nillum 3\nmap_Ks x.png\ndisp y.png\nsharpness 60\nnewmtl b\nKm .5\nmap_Ns -mm 0 2 z.png\n"
        "newmtl c\nfoo 1\nnewmtl d\nKd 1 1 1\n");
    const Scene scene =
        import("a.obj", "mtllib m.mtl\n" + kSquare + "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl d\nf 1 3 4\n");
    ASSERT_EQ(scene.warnings.size(), 2u);
    EXPECT_TRUE(warns(scene, "material 'a': left out disp, map_Ks")) << scene.warnings[0];
    EXPECT_TRUE(warns(scene, "material 'b': left out Km, map_Ns")) << scene.warnings[1];
}

}  // namespace
}  // namespace clarity::test
