// collada_materials_test.cpp -- the pictures of COLLADA's materials, and what is transparent.
#include <gtest/gtest.h>

#include <cmath>

#include "measure.hpp"

namespace clarity::test {
namespace {

// A square with coordinates, whose effect has these parameters: <emission>, <diffuse>, ... Pictures: dot and other.
Scene square(const Scratch& folder, const std::string& parameters) {
    folder.write("dot.ppm", "P6 1 1 255\nabc");
    folder.write("other.ppm", "P6 1 1 255\nxyz");
    std::string samplers;
    for (const std::string name : {"dot", "other"})
        samplers += "<newparam sid=\"" + name + "-s\"><surface type=\"2D\"><init_from>" + name +
                    "</init_from></surface></newparam><newparam sid=\"" + name + "-t\"><sampler2D><source>" + name +
                    "-s</source></sampler2D></newparam>";
    const auto source = [](const std::string& id, const std::string& numbers, const std::string& params, int stride) {
        std::string out = "<source id=\"" + id + "\"><float_array id=\"" + id + "-a\" count=\"" + std::to_string(4 * stride) +
                          "\">" + numbers + "</float_array><technique_common><accessor source=\"#" + id +
                          "-a\" count=\"4\" stride=\"" + std::to_string(stride) + "\">";
        for (const char c : params) out += std::string("<param name=\"") + c + "\" type=\"float\"/>";
        return out + "</accessor></technique_common></source>";
    };
    return import_file(folder.write(
        "a.dae",
        "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\"><asset/>"
        "<library_images><image id=\"dot\"><init_from>dot.ppm</init_from></image><image id=\"other\"><init_from>other.ppm"
        "</init_from></image></library_images><library_effects><effect id=\"e\"><profile_COMMON>" +
            samplers + "<technique sid=\"t\"><phong>" + parameters +
            "</phong></technique></profile_COMMON></effect></library_effects><library_materials><material id=\"m\" name=\"m\">"
            "<instance_effect url=\"#e\"/></material></library_materials><library_geometries><geometry id=\"g\"><mesh>" +
            source("p", "0 0 0 1 0 0 1 1 0 0 1 0", "XYZ", 3) + source("u", "0 0 1 0 1 1 0 1", "ST", 2) +
            source("w", "5 5 6 5 6 6 5 6", "ST", 2) +
            "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices><polylist material=\"s\" count=\"1\">"
            "<input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><input semantic=\"TEXCOORD\" source=\"#u\" offset=\"0\" "
            "set=\"0\"/><input semantic=\"TEXCOORD\" source=\"#w\" offset=\"0\" set=\"1\"/><vcount>4</vcount><p>0 1 2 "
            "3</p></polylist></mesh></geometry></library_geometries>"
            "<library_visual_scenes><visual_scene id=\"x\"><node id=\"n\"><instance_geometry url=\"#g\"><bind_material>"
            "<technique_common><instance_material symbol=\"s\" target=\"#m\"><bind_vertex_input semantic=\"UV\" "
            "input_semantic=\"TEXCOORD\" input_set=\"0\"/><bind_vertex_input semantic=\"TEX1\" input_semantic=\"TEXCOORD\" "
            "input_set=\"1\"/></instance_material></technique_common></bind_material>"
            "</instance_geometry></node></visual_scene></library_visual_scenes>"
            "<scene><instance_visual_scene url=\"#x\"/></scene></COLLADA>\n"));
}
std::string picture(const std::string& name, const std::string& set = "UV", const std::string& extra = "") {
    return "<texture texture=\"" + name + "-t\" texcoord=\"" + set + "\">" + extra + "</texture>";
}
const std::string kDiffuse = "<diffuse>" + picture("dot") + "</diffuse>";

TEST(ColladaMaterials, HavePicturesOfEmissionAndBumps) {
    NEEDS_IMPORTER("a.dae");
    const Scratch folder;
    const Scene glowing = square(folder, "<emission>" + picture("other") + "</emission>" + kDiffuse);
    EXPECT_TRUE(glowing.warnings.empty()) << glowing.warnings.at(0);
    const Material& glows = glowing.materials.back();
    ASSERT_NE(glows.maps[RT_MAP_EMISSION], RT_NONE);
    EXPECT_EQ(glowing.textures.size(), 2u);
    EXPECT_EQ(glowing.textures[glowing.maps[glows.maps[RT_MAP_EMISSION]].texture].flags & RT_TEXTURE_LINEAR, 0u);
    EXPECT_EQ(glows.values.emission[1], 1);
    EXPECT_EQ(square(folder, kDiffuse).materials.back().values.emission[1], 0);
    const Scene bumped = square(
        folder, kDiffuse + "<extra><technique profile=\"FCOLLADA\"><bump>" + picture("other") + "</bump></technique></extra>");
    const Material& rough = bumped.materials.back();
    ASSERT_NE(rough.maps[RT_MAP_NORMAL], RT_NONE);
    EXPECT_EQ(bumped.textures[bumped.maps[rough.maps[RT_MAP_NORMAL]].texture].flags, RT_TEXTURE_LINEAR);
}

// COLLADA 1.5.0, "transparent": A_ONE is the alpha of a colour or picture, RGB_ONE their brightness, RGB_ZERO one minus that.
TEST(ColladaMaterials, AreAsTransparentAsTheySay) {
    NEEDS_IMPORTER("a.dae");
    const Scratch folder;
    const auto clear = [&](const std::string& opaque, const std::string& of, const std::string& transparency) {
        return square(folder, kDiffuse + "<transparent opaque=\"" + opaque + "\">" + of +
                                  "</transparent><transparency><float>" + transparency + "</float></transparency>");
    };
    const auto values = [&](const std::string& opaque, const std::string& color, const std::string& transparency) {
        return clear(opaque, "<color>" + color + "</color>", transparency).materials.back().values;
    };
    EXPECT_EQ(values("A_ONE", "1 1 1 1", "1").alpha, RT_ALPHA_OPAQUE);
    EXPECT_EQ(values("A_ONE", "1 1 1 0.5", "0.5").alpha, RT_ALPHA_BLEND);
    EXPECT_FLOAT_EQ(values("A_ONE", "1 1 1 0.5", "0.5").opacity, 0.25f);
    EXPECT_EQ(values("RGB_ZERO", "0 0 0 1", "1").alpha, RT_ALPHA_OPAQUE);
    EXPECT_NEAR(values("RGB_ZERO", "0.5 0.5 0.5 1", "0.5").opacity, 0.75f, 1e-5);
    const auto hued = [&](const std::string& opaque, const std::string& color) {
        return clear(opaque, "<color>" + color + "</color>", "1").warnings;
    };
    ASSERT_EQ(hued("RGB_ZERO", "0.5 0.25 0.25 1").size(), 1u);
    EXPECT_NE(hued("RGB_ONE", "0.5 0.25 0.25 1")[0].find("material 'm': left out the hue of the transparency"),
              std::string::npos);
    EXPECT_TRUE(hued("A_ONE", "0.5 0.25 0.25 0.5").empty()) << "its alpha alone counts";
    const Scene cut = clear("A_ONE", picture("dot"), "1");
    EXPECT_TRUE(cut.warnings.empty()) << cut.warnings.at(0);
    EXPECT_EQ(cut.materials.back().values.alpha, RT_ALPHA_BLEND);
    EXPECT_EQ(cut.materials.back().values.opacity, 1);
    // Of another picture: "xyz" has the channels 120, 121 and 122, and no alpha, which is then 1.
    const auto opacity = [&](const Scene& scene) {
        const Material& m = scene.materials.back();
        EXPECT_EQ(m.values.alpha, RT_ALPHA_BLEND);
        const rt_u32 map = m.maps[RT_MAP_OPACITY];
        return map == RT_NONE ? 256 : scene.texels[scene.textures[scene.maps[map].texture].first] & 255u;
    };
    const Scene other = clear("A_ONE", picture("other"), "0.5");
    EXPECT_TRUE(other.warnings.empty()) << other.warnings.at(0);
    EXPECT_EQ(opacity(other), 255u);
    EXPECT_EQ(other.materials.back().values.opacity, 0.5f);
    const Scene inverted = clear("RGB_ZERO", picture("other"), "1");
    EXPECT_TRUE(inverted.warnings.empty()) << inverted.warnings.at(0);
    EXPECT_EQ(opacity(inverted), 255u - 121u);
    EXPECT_EQ(opacity(clear("RGB_ZERO", picture("dot"), "1")), 255u - 98u) << "of the picture of the colour, too";
    EXPECT_EQ(opacity(clear("RGB_ONE", picture("other"), "1")), 120u);
    for (const Scene& left : {clear("RGB_ZERO", picture("other"), "0.5"), clear("A_ZERO", picture("other"), "1")}) {
        ASSERT_EQ(left.warnings.size(), 1u);
        EXPECT_NE(left.warnings[0].find("material 'm': left out the pictures of transparency"), std::string::npos)
            << left.warnings[0];
        EXPECT_EQ(left.materials.back().values.alpha, RT_ALPHA_OPAQUE);
    }
}

TEST(ColladaMaterials, PicturesLieInSetsAndAreTransformed) {
    NEEDS_IMPORTER("a.dae");
    const Scratch folder;
    const std::string maya =
        "<extra><technique profile=\"MAYA\"><repeatU>2</repeatU><offsetV>0.25</offsetV></technique></extra>";
    const Scene scene = square(
        folder, "<emission>" + picture("other", "TEX1") + "</emission><diffuse>" + picture("dot", "UV", maya) + "</diffuse>");
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.at(0);
    const Material& m = scene.materials.back();
    ASSERT_NE(m.maps[RT_MAP_COLOR], RT_NONE);
    const rt_map color = scene.maps[m.maps[RT_MAP_COLOR]], emission = scene.maps[m.maps[RT_MAP_EMISSION]];
    EXPECT_EQ(color.set, 0u);
    EXPECT_EQ(color.matrix[0], 2);
    EXPECT_EQ(color.matrix[4], 1);
    EXPECT_EQ(color.matrix[5], 0.25f);
    EXPECT_EQ(emission.set, 1u);
    EXPECT_EQ(emission.matrix[0], 1);
    ASSERT_EQ(scene.uvs2.size(), scene.uvs.size());
    for (size_t i = 0; i < scene.uvs.size(); ++i) EXPECT_EQ(scene.uvs2[i], scene.uvs[i] + 5);
    EXPECT_TRUE(square(folder, kDiffuse).uvs2.empty()) << "a set that no picture names";
}

TEST(ColladaMaterials, HighlightsAreReflections) {
    NEEDS_IMPORTER("a.dae");
    const Scratch folder;
    const auto read = [&](const std::string& phong) { return square(folder, kDiffuse + phong); };
    const std::string shininess = "<shininess><float>98</float></shininess>";
    const MaterialValues m = read("<specular><color>.25 .25 .125 1</color></specular>" + shininess).materials.back().values;
    EXPECT_EQ(m.model, RT_MODEL_GLTF);
    EXPECT_FLOAT_EQ(m.roughness, std::sqrt(std::sqrt(2 / 100.0f)));
    EXPECT_FLOAT_EQ(m.layers.specular_weight, 0.5f);
    EXPECT_FLOAT_EQ(m.layers.specular_color[2], 0.5f);
    EXPECT_EQ(m.specular[0], 0.25f);
    EXPECT_EQ(m.shininess, 98);
    EXPECT_EQ(read("").materials.back().values.model, RT_MODEL_WHITTED);
    const Scene mapped = read("<specular>" + picture("other") + "</specular>" + shininess);
    EXPECT_TRUE(mapped.warnings.empty()) << mapped.warnings[0];
    EXPECT_NE(mapped.materials.back().maps[RT_MAP_SPECULAR_COLOR], RT_NONE);
    EXPECT_EQ(mapped.materials.back().values.specular[2], 1);
}

TEST(ColladaMaterials, SayWhichPicturesAreLeftOut) {
    NEEDS_IMPORTER("a.dae");
    const Scratch folder;
    const Scene scene = square(
        folder, kDiffuse + "<specular>" + picture("other") + "</specular><reflective>" + picture("other") + "</reflective>");
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("'m': left out the pictures of reflection"), std::string::npos) << scene.warnings[0];
    const Scene shiny = square(folder, kDiffuse + "<shininess>" + picture("other") + "</shininess>");
    ASSERT_EQ(shiny.warnings.size(), 1u);
    EXPECT_NE(shiny.warnings[0].find("'m': left out the pictures of shininess"), std::string::npos) << shiny.warnings[0];
}

// What the importer of COLLADA leaves out of files that move is said.

// A triangle, the geometry "g". shown: what a node of the scene shows.
std::string collada(const std::string& libraries, const std::string& shown) {
    return "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\"><asset/>"
           "<library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array id=\"pa\" count=\"9\">0 0 0 1 0 0 0 1 0"
           "</float_array><technique_common><accessor source=\"#pa\" count=\"3\" stride=\"3\"><param name=\"X\" "
           "type=\"float\"/>"
           "<param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor></technique_common></source>"
           "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices><triangles count=\"1\">"
           "<input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>0 1 "
           "2</p></triangles></mesh></geometry></library_geometries>" +
           libraries +
           "<library_visual_scenes><visual_scene id=\"s\"><node id=\"bone\" name=\"bone\" sid=\"bone\" type=\"JOINT\">"
           "<translate sid=\"t\">0 0 5</translate></node><node id=\"n\" name=\"n\">" +
           shown +
           "</node></visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>\n";
}

std::string source(const std::string& id, const std::string& array, const std::string& count, const std::string& values,
                   const std::string& stride, const std::string& param, const std::string& type) {
    return "<source id=\"" + id + "\"><" + array + " id=\"" + id + "a\" count=\"" + count + "\">" + values + "</" + array +
           "><technique_common><accessor source=\"#" + id + "a\" count=\"1\" stride=\"" + stride + "\"><param name=\"" + param +
           "\" type=\"" + type + "\"/></accessor></technique_common></source>";
}

const std::string kSkin =
    "<library_controllers><controller id=\"c\"><skin source=\"#g\"><bind_shape_matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"
    "</bind_shape_matrix>" +
    source("j", "Name_array", "1", "bone", "1", "JOINT", "name") +
    source("b", "float_array", "16", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "16", "TRANSFORM", "float4x4") +
    source("w", "float_array", "1", "1", "1", "WEIGHT", "float") +
    "<joints><input semantic=\"JOINT\" source=\"#j\"/><input semantic=\"INV_BIND_MATRIX\" source=\"#b\"/></joints>"
    "<vertex_weights count=\"3\"><input semantic=\"JOINT\" source=\"#j\" offset=\"0\"/>"
    "<input semantic=\"WEIGHT\" source=\"#w\" offset=\"1\"/><vcount>1 1 1</vcount><v>0 0 0 0 0 0</v></vertex_weights>"
    "</skin></controller></library_controllers>";
const std::string kAnimation =
    "<library_animations><animation id=\"a\">" + source("i", "float_array", "1", "0", "1", "TIME", "float") +
    source("o", "float_array", "1", "3", "1", "Z", "float") +
    source("l", "Name_array", "1", "LINEAR", "1", "INTERPOLATION", "name") +
    "<sampler id=\"m\"><input semantic=\"INPUT\" source=\"#i\"/><input semantic=\"OUTPUT\" source=\"#o\"/>"
    "<input semantic=\"INTERPOLATION\" source=\"#l\"/></sampler>"
    "<channel source=\"#m\" target=\"bone/t.Z\"/></animation></library_animations>";

TEST(ColladaMotion, SaysWhatIsLeftOut) {
    if (!has_importer_for("a.dae")) GTEST_SKIP() << "SKIPPED: the importer for dae was not built";
    const Scratch folder;
    const Scene still = import_file(folder.write("still.dae", collada("", "<instance_geometry url=\"#g\"/>")));
    EXPECT_TRUE(still.warnings.empty()) << still.warnings[0];
    const std::string skinned = "<instance_controller url=\"#c\"><skeleton>#bone</skeleton></instance_controller>";
    const Scene scene = import_file(folder.write("moving.dae", collada(kAnimation + kSkin, skinned)));
    EXPECT_EQ(scene.triangle_count(), 1u);
    EXPECT_EQ(scene.bounds().max[2], 0) << "the vertices as they are stored";
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("what moves the scene is left out (meshes with skins: 1, animations: 1)"),
              std::string::npos)
        << scene.warnings[0];
}

}  // namespace
}  // namespace clarity::test
