// own_models_test.cpp -- compares the import of our own small models with the expected values.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#ifdef CLARITY_HAVE_OPENMESH
#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#endif

#include "measure.hpp"

namespace clarity::test {
namespace {

#define NEEDS_IMPORTER(path) \
    if (!has_importer_for(path)) GTEST_SKIP() << "SKIPPED: the importer for " << (path) << " was not built"

std::string data(const std::string& name) {
    return std::string(CLARITY_SOURCE_DIR "/tests/plugins/importers/data/") + name;
}

const Material& material_named(const Scene& scene, std::string_view name) {
    for (const Material& material : scene.materials) {
        if (material.name == name) return material;
    }
    throw std::runtime_error("no material " + std::string(name));
}

const Instance& instance_named(const Scene& scene, std::string_view name) {
    for (const Instance& instance : scene.instances) {
        if (instance.name == name) return instance;
    }
    throw std::runtime_error("no instance " + std::string(name));
}

// Returns the material of a triangle as the instance shows it.
std::string material_of(const Scene& scene, const Instance& instance, rt_u32 triangle) {
    const rt_u32 own = scene.triangle_materials[scene.meshes[instance.mesh].first_triangle + triangle];
    return scene.materials[instance.material != RT_NONE ? instance.material : own].name;
}

void expect_bounds(const Bounds& bounds, std::array<float, 3> min, std::array<float, 3> max) {
    for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(bounds.min[k], min[k], 1e-4) << "axis " << k;
        EXPECT_NEAR(bounds.max[k], max[k], 1e-4) << "axis " << k;
    }
}

// ---- OBJ

TEST(ObjModel, KeepsEveryFaceInFileOrder) {
    NEEDS_IMPORTER("polygons.obj");
    const Scene scene = import_file(data("polygons.obj"));
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.front();
    EXPECT_EQ(scene.triangle_count(), 12u);  // 4 + 3 + 5; three of the faces share an edge
    EXPECT_NEAR(scene.surface_area(), 24.5, 1e-5);
    const char* const materials[12] = {"paint",  "paint", "paint", "paint", "mirror", "mirror",
                                       "mirror", "glass", "glass", "foil",  "lamp",   "lamp"};
    for (rt_u32 i = 0; i < 12; ++i) EXPECT_EQ(material_of(scene, scene.instances.at(0), i), materials[i]) << "triangle " << i;
}

TEST(ObjModel, ReadsMaterials) {
    NEEDS_IMPORTER("polygons.obj");
    const Scene scene = import_file(data("polygons.obj"));
    const rt_material paint = material_named(scene, "paint").values;
    EXPECT_FLOAT_EQ(paint.color[0], 0.8f);
    EXPECT_FLOAT_EQ(paint.color[1], 0.1f);
    EXPECT_FLOAT_EQ(paint.specular[0], 0.5f);
    EXPECT_FLOAT_EQ(paint.shininess, 40);
    EXPECT_EQ(paint.reflect + paint.refract, 0);
    EXPECT_FLOAT_EQ(material_named(scene, "lamp").values.emission[2], 5);
    EXPECT_FLOAT_EQ(material_named(scene, "mirror").values.reflect, 0.9f);
    const rt_material glass = material_named(scene, "glass").values;
    EXPECT_FLOAT_EQ(glass.refract, 1);
    EXPECT_FLOAT_EQ(glass.ior, 1.4f);
    EXPECT_FLOAT_EQ(glass.color[0], 0.5f);
    EXPECT_FLOAT_EQ(glass.color[1], 1);
    const rt_material foil = material_named(scene, "foil").values;
    EXPECT_EQ(foil.refract, 0);
    EXPECT_EQ(foil.alpha, RT_ALPHA_BLEND);
    EXPECT_FLOAT_EQ(foil.opacity, 0.25f);
}

TEST(ObjModel, KeepsAttributesPerCorner) {
    NEEDS_IMPORTER("polygons.obj");
    const Scene scene = import_file(data("polygons.obj"));
    ASSERT_EQ(scene.normals.size(), scene.positions.size());
    ASSERT_EQ(scene.uvs.size() / 2, scene.positions.size() / 3);
    // The faces are f 12/1/1 13/2/1 14/3/1, then f 12/3/2 13//2 14/1, at the same positions.
    const float uvs[6][2] = {{0, 0}, {1, 0}, {0.5f, 1}, {0.5f, 1}, {0, 0}, {0, 0}};
    const float normals[6] = {1, 1, 1, -1, -1, 0};
    for (int i = 0; i < 6; ++i) {
        const size_t v = scene.triangles[30 + size_t(i)];
        EXPECT_FLOAT_EQ(scene.uvs[2 * v], uvs[i][0]) << "corner " << i;
        EXPECT_FLOAT_EQ(scene.uvs[2 * v + 1], uvs[i][1]) << "corner " << i;
        EXPECT_FLOAT_EQ(scene.normals[3 * v + 2], normals[i]) << "corner " << i;
    }
}

TEST(ObjModel, LeavesOutOnlyWhatIsBroken) {
    NEEDS_IMPORTER("broken.obj");
    const Scratch folder;
    const std::string path = folder.write("broken.obj",
                                          "v 0 0 0\nv 1 0 0\nv nan 0 0\nv 0 1 0\nv 1e99 0 0\nv 0 0 1\n"
                                          "f 1 2 4\nf 1 2 3\nf 1 5 2\nf 1 2 77\nf 1 x 2\nf 1 2\nf 1 2 6\n");
    const Scene scene = import_file(path);
    ASSERT_EQ(scene.triangle_count(), 2u);
    EXPECT_NEAR(scene.surface_area(), 1, 1e-6);  // vertices behind the broken one keep their numbers
    ASSERT_EQ(scene.warnings.size(), 2u);
    EXPECT_NE(scene.warnings[0].find("line 11"), std::string::npos) << scene.warnings[0];
    EXPECT_NE(scene.warnings[1].find("line 8"), std::string::npos) << scene.warnings[1];
}

// ---- OFF, STL, PLY, OM

TEST(OffModel, SurvivesCommentsAndColours) {
    NEEDS_IMPORTER("roof.off");
    const Scene scene = import_file(data("roof.off"));
    EXPECT_EQ(scene.triangle_count(), 4u);
    EXPECT_NEAR(scene.surface_area(), 2.1180340, 1e-5);
    expect_bounds(scene.bounds(), {0, 0, 0}, {2, 1, 1});
}

TEST(StlModel, AsciiAndBinaryAgree) {
    NEEDS_IMPORTER("roof.stl");
    const Scene ascii = import_file(data("roof.stl"));
    EXPECT_EQ(ascii.triangle_count(), 2u);
    EXPECT_NEAR(ascii.surface_area(), 1, 1e-6);

    // A binary file that starts like text, and has extra bytes behind its facets.
    std::string bytes = "solid but binary";
    bytes.resize(80, ' ');
    const auto put = [&](const void* value, size_t size) { bytes.append(static_cast<const char*>(value), size); };
    const uint32_t count = 2;
    put(&count, 4);
    const float facets[2][12] = {{0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 1, 0}, {0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 1, 0}};
    for (const auto& facet : facets) {
        put(facet, sizeof facet);
        put("\0", 2);
    }
    const Scratch folder;
    const Scene binary = import_file(folder.write("binary.stl", bytes));
    EXPECT_EQ(binary.triangle_count(), 2u);
    EXPECT_NEAR(binary.surface_area(), 1, 1e-6);
    const Scene padded = import_file(folder.write("padded.stl", bytes + std::string(7, '\0')));
    EXPECT_EQ(padded.triangle_count(), 2u);
}

TEST(PlyModel, ReadsListsAttributesAndOddLines) {
    NEEDS_IMPORTER("roof.ply");
    const Scene scene = import_file(data("roof.ply"));
    EXPECT_EQ(scene.triangle_count(), 3u);  // a square and a triangle; the third face uses a vertex that is not finite
    EXPECT_NEAR(scene.surface_area(), 1.5, 1e-6);
    ASSERT_EQ(scene.warnings.size(), 1u);
    ASSERT_EQ(scene.uvs.size() / 2, scene.positions.size() / 3);
    EXPECT_FLOAT_EQ(scene.uvs[2 * size_t(scene.triangles[1])], 2);  // the square's second corner
    EXPECT_FLOAT_EQ(scene.uvs[2 * size_t(scene.triangles[7])], 1);  // the same vertex in the triangle
    EXPECT_FLOAT_EQ(scene.uvs[2 * size_t(scene.triangles[7]) + 1], 0);
    EXPECT_FLOAT_EQ(scene.normals[3 * size_t(scene.triangles[7]) + 2], 1);
}

std::string binary_ply(bool big_endian, const char* count_type, size_t count_bytes) {
    std::string bytes = std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
                        "_endian 1.0\nobj_info made for this test\nelement vertex 5\nproperty float x\nproperty float y\n"
                        "property double z\nproperty uchar quality\nelement face 2\nproperty list " +
                        count_type + " ushort vertex_index\nend_header\n";
    const auto put = [&](const void* value, size_t size) {
        std::string raw(static_cast<const char*>(value), size);
        if (big_endian) std::reverse(raw.begin(), raw.end());
        bytes += raw;
    };
    const float positions[5][2] = {{0, 0}, {3, 0}, {3, 2}, {0, 2}, {1, 5}};
    for (const auto& p : positions) {
        const double z = 7;
        const uint8_t quality = 10;  // would be the end of a line in a text file
        put(&p[0], 4);
        put(&p[1], 4);
        put(&z, 8);
        put(&quality, 1);
    }
    const std::vector<std::vector<uint16_t>> faces = {{0, 1, 2, 3}, {3, 2, 4}};
    for (const auto& face : faces) {
        const uint32_t count = static_cast<uint32_t>(face.size());
        put(&count, count_bytes);
        for (const uint16_t index : face) put(&index, 2);
    }
    return bytes;
}

TEST(PlyModel, ReadsBothByteOrdersAndAllCountTypes) {
    NEEDS_IMPORTER("roof.ply");
    const Scratch folder;
    const std::pair<const char*, size_t> counts[] = {{"uchar", 1}, {"int8", 1}, {"ushort", 2},
                                                     {"int16", 2}, {"uint", 4}, {"int32", 4}};
    for (const bool big_endian : {false, true}) {
        for (const auto& [type, size] : counts) {
            const Scene scene = import_file(folder.write("binary.ply", binary_ply(big_endian, type, size)));
            EXPECT_EQ(scene.triangle_count(), 3u) << type;
            EXPECT_NEAR(scene.surface_area(), 6 + 4.5, 1e-5) << type;
            expect_bounds(scene.bounds(), {0, 0, 7}, {3, 5, 7});
        }
    }
}

#ifdef CLARITY_HAVE_OPENMESH
TEST(OmModel, ReadsWhatOpenMeshWrites) {
    OpenMesh::PolyMesh_ArrayKernelT<> mesh;
    OpenMesh::VertexHandle v[5];
    int count = 0;
    const float positions[5][3] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 3}};
    for (const auto& p : positions) v[count++] = mesh.add_vertex(OpenMesh::Vec3f(p[0], p[1], p[2]));
    mesh.add_face(v[0], v[3], v[2], v[1]);
    mesh.add_face(v[0], v[1], v[4]);
    mesh.add_face(v[1], v[2], v[4]);
    const Scratch folder;
    ASSERT_TRUE(OpenMesh::IO::write_mesh(mesh, folder.path("pyramid.om")));
    const Scene scene = import_file(folder.path("pyramid.om"));
    EXPECT_EQ(scene.triangle_count(), 4u);
    EXPECT_NEAR(scene.surface_area(), 4 + 2 * std::sqrt(10.0), 1e-4);
}
#endif

// ---- FBX

TEST(FbxModel, PlacesNodesAsTheFileMeansThem) {
    const Scene scene = import_file(data("nodes.fbx"));
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.front();
    const std::vector<InstanceMeasure> measures = measure_instances(scene);
    ASSERT_EQ(measures.size(), 2u);
    // The geometric transform applies to the parent's mesh only, and rotates about x before y, whatever the node's order is.
    EXPECT_EQ(measures[0].name, "Parent");
    expect_bounds(measures[0].bounds, {10, 0, 90}, {16, 0, 100});
    EXPECT_NEAR(measures[0].area, 4 * 6, 1e-4);
    // The child inherits the translation only. Its pre-rotation does not count, because RotationActive is not set.
    EXPECT_EQ(measures[1].name, "Child");
    expect_bounds(measures[1].bounds, {5, 5, 0}, {10, 8, 0});
    EXPECT_EQ(scene.up_axis, 2u);
    EXPECT_NEAR(scene.unit_scale, 1, 1e-6);
}

TEST(FbxModel, GivesEachNodeItsOwnMaterials) {
    const Scene scene = import_file(data("nodes.fbx"));
    const Instance &parent = instance_named(scene, "Parent"), &child = instance_named(scene, "Child");
    for (rt_u32 i = 0; i < 5; ++i) {
        EXPECT_EQ(material_of(scene, parent, i), i < 3 ? "Red" : "Green");
        EXPECT_EQ(material_of(scene, child, i), i < 3 ? "Blue" : "Green");
    }
    EXPECT_FLOAT_EQ(material_named(scene, "Green").values.specular[0], 0.5f);
    EXPECT_FLOAT_EQ(material_named(scene, "Green").values.shininess, 30);
    EXPECT_FLOAT_EQ(material_named(scene, "Blue").values.color[2], 1);
    EXPECT_EQ(material_named(scene, "Blue").values.alpha, RT_ALPHA_BLEND);
    EXPECT_FLOAT_EQ(material_named(scene, "Blue").values.opacity, 0.25f);
}

// box.dae with a texture, some text in its element and in its sampler, and further effects.
Scene textured_box(const Scratch& folder, const std::string& maya, const std::string& sampler, const std::string& effects = "",
                   const std::string& picture = "dot.ppm") {
    std::ifstream file(data("box.dae"));
    std::string text((std::istreambuf_iterator<char>(file)), {});
    folder.write("dot.ppm", "P6 1 1 255\nabc");
    folder.write("my dot.ppm", "P6 1 1 255\nabc");
    const auto replace = [&](const std::string& what, const std::string& by) {
        const size_t at = text.find(what);
        ASSERT_NE(at, text.npos) << what;
        text.replace(at, what.size(), by);
    };
    replace("<color>0.8 0.1 0.1 1</color>", "<texture texture=\"sampler\" texcoord=\"UV\"><extra><technique profile=\"MAYA\">" +
                                                maya + "</technique></extra></texture>");
    replace("<profile_COMMON>",
            "<profile_COMMON><newparam sid=\"surface\"><surface type=\"2D\"><init_from>dot</init_from></surface></newparam>"
            "<newparam sid=\"sampler\"><sampler2D><source>surface</source>" +
                sampler + "</sampler2D></newparam>");
    replace("<library_effects>", "<library_images><image id=\"dot\"><init_from>" + picture +
                                     "</init_from></image></library_images><library_effects>" + effects);
    return import_file(folder.write("wraps.dae", text));
}

// assimp gives the wrap modes that Maya writes, and does not read those of the standard.
TEST(ColladaModel, TakesWrapModesOfSamplersAndOfMaya) {
    NEEDS_IMPORTER("a.dae");
    const Scratch folder;
    const auto wrap_of = [&](const std::string& maya, const std::string& sampler, const std::string& picture = "dot.ppm") {
        const Scene scene = textured_box(folder, maya, sampler, "", picture);
        EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
        return scene.textures.empty() ? 99u : scene.textures[0].wrap;
    };
    const rt_u32 both = RT_WRAP_CLAMP + RT_WRAP_ALONG_V * RT_WRAP_MIRROR;
    EXPECT_EQ(wrap_of("", ""), RT_WRAP_REPEAT);
    EXPECT_EQ(wrap_of("<wrapU>0</wrapU><wrapV>1</wrapV><mirrorV>1</mirrorV>", ""), both);
    EXPECT_EQ(wrap_of("", "<wrap_s> WRAP</wrap_s>"), RT_WRAP_REPEAT);
    EXPECT_EQ(wrap_of("", "<wrap_s>CLAMP</wrap_s>"), RT_WRAP_CLAMP);
    EXPECT_EQ(wrap_of("", "<wrap_s>CLAMP</wrap_s><!-- <wrap_t>CLAMP</wrap_t> --><wrap_t>\nMIRROR\n</wrap_t>"), both);
    EXPECT_EQ(wrap_of("", "<wrap_s>BORDER</wrap_s><wrap_t>NONE</wrap_t>"), RT_WRAP_CLAMP + RT_WRAP_ALONG_V * RT_WRAP_CLAMP);
    EXPECT_EQ(wrap_of("", "<wrap_s>CLAMP</wrap_s>", "./my%20dot.ppm"), RT_WRAP_CLAMP);
}

TEST(ColladaModel, SaysThatSamplersOfOnePictureDiffer) {
    NEEDS_IMPORTER("a.dae");
    const Scratch folder;
    const auto effect = [](const std::string& wrap) {
        return "<effect id=\"other\"><profile_COMMON><newparam sid=\"s\"><surface "
               "type=\"2D\"><init_from>dot</init_from></surface>"
               "</newparam><newparam sid=\"t\"><sampler2D><source>s</source>" +
               wrap +
               "</sampler2D></newparam><technique sid=\"c\"><lambert><diffuse><texture texture=\"t\" "
               "texcoord=\"UV\"/></diffuse>"
               "</lambert></technique></profile_COMMON></effect>";
    };
    const Scene scene = textured_box(folder, "", "<wrap_s>CLAMP</wrap_s>", effect("<wrap_s>MIRROR</wrap_s>"));
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("samplers wrap 'dot.ppm' in several ways; the first one counts"), std::string::npos);
    EXPECT_EQ(scene.textures[0].wrap, RT_WRAP_MIRROR);
    EXPECT_TRUE(textured_box(folder, "", "<wrap_s>CLAMP</wrap_s>", effect("<wrap_s>CLAMP</wrap_s>")).warnings.empty());
}

TEST(ColladaModel, NamesColoursOfVerticesThatAreLeftOut) {
    NEEDS_IMPORTER("a.dae");
    std::ifstream file(data("box.dae"));
    std::string text((std::istreambuf_iterator<char>(file)), {});
    const Scratch folder;
    EXPECT_TRUE(import_file(folder.write("plain.dae", text)).warnings.empty());
    const std::string input = "<input semantic=\"VERTEX\"";
    ASSERT_NE(text.find(input), text.npos);
    text.insert(text.find(input), "<input semantic=\"COLOR\" source=\"#paint-source\" offset=\"0\"/>");
    std::string numbers;
    for (int i = 0; i < 6; ++i) numbers += "1 0 0 ";
    text.insert(
        text.find("<vertices"),
        "<source id=\"paint-source\"><float_array id=\"paint-array\" count=\"18\">" + numbers +
            "</float_array><technique_common><accessor source=\"#paint-array\" count=\"6\" stride=\"3\"><param name=\"R\" "
            "type=\"float\"/><param name=\"G\" type=\"float\"/><param name=\"B\" "
            "type=\"float\"/></accessor></technique_common></source>");
    const Scene scene = import_file(folder.write("painted.dae", text));
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("colours of vertices are not read; they are left out, in 1 meshes"), std::string::npos);
}

TEST(ColladaModel, LightsFadeAsTheirAttenuationSays) {
    NEEDS_IMPORTER("a.dae");
    std::ifstream file(data("box.dae"));
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    const Scratch folder;
    const auto with = [&](const std::string& attenuation) {
        std::string lit = text;
        lit.insert(lit.find("<library_visual_scenes>"),
                   "<library_lights><light id=\"lamp\"><technique_common><point><color>1 .5 .25</color>" + attenuation +
                       "</point></technique_common></light></library_lights>");
        lit.insert(lit.find("<instance_geometry"), "<instance_light url=\"#lamp\"/>");
        return import_file(folder.write("lit.dae", lit));
    };
    const auto parts = [](const char* constant, const char* linear, const char* quadratic) {
        return std::string("<constant_attenuation>") + constant + "</constant_attenuation><linear_attenuation>" + linear +
               "</linear_attenuation><quadratic_attenuation>" + quadratic + "</quadratic_attenuation>";
    };
    const Scene plain = with("");
    ASSERT_EQ(plain.lights.size(), 1u);
    EXPECT_EQ(plain.lights[0].values.flags, 0u);
    EXPECT_FLOAT_EQ(plain.lights[0].values.color[1], 0.5f);
    const Scene square = with(parts("0", "0", "0.25"));
    ASSERT_EQ(square.lights.size(), 1u);
    EXPECT_EQ(square.lights[0].values.flags, RT_LIGHT_FALLOFF);
    EXPECT_NEAR(square.lights[0].values.color[0], 4 * std::acos(-1.0), 1e-5);
    EXPECT_TRUE(square.warnings.empty());
    const Scene mixed = with(parts("1", "0", "0.25"));
    ASSERT_EQ(mixed.warnings.size(), 1u);
    EXPECT_NE(mixed.warnings[0].find("has an attenuation other than"), std::string::npos);
}

TEST(FbxModel, PlacesLampAndCamera) {
    const Scene scene = import_file(data("nodes.fbx"));
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.lights[0].values.kind, RT_LIGHT_POINT);
    EXPECT_FLOAT_EQ(scene.lights[0].values.position[2], 3);
    EXPECT_FLOAT_EQ(scene.lights[0].values.color[1], 0.5f);
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.cameras[0].name, "Eye");
    EXPECT_FLOAT_EQ(scene.cameras[0].eye[0], -4);
    EXPECT_GT(scene.cameras[0].target[0], -4);                          // along +x
    EXPECT_NEAR(scene.cameras[0].fov_y_rad, 2 * std::atan(0.5), 1e-5);  // 90 degrees across at 2:1
}

// ---- glTF

TEST(GltfModel, KeepsInstancesMaterialsAndCamera) {
    const Scene scene = import_file(data("nodes.gltf"));
    EXPECT_EQ(scene.meshes.size(), 1u);
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_NEAR(scene.surface_area(), 1 + 2, 1e-5);
    expect_bounds(scene.bounds(), {-2, 0, 0}, {1, 1, 3});
    const rt_material steel = material_named(scene, "steel").values;
    EXPECT_FLOAT_EQ(steel.reflect, 0.75f);
    EXPECT_EQ(steel.refract, 0);
    EXPECT_EQ(steel.alpha, RT_ALPHA_OPAQUE);  // alpha counts only if alphaMode says so
    EXPECT_EQ(scene.unit_scale, 1);
    // (0, 1) in glTF is the bottom left of the picture, which is (0, 0) here.
    for (size_t v = 0; v < scene.positions.size() / 3; ++v) {
        EXPECT_FLOAT_EQ(scene.uvs[2 * v], scene.positions[3 * v]);
        EXPECT_FLOAT_EQ(scene.uvs[2 * v + 1], scene.positions[3 * v + 1]);
    }
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_FLOAT_EQ(scene.cameras[0].eye[2], 9);
    EXPECT_LT(scene.cameras[0].target[2], 9);
    EXPECT_NEAR(scene.cameras[0].fov_y_rad, 0.8, 1e-5);
}

}  // namespace
}  // namespace clarity::test
