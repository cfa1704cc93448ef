// mesh_files_test.cpp -- OBJ, MTL, PLY, STL and OFF as other programs write them: byte order marks, all line ends, elements in
// any order, names that hold keywords, blanks and '#'.
#include <gtest/gtest.h>

#include <cstring>

#include "mesh_files.hpp"

namespace clarity::test {
namespace {

// The name of the material of each triangle.
std::vector<std::string> materials(const Scene& scene) {
    std::vector<std::string> names;
    for (const rt_u32 material : scene.triangle_materials) names.push_back(scene.materials[material].name);
    return names;
}
std::string bytes_of(const std::vector<float>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

using Names = std::vector<std::string>;

// ---- line ends, marks, files with nothing in them

TEST_F(MeshFiles, HaveAnyLineEnds) {
    expect_square_however_written("a.obj", "# by hand\n\n" + kSquare + "f 1 2 \\\n3 4\n");
    expect_square_however_written("a.off", "OFF # a square\n# made by hand\n\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
    expect_square_however_written("b.off", "4 1\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1\n2 3");
    expect_square_however_written("c.off",
                                  "NOFF\n4 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 0 0 0 1\n4 0 1 2 3 0.5 0.5 1\n");
    expect_square_however_written("d.off",
                                  "COFF 4 1 0\n0 0 0 1 0 0 1\n1 0 0 1 0 0 1\n1 1 0 1 0 0 1\n0 1 0 1 0 0 1\n4 0 1 2 3\n");
}

TEST_F(MeshFiles, WithoutASurfaceAreRefused) {
    expect_refused("points.obj", "v 0 0 0\nv 1 0 0\n", "contains no polygons, only 2 points");
    // Points and lines are sound, and only cannot be seen.
    EXPECT_TRUE(warns(import("lines.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n"), "contains no polygons"));
    expect_refused("words.obj", "This is no model.\n", "expected a .obj file");
    expect_refused("names.stl", "solid a\nendsolid a\n", "no facet");
    expect_refused("empty.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", "contains no polygons");
    expect_refused("wide.obj", std::string("\xFF\xFEv\0 \0", 6), "UTF-16");
    expect_refused("nothing.scene", "# a comment\n\n", "no statement");
}

// ---- PLY

std::string ply(const std::string& elements, const std::string& data, const std::string& format = "ascii") {
    return "ply\nformat " + format + " 1.0\n" + elements + "end_header\n" + data;
}
const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kIndices = "property list uchar int vertex_indices\n";
const std::string kRows = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

TEST_F(MeshFiles, PlyHasElementsAndPropertiesInAnyOrder) {
    const std::string vertices = "element vertex 4\n" + kXyz, faces = "element face 1\n" + kIndices;
    expect_square_however_written("a.ply", ply(vertices + faces, kRows + "4 0 1 2 3\n"));
    expect_square_however_written("b.ply", ply(faces + vertices, "4 0 1 2 3\n" + kRows));
    expect_square_however_written(
        "c.ply", ply("element camera 2\nproperty list int double pose\nelement empty 3\n" + vertices + "element edge 1\n" +
                         "property int a\nproperty int b\n" + faces + "element tail 9\nproperty float never_there\n",
                     "3 1 2 3\n0\n" + kRows + "7 8\n4 0 1 2 3"));
    expect_square("d.ply",
                  ply("element vertex 4\nproperty list uchar double weights\nproperty int z\nproperty list int uchar tag\n"
                      "property short y\nproperty double x\n" +
                          faces,
                      "2 .5 .5 0 0 0 0\n0 0 2 1 2 0 1\n1 7 0 0 1 1\n0 0 1 255 1 0\n4 0 1 2 3\n"));
    expect_square("e.ply", ply(vertices + "element face 2\nproperty uchar red\nproperty list uchar float texcoord\n"
                                          "property list uint uint vertex_index\nproperty list uchar short more\n",
                               kRows + "255 0 3 0 1 2 2 1 1\n0 6 0 0 1 0 1 1 3 0 2 3 0\n"));
    const std::string strips = "element tristrips 1\nproperty list int int vertex_indices\n";
    expect_square_however_written("f.ply", ply(vertices + strips, kRows + "7 0 1 2 -1 0 2 3\n"));
    expect_square_however_written("g.ply", ply(strips + vertices, "4 1 2 0 3\n" + kRows));
    // Elements in the middle of the file may go on in the next line.
    expect_square("h.ply", ply(vertices + faces, "0\n0 0 extra\n1 0 0\n\n1 1\n0\n0 1 0\n4 0 1\n2 3\n"));
}

TEST_F(MeshFiles, PlyStripsKeepTheirSense) {
    const Scene scene =
        import("a.ply", ply("element vertex 4\n" + kXyz + "element tristrips 1\n" + "property list int int vertex_indices\n",
                            "0 0 0\n1 0 0\n0 1 0\n1 1 0\n4 0 1 2 3\n"));
    EXPECT_EQ(std::vector<rt_u32>(scene.triangles.begin(), scene.triangles.end()), (std::vector<rt_u32>{0, 1, 2, 2, 1, 3}));
}

// The bytes of a number, in either order.
template <class T>
std::string number(double value, bool big_endian) {
    const T typed = static_cast<T>(value);
    std::string bytes(reinterpret_cast<const char*>(&typed), sizeof typed);
    if (big_endian) std::reverse(bytes.begin(), bytes.end());
    return bytes;
}

TEST_F(MeshFiles, BinaryPlyHasListsAnywhere) {
    for (const bool big : {false, true}) {
        std::string data = number<uint16_t>(1, big) + number<float>(.25, big);
        data += number<int8_t>(1, big) + number<uint8_t>(4, big);
        for (const int v : {0, 1, 2, 3}) data += number<uint16_t>(v, big);
        data += number<double>(0.5, big);
        const double xy[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        int list = 0;
        for (const auto& p : xy) {
            data += number<int16_t>(p[0], big) + number<uint32_t>(list, big) + std::string(2 * size_t(list), 'x');
            data += number<double>(p[1], big) + number<uint8_t>(0, big);
            list = (list + 1) % 3;
        }
        const std::string header =
            "element a 1\nproperty list ushort float b\nelement face 1\nproperty char flag\nproperty list uchar ushort "
            "vertex_index\n"
            "property double quality\nelement vertex 4\nproperty short x\nproperty list uint short words\nproperty double y\n"
            "property uchar z\n";
        const std::string file = ply(header, "", big ? "binary_big_endian" : "binary_little_endian");
        for (const char* end : {"\n", "\r\n", "\r"}) {
            expect_square("a.ply", with_ends(file, end) + data);
            expect_square("b.ply", kMark + with_ends(file, end) + data);
        }
        const std::string message = refusal("short.ply", file + data.substr(0, data.size() - 3));
        EXPECT_NE(message.find("3 of 4 vertices"), std::string::npos) << message;
    }
}

TEST_F(MeshFiles, BinaryPlyBehindCrBeginsWithAnyByte) {
    // The first byte of the data is the sign of a line end.
    const std::string faces = "element face 1\nproperty uchar flag\n" + kIndices, vertices = "element vertex 4\n" + kXyz;
    std::string data = std::string("\n\4", 2);
    for (const int v : {0, 1, 2, 3}) data += number<int32_t>(v, false);
    data += bytes_of({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
    expect_square("a.ply", with_ends(ply(faces + vertices, "", "binary_little_endian"), "\r") + data);
}

std::vector<float> first_color(const Scene& scene) {
    return scene.colors.size() < 4 ? std::vector<float>() : std::vector<float>(scene.colors.begin(), scene.colors.begin() + 4);
}

// Bytes are sRGB (188 is half of the light), alpha is not; floating-point numbers are linear.
TEST_F(MeshFiles, PlyColoursAreLinearInTheScene) {
    const auto color = [&](const std::string& type, const std::string& names, const std::string& values) {
        std::string properties, lines;
        for (size_t at = 0; at < names.size(); ++at) {
            const std::string name = names[at] == 'r'   ? "red"
                                     : names[at] == 'g' ? "green"
                                     : names[at] == 'b' ? "blue"
                                                        : "alpha";
            properties += "property " + type + " " + name + "\n";
        }
        for (const char* at : {"0 0 0 ", "1 0 0 ", "0 1 0 "}) lines += at + values + "\n";
        return first_color(import(
            "a.ply", ply("element vertex 3\n" + kXyz + properties + "element face 1\n" + kIndices, lines + "3 0 1 2\n")));
    };
    const std::vector<float> bytes = color("uchar", "rgba", "188 255 0 51");
    ASSERT_EQ(bytes.size(), 4u);
    EXPECT_NEAR(bytes[0], 0.5029, 1e-4);
    EXPECT_EQ(bytes[1], 1);
    EXPECT_EQ(bytes[2], 0);
    EXPECT_FLOAT_EQ(bytes[3], 0.2f);
    EXPECT_EQ(color("float", "bgr", "0.25 0.5 1"), (std::vector<float>{1, 0.5f, 0.25f, 1}));
    EXPECT_FLOAT_EQ(color("ushort", "rgb", "65535 0 0").at(0), 1);
    EXPECT_TRUE(color("uchar", "rg", "9 9").empty()) << "two channels are no colour";
    const Scene faces = import("a.ply", ply("element vertex 3\n" + kXyz + "element face 1\n" + kIndices +
                                                "property uchar red\nproperty uchar green\nproperty uchar blue\n",
                                            "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 9 9 9\n"));
    EXPECT_TRUE(warns(faces, "its faces have colours"));
}

// As scanners write them. One number more than three is a weight. Copies of a vertex have its colour.
TEST_F(MeshFiles, ObjColoursAreLinearInTheScene) {
    const Scene scene = import("a.obj",
                               "v 0 0 0 1\nv 1 0 0 0.735357 0 1\nv 1 1 0\nv 0 1 0 2 nonsense 0\nvn 0 0 1\nvn 0 1 0\n"
                               "f 1//1 2//1 3//1\nf 1//1 3//1 4//1\nf 2//2 3//1 4//1\n");
    ASSERT_EQ(scene.vertex_count(), 5u) << "the second vertex has two normals";
    ASSERT_EQ(scene.colors.size(), 20u);
    EXPECT_EQ(first_color(scene), (std::vector<float>{1, 1, 1, 1}));
    for (const size_t vertex : {1u, 4u}) {
        EXPECT_NEAR(scene.colors[4 * vertex], 0.5, 1e-5) << vertex;
        EXPECT_EQ(scene.colors[4 * vertex + 1], 0) << vertex;
        EXPECT_EQ(scene.colors[4 * vertex + 2], 1) << vertex;
    }
    EXPECT_EQ(scene.colors[12], 1) << "what is no number is no colour";
    EXPECT_TRUE(import("b.obj", "v 0 0 0 1\nv 1 0 0 1\nv 1 1 0 1\nf 1 2 3\n").colors.empty());
}

// ---- STL

std::string stl(const std::string& solid, const std::string& end, const std::string& body_end = "endloop\nendfacet\n") {
    const auto facet = [&](const char* corners) {
        return "facet normal 0 0 1\nouter loop\n" + std::string(corners) + body_end;
    };
    return solid + "\n" + facet("vertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\n") +
           facet("vertex 0 0 0\nvertex 1 1 0\nvertex 0 1 0\n") + end;
}

TEST_F(MeshFiles, StlNamesMayBeAnything) {
    for (const char* name : {"", " router", " outer loop", " vertex 1 2", " endfacet facet", " solid", " facet normal",
                             " a\tb # c", " end loop", " \"quoted\"", " endsolid"}) {
        expect_square_however_written("a.stl", stl(std::string("solid") + name, std::string("endsolid") + name));
    }
    expect_square_however_written("b.stl", stl("  \tSolid x", "end solid x\n", "  End Loop\n\tEND FACET\n"));
    expect_square_however_written("c.stl", stl("solid no end", ""));
    expect_square_however_written("d.stl",
                                  stl("a title\nsolid x\nCOLOR 0.5 0.5 0.5\n", "endsolid\nsolid empty\nendsolid empty\n"));
    std::string upper = stl("SOLID X", "ENDSOLID X");
    std::transform(upper.begin(), upper.end(), upper.begin(), [](char c) { return static_cast<char>(std::toupper(c)); });
    expect_square("e.stl", upper);
    std::string line = stl("solid a name", "endsolid");
    expect_square("f.stl", with_ends(line, " "));
    for (size_t at = line.find("0 0 1"); at != line.npos; at = line.find("0 0 1")) line.replace(at, 5, "nan -nan(ind) -1.#IND");
    expect_square("g.stl", line);
    // Two solids make one mesh.
    expect_square("h.stl",
                  "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex +1.0e+000 0 0\nvertex 1 1 "
                  "0\nendloop\nendfacet\nendsolid "
                  "a\nsolid b\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 1 0\nvertex 0 1 "
                  "0\nendloop\nendfacet\nendsolid b\n");
}

TEST_F(MeshFiles, BinaryStlMayBeginWithSolid) {
    for (const std::string title : {"solid", "solid facet normal outer loop vertex", "SOLID AutoCAD\n", "facet", ""}) {
        std::string bytes = title;
        bytes.resize(80, ' ');
        bytes += number<uint32_t>(2, false);
        for (const std::vector<float>& corners :
             {std::vector<float>{0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 1, 0}, std::vector<float>{0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 1, 0}})
            bytes += bytes_of(corners) + std::string(2, '\0');
        expect_square("a.stl", bytes);
        expect_square("b.stl", bytes + "behind");
    }
}

TEST_F(MeshFiles, StlThatStopsIsRefused) {
    const std::string whole = stl("solid x", "");
    for (const char* at : {"vertex 1 1", "endloop"})
        expect_refused("a.stl",
                       whole.substr(0, whole.find(at, 20)) + (std::strcmp(at, "endloop") == 0 ? "" : "\n") + "endsolid\n" +
                           (std::strcmp(at, "endloop") == 0 ? "facet normal 0 0 1\n" : ""),
                       "cut off");
}

// ---- OBJ and MTL

TEST_F(MeshFiles, ObjFindsItsMaterialsWhereverTheyAreNamed) {
    folder_.write("red.mtl", "newmtl red\nKd 1 0 0\n");
    folder_.write("my two.mtl", kMark + with_ends("newmtl blue\nKd 0 0 1\nnewmtl red\nKd 0.5 0 0\n", "\r"));
    folder_.write("c#.mtl",
                  "newmtl Material #1\nKd 0 1 0\n\tnewmtl  padded name \t\nKd 1 1 0\nnewmtl a # the first\nKd 1 1 1\n");
    const std::string face = "f 1 2 3\n";
    const auto used = [&](const std::string& text) { return materials(import("a.obj", kSquare + text)); };
    EXPECT_EQ(used("usemtl red\nmtllib red.mtl\n" + face), Names{"red"});
    EXPECT_EQ(used("usemtl red\n" + face + "mtllib red.mtl"), Names{"red"});
    EXPECT_EQ(used("mtllib red.mtl my two.mtl c#.mtl\nusemtl blue\n" + face + "usemtl Material #1\n" + face),
              (Names{"blue", "Material #1"}));
    EXPECT_EQ(used("mtllib \"my two.mtl\" # a comment\nusemtl blue # another\n" + face), Names{"blue # another"});
    EXPECT_EQ(used("mtllib c#.mtl\nusemtl padded name\n" + face + "usemtl a\n" + face + "usemtl \"a\"\n" + face),
              (Names{"padded name", "a", "a"}));
    EXPECT_EQ(used("mtllib C:\\models\\red.mtl\nusemtl red\n" + face + face + "usemtl none\n" + face),
              (Names{"red", "red", "default"}));
    EXPECT_EQ(used(face + "usemtl red\nmtllib my two.mtl\n" + face), (Names{"default", "red"}));
    // A name means the material of the library before it.
    const Scene scene =
        import("a.obj", kSquare + "mtllib red.mtl\nusemtl red\n" + face + "mtllib my two.mtl\nusemtl red\n" + face);
    EXPECT_FLOAT_EQ(scene.materials[scene.triangle_materials[0]].values.color[0], 1);
    EXPECT_FLOAT_EQ(scene.materials[scene.triangle_materials[1]].values.color[0], 0.5f);
    EXPECT_TRUE(warns(import("a.obj", kSquare + "mtllib red.mtl\nusemtl rde\n" + face), "'rde' is not defined"));
    EXPECT_TRUE(warns(import("a.obj", kSquare + "mtllib no such.mtl\n" + face), "'no such.mtl' cannot be read"));
}

TEST_F(MeshFiles, ObjKeepsFacesOfAreaZeroAndFacesBeforeVertices) {
    // ZBrush writes quads with two equal corners for triangles.
    const Scene scene = import("a.obj", "f 1 2 3 3\n" + kSquare + "f 1 1 2\nf 1 3 4 4\n");
    EXPECT_EQ(scene.triangle_count(), 5u);
    EXPECT_NEAR(scene.surface_area(), 1, 1e-6);
    EXPECT_TRUE(scene.warnings.empty());
}

}  // namespace
}  // namespace clarity::test
