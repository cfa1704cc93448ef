// hostile_models_test.cpp -- files made to do harm. Each may cost one message and a few seconds, but must not end the program.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>

#include "base/error.hpp"
#include "measure.hpp"
#include "support/clock.hpp"

namespace clarity::test {
namespace {

class HostileModel : public testing::Test {
 protected:
    // Returns the message of the failed import, or an empty string if the file was imported.
    std::string refusal(const std::string& name, const std::string& bytes) {
        const std::string path = folder_.write(name, bytes);
        const auto start = std::chrono::steady_clock::now();
        std::string message;
        try {
            const Scene scene = import_file(path);
            EXPECT_EQ(validate(scene), "");
        } catch (const Error& error) {
            message = error.what();
            EXPECT_EQ(error.code(), Exit::import_failed) << message;
            EXPECT_NE(message.find(name), message.npos) << message;
            EXPECT_EQ(message.find('\n'), message.npos) << message;
        }
        EXPECT_LT(seconds_since(start), at_most(kSecondsAtMost)) << name;
        rusage children{};
        getrusage(RUSAGE_CHILDREN, &children);
        EXPECT_LT(children.ru_maxrss, 2L << 20) << name;
        return message;
    }
    void expect_refused(const std::string& name, const std::string& bytes, const std::string& part_of_reason) {
        if (!has_importer_for(name)) GTEST_SKIP() << "SKIPPED: the importer for " << name << " was not built";
        const std::string message = refusal(name, bytes);
        EXPECT_FALSE(message.empty()) << name << " was imported";
        EXPECT_NE(message.find(part_of_reason), message.npos) << message;
    }

 private:
    Scratch folder_;
};

const std::string kPlyVertices =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";

TEST_F(HostileModel, PlyHeaderWithoutEnd) {
    expect_refused("twice.ply",
                   kPlyVertices + "element face 0\nproperty list uint int vertex_indices\nproperty list uchar float s\n" +
                       "element face 1\nproperty list uint int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
                   "two elements 'face'");
    expect_refused("endless.ply", kPlyVertices + "element face 1\n", "no end");
}
TEST_F(HostileModel, PlyFaceOfFourBillionCorners) {
    expect_refused(
        "corners.ply",
        kPlyVertices +
            "element face 1\nproperty list uint int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n4294967295 0 1 2\n",
        "0 of 1 faces");
}
TEST_F(HostileModel, BinaryPlyFaceOfFourBillionCorners) {
    std::string bytes =
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uint int vertex_indices\nend_header\n";
    bytes += std::string(36, '\0') + "\xFF\xFF\xFF\x7F" + std::string(12, '\0');
    expect_refused("corners_binary.ply", bytes, "0 of 1 faces");
}
TEST_F(HostileModel, PlyListsOfFourBillionValues) {
    const std::string faces = "element face 1\nproperty list uint int vertex_indices\nproperty list uint float s\nend_header\n";
    expect_refused("list.ply", kPlyVertices + faces + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 4294967295 1 2 3\n",
                   "line 14: 'face' 1 of 1: a list of '4294967295' values, more than the file can hold");
    for (const bool big_endian : {false, true}) {
        std::string bytes = kPlyVertices + faces + std::string(36, '\0');
        const std::string form = big_endian ? "binary_big_endian" : "binary_little_endian";
        bytes.replace(bytes.find("ascii"), 5, form);
        const std::string head = std::to_string(bytes.size() + 20);
        bytes += big_endian ? std::string("\0\0\0\3", 4) : std::string("\3\0\0\0", 4);
        bytes += std::string(12, '\0') + "\xFF\xFF\xFF\xFF" + std::string(12, '\0');
        expect_refused(form + ".ply", bytes,
                       "byte " + head + ": 'face' 1: a list of 4294967295 values, but only 12 bytes follow");
    }
}
TEST_F(HostileModel, PlyNamesThatCannotBePrinted) {
    std::string bytes = kPlyVertices + "element fa\x7F\xFF 1\nproperty int a\n" +
                        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
    expect_refused("words.ply", bytes + "one\n3 0 1 2\n", "line 15: 'fa?");
    bytes.replace(bytes.find("\xFF 1"), 3, "\xFF 1000");
    expect_refused("counts.ply", bytes, "declares 1000 elements 'fa");
}
TEST_F(HostileModel, PlyCountsBeyondTheFile) {
    expect_refused(
        "counts.ply",
        kPlyVertices + "element face 2000000000\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n",
        "declares 2000000000");
}
TEST_F(HostileModel, PlyOfWords) {
    expect_refused(
        "words.ply",
        kPlyVertices + "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 zero\n1 0 0\n0 1 0\n3 0 1 2\n",
        "'zero'");
}
TEST_F(HostileModel, OffCountsBeyondTheFile) {
    expect_refused("counts.off", "OFF\n4000000000 4000000000 0\n0 0 0\n", "declares 4000000000");
}
TEST_F(HostileModel, OffFaceOfManyCorners) {
    expect_refused("corners.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n", "a face of 4000000000 corners has 3");
}
TEST_F(HostileModel, OffIndicesOutOfRange) {
    expect_refused("range.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 99999999999\n", "and there are 3");
}
TEST_F(HostileModel, ObjIndicesOutOfRange) {
    expect_refused("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2000000000\nf 1 2 99999999999999999999\nf 0 1 2\nf -9 1 2\n",
                   "2000000000");
}
TEST_F(HostileModel, ObjSlashesOnly) {
    expect_refused("slashes.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf / / /\nf /1 /2 /3\nf //1 //2 //3\n", "line 4");
}
TEST_F(HostileModel, ObjOneLongLine) {
    const std::string message = refusal("long.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3" + std::string(20000000, ' ') + "\n");
    EXPECT_EQ(message, "");
}
TEST_F(HostileModel, StlTextThatStops) {
    expect_refused("stops.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n", "cut off");
}
TEST_F(HostileModel, OmCountsBeyondTheFile) {
    expect_refused("counts.om", std::string("OMT\x20\xFF\xFF\xFF\x7F\xFF\xFF\xFF\x7F\xFF\xFF\xFF\x7F", 16), "declares");
}

TEST_F(HostileModel, OmChunkOfAnotherKind) {
    // The positions have two dimensions. Debian's OpenMesh ends the process by an assertion.
    const std::string header("OMPB\3\0\0\0\1\0\0\0\3\0\0\0", 16), chunk("\0\x0E\0\0", 4);
    expect_refused("chunk.om", header + chunk + std::string(96, '\0'), "chunk.om: ");
}

const std::string kFbxHead =
    "; FBX 7.4.0 project file\nFBXHeaderExtension:  {\n\tFBXHeaderVersion: 1003\n\tFBXVersion: 7400\n}\n";

TEST_F(HostileModel, FbxBlocksNestedDeep) {
    std::string bytes = kFbxHead + "Objects:  {\n";
    for (int i = 0; i < 200000; ++i) bytes += "A:  {\n";
    EXPECT_NE(refusal("nested.fbx", bytes), "");
}
TEST_F(HostileModel, FbxNodesNestedDeep) {
    std::string objects, connections;
    for (int i = 1; i <= 100000; ++i) {
        const std::string id = std::to_string(i);
        objects += "\tModel: " + id + ", \"Model::N" + id + "\", \"Null\" {\n\t\tVersion: 232\n\t}\n";
        connections += "\tC: \"OO\"," + id + "," + std::to_string(i - 1) + "\n";
    }
    EXPECT_NE(refusal("deep.fbx", kFbxHead + "Objects:  {\n" + objects + "}\nConnections:  {\n" + connections + "}\n"), "");
}
TEST_F(HostileModel, FbxNodesInACircleBelowTheRoot) {
    const std::string bytes = kFbxHead +
                              "Objects:  {\n\tModel: 1, \"Model::A\", \"Null\" {\n\t\tVersion: 232\n\t}\n"
                              "\tModel: 2, \"Model::B\", \"Null\" {\n\t\tVersion: 232\n\t}\n}\n"
                              "Connections:  {\n\tC: \"OO\",1,0\n\tC: \"OO\",2,1\n\tC: \"OO\",1,2\n}\n";
    EXPECT_NE(refusal("circle.fbx", bytes), "");
}
TEST_F(HostileModel, GltfBuffersBeyondTheFile) {
    const std::string bytes = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
                              R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
                              R"("accessors":[{"bufferView":0,"componentType":5126,"count":4000000000,"type":"VEC3"}],)"
                              R"("bufferViews":[{"buffer":0,"byteLength":4000000000}],)"
                              R"("buffers":[{"byteLength":12,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAA"}]})";
    expect_refused("buffers.gltf", bytes, "bufferViews[0]: found 4000000000 bytes");
}
TEST_F(HostileModel, GltfNodesInACircle) {
    const std::string bytes =
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"children":[1]},{"children":[0]}]})";
    expect_refused("circle.gltf", bytes, "child of nodes[1]");
}
}  // namespace
}  // namespace clarity::test
