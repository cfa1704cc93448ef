// heights_and_points_test.cpp -- height maps and point clouds as other programs write them: where samples and points come to
// lie, what a file has besides, and why damaged ones are refused.
#include <gtest/gtest.h>

#include <zlib.h>
#include <cmath>

#include "mesh_files.hpp"

namespace clarity::test {
namespace {

using HeightsAndPoints = MeshFiles;

void put_big_endian(std::string& to, uint32_t value, int bytes) {
    for (int k = bytes; k-- > 0;) to += static_cast<char>(value >> 8 * k);
}
void put_chunk(std::string& to, const std::string& data) {
    put_big_endian(to, uint32_t(data.size()) - 4, 4);
    to += data;
    put_big_endian(to, uint32_t(crc32(0, reinterpret_cast<const Bytef*>(data.data()), uInt(data.size()))), 4);
}
// A PNG picture. kind: 0 grey, 2 RGB, 4 grey and alpha; rows: the bytes of each.
std::string png(int width, int height, int bits, int kind, const std::vector<std::string>& rows) {
    std::string head = "IHDR", data;
    put_big_endian(head, uint32_t(width), 4);
    put_big_endian(head, uint32_t(height), 4);
    head += {static_cast<char>(bits), static_cast<char>(kind), 0, 0, 0};
    for (const std::string& row : rows) data += '\0' + row;
    std::string packed(compressBound(data.size()), '\0');
    uLongf size = packed.size();
    compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(data.data()), data.size());
    std::string out = "\x89PNG\r\n\x1a\n";
    put_chunk(out, head);
    put_chunk(out, "IDAT" + packed.substr(0, size));
    put_chunk(out, "IEND");
    return out;
}

// The height of the corner that lies at x, z.
float height_at(const Scene& scene, float x, float z) {
    for (size_t i = 0; i < scene.positions.size(); i += 3)
        if (std::fabs(scene.positions[i] - x) < 1e-5f && std::fabs(scene.positions[i + 2] - z) < 1e-5f)
            return scene.positions[i + 1];
    return NAN;
}

// The top left sample is behind on the left, and all formats have the same heights.
TEST_F(HeightsAndPoints, SamplesLieAsThePictureDoes) {
    using namespace std::string_literals;
    const std::vector<std::pair<const char*, std::string>> files = {
        {"text.pgm", "P2 # heights\n3 2\n100\n100 0 50\n0 0 25\n"},
        {"bytes.pgm", "P5\n3 2\n100\n\x64\0\x32\0\0\x19"s},
        {"words.pgm", "P5\n3 2\n1000\n\x03\xE8\0\0\x01\xF4\0\0\0\0\0\xFA"s},
        {"bytes.png", png(3, 2, 8, 0, {"\xFF\0\x80"s, "\0\0\x40"s})},
        {"words.png", png(3, 2, 16, 0, {"\xFF\xFF\0\0\x80\0"s, "\0\0\0\0\x40\0"s})},
        {"color.png", png(3, 2, 8, 2, {"\xFF\xFF\xFF\0\0\0\x80\x80\x80"s, "\0\0\0\0\0\0\x40\x40\x40"s})},
        {"alpha.png", png(3, 2, 8, 4, {"\xFF\xFF\0\xFF\x80\xFF"s, "\0\xFF\0\xFF\x40\xFF"s})},
    };
    for (const auto& [name, bytes] : files) {
        const Scene scene = import(name, bytes, {"heightfield,height=4,width=20"});
        EXPECT_EQ(scene.triangle_count(), 4u) << name;
        EXPECT_FLOAT_EQ(height_at(scene, -10, -5), 4) << name;
        EXPECT_FLOAT_EQ(height_at(scene, 0, -5), 0) << name;
        EXPECT_NEAR(height_at(scene, 10, -5), 2, 0.01) << name;
        EXPECT_NEAR(height_at(scene, 10, 5), 1, 0.01) << name;
        EXPECT_EQ(warns(scene, "in colour"), std::string(name) == "color.png");
        EXPECT_EQ(warns(scene, "alpha"), std::string(name) == "alpha.png");
    }
}

// Every triangle is seen from above, and normals are those of the slope.
TEST_F(HeightsAndPoints, ASlopeHasItsNormal) {
    const Scene scene = import("slope.pgm", "P2 4 3 3  0 1 2 3  0 1 2 3  0 1 2 3", {"heightfield,height=3"});
    ASSERT_EQ(scene.triangle_count(), 12u);
    EXPECT_NEAR(scene.surface_area(), 6 * std::sqrt(2.0), 1e-5);
    for (size_t t = 0; t < scene.triangles.size(); t += 3) {
        const float* p[3];
        for (size_t k = 0; k < 3; ++k) p[k] = &scene.positions[3 * size_t(scene.triangles[t + k])];
        EXPECT_GT((p[1][2] - p[0][2]) * (p[2][0] - p[0][0]) - (p[1][0] - p[0][0]) * (p[2][2] - p[0][2]), 0);
    }
    const Scene every_second =
        import("slope.pgm", "P2 5 3 4  0 1 2 3 4  0 1 2 3 4  0 1 2 3 4", {"heightfield,height=4,step=2"});
    EXPECT_EQ(every_second.triangle_count(), 4u);
    EXPECT_FLOAT_EQ(height_at(every_second, 2, 1), 4);
}

TEST_F(HeightsAndPoints, DamagedHeightsAreRefused) {
    expect_refused("a.pgm", "P5 300 300 255\nabc", "declares 90000 samples and has 3 bytes for them");
    expect_refused("a.pgm", "P2 2 2 9 1 2 3 x", "expected a sample");
    expect_refused("a.pgm", "P2 2 2 9 1 2 3 10", "found the sample 10, expected at most 9");
    expect_refused("a.pgm", "P2 0 2 9 1", "expected its width");
    expect_refused("a.pgm", "P6 2 2 9 1", "expected a PNG picture");
    expect_refused("a.pgm", "P2 1 2 9 1 2", "a terrain has an area");
    const std::string whole = png(2, 2, 8, 0, {"ab", "cd"});
    EXPECT_EQ(import("a.png", whole).triangle_count(), 2u);
    for (const size_t bytes : {size_t(9), size_t(30), whole.size() - 20})
        expect_refused("a.png", whole.substr(0, bytes), "damaged PNG");
}

// PTS, lines of colours with names on top, commas, and lines that hold normals.
TEST_F(HeightsAndPoints, PointsAreSpheresWithTheirColours) {
    const std::string red = "255 0 0", green = "0 255 0";
    const std::vector<std::pair<const char*, std::string>> files = {
        {"a.xyz", "0 0 0 " + red + "\n1 0 0 " + green + "\n2 0 0 " + red + "\n"},
        {"a.asc", "x;y;z;r;g;b\r\n0;0;0;255;0;0\r\n1;0;0;0;255;0\r\n2;0;0;255;0;0"},
        {"a.pts", "3\n0 0 0 -500 " + red + "\n1 0 0 20 " + green + "\n2 0 0 7 " + red + "\n"},
        {"a.ply",
         "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\nproperty uchar "
         "red\n"
         "property uchar green\nproperty uchar blue\nend_header\n0 0 0 " +
             red + "\n1 0 0 " + green + "\n2 0 0 " + red + "\n"},
    };
    for (const auto& [name, bytes] : files) {
        const Scene scene = import(name, bytes);
        ASSERT_EQ(scene.spheres.size(), 3u) << name;
        EXPECT_NEAR(scene.spheres[1].radius, 0.7072, 1e-4) << name;
        for (size_t i = 0; i < 3; ++i) {
            EXPECT_EQ(scene.spheres[i].center[0], float(i)) << name;
            const Material& material = scene.materials[scene.spheres[i].material];
            EXPECT_EQ(material.values.color[i == 1 ? 1 : 0], 1) << name;
            EXPECT_EQ(material.values.color[i == 1 ? 0 : 1], 0) << name;
        }
        EXPECT_EQ(scene.spheres[0].material, scene.spheres[2].material) << name;
    }
    const Scene normals = import("n.xyz", "0 0 0 0 0 1\n1 0 0 0.6 0 0.8\n", {"pointcloud,radius=.25"});
    EXPECT_EQ(normals.spheres[0].radius, 0.25f);
    EXPECT_TRUE(warns(normals, "takes x, y and z of each line"));
}

TEST_F(HeightsAndPoints, ManyColoursBecomeFewer) {
    std::string text;
    for (int i = 0; i < 40000; ++i)
        text += std::to_string(i % 200) + " " + std::to_string(i / 200) + " 0 " + std::to_string(i % 256) + " " +
                std::to_string(i / 256 % 256) + " 77\n";
    const Scene scene = import("many.xyz", text);
    EXPECT_EQ(scene.spheres.size(), 40000u);
    EXPECT_LE(scene.materials.size(), 32769u);
    EXPECT_TRUE(warns(scene, "has 40000 colours"));
    EXPECT_NEAR(scene.spheres[0].radius, 0.7072, 1e-3);
}

TEST_F(HeightsAndPoints, FarPointsKeepTheirDigits) {
    const Scene scene = import("utm.xyz", "500000.25 5400000.5 100\n500000.5 5400000.5 100\n500000.5 5400000.75 100\n");
    ASSERT_EQ(scene.spheres.size(), 3u);
    EXPECT_TRUE(warns(scene, "moved by"));
    EXPECT_EQ(scene.spheres[1].center[0] - scene.spheres[0].center[0], 0.25f);
    EXPECT_EQ(scene.spheres[2].center[1] - scene.spheres[1].center[1], 0.25f);
}

TEST_F(HeightsAndPoints, DamagedPointsAreRefused) {
    expect_refused("a.xyz", "0 0 0\n1 2\n", "line 2: found 2 numbers, expected 3 numbers of a point");
    expect_refused("a.xyz", "2\nwater\nO 0 0 0\n", "line 2: found 'water', expected 3 numbers");
    EXPECT_TRUE(warns(import("a.xyz", "0 0 0 1 2 3\n0 0 1\n"), "other numbers are left out"));
    expect_refused("a.xyz", "# nothing\n", "contains no points");
    expect_refused("a.xyz", "nan 0 0\n", "contains no points");
    const Scene scene = import("a.xyz", "0 0 0\nnan 0 0\n1 0 0\n");
    EXPECT_EQ(scene.spheres.size(), 2u);
    EXPECT_TRUE(warns(scene, "1 point left out"));
    const std::string head =
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    expect_refused("a.ply", head + "end_header\nabc", "cut off or damaged");
    // With faces, it is a mesh as before, also if there are none.
    EXPECT_EQ(
        import("mesh.ply",
               "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
               "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
            .triangle_count(),
        1u);
}

}  // namespace
}  // namespace clarity::test
