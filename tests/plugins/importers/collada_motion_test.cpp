// collada_motion_test.cpp -- what the importer of COLLADA leaves out of files that move is said.
#include <gtest/gtest.h>

#include "measure.hpp"

namespace clarity::test {
namespace {

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
