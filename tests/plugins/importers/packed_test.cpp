// packed_test.cpp -- files that are packed with gzip: for every importer, loaded by other files, damaged, and made to fill the
// memory.
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "base/error.hpp"
#include "base/files/packed_file.hpp"
#include "import/import.hpp"
#include "measure.hpp"
#include "support/errors.hpp"

namespace clarity::test {
namespace {

// `piece`, `times` times, as one part of a gzip file.
std::string packed(const std::string& piece, size_t times = 1) {
    z_stream stream{};
    deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, MAX_WBITS + 16, 8, Z_DEFAULT_STRATEGY);
    std::string out;
    char buffer[1 << 16];
    for (size_t i = 0; i < times; ++i) {
        stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(piece.data()));
        stream.avail_in = static_cast<uInt>(piece.size());
        do {
            stream.next_out = reinterpret_cast<Bytef*>(buffer);
            stream.avail_out = sizeof buffer;
            deflate(&stream, i + 1 == times ? Z_FINISH : Z_NO_FLUSH);
            out.append(buffer, sizeof buffer - stream.avail_out);
        } while (stream.avail_out == 0);
    }
    deflateEnd(&stream);
    return out;
}

std::string content_of(const std::string& name) {
    std::ifstream file(CLARITY_SOURCE_DIR "/tests/plugins/importers/data/" + name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::string refusal(const std::string& path) {
    try {
        import_file(path);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), Exit::import_failed);
        EXPECT_EQ(std::string(error.what()).compare(0, path.size() + 1, path + ":"), 0) << error.what();
        return error.what();
    }
    return "";
}

TEST(PackedFile, IsReadByEveryImporter) {
    for (const char* name : {"polygons.obj", "roof.ply", "roof.off", "roof.stl", "nodes.gltf", "nodes.fbx", "box.dae"}) {
        if (!has_importer_for(name)) continue;
        const Scratch folder;
        folder.write("polygons.mtl", content_of("polygons.mtl"));
        const Scene plain = import_file(folder.write(name, content_of(name)));
        const std::string path = folder.write(std::string(name) + ".gz", packed(content_of(name)));
        const Scene scene = import_file(path);
        EXPECT_GT(scene.triangle_count(), 0u) << name;
        EXPECT_EQ(scene.triangle_count(), plain.triangle_count()) << name;
        EXPECT_EQ(scene.surface_area(), plain.surface_area()) << name;
        EXPECT_EQ(scene.materials.size(), plain.materials.size()) << name << ": its materials lie beside it";
        EXPECT_EQ(scene.warnings.size(), plain.warnings.size()) << name;
        for (const std::string& warning : scene.warnings)
            EXPECT_EQ(warning.compare(0, path.size() + 1, path + ":"), 0) << warning;
        EXPECT_EQ(scene.instances[0].name, plain.instances[0].name) << name;
        EXPECT_NE(std::find(scene.sources.begin(), scene.sources.end(), path), scene.sources.end())
            << "sources name the file itself";
    }
}

TEST(PackedFile, IsLoadedByOtherFiles) {
    const Scratch folder;
    folder.write("roof.ply.gz", packed(content_of("roof.ply")));
    const std::string text = "load roof.ply.gz\nload roof.ply.gz\n";
    EXPECT_EQ(import_file(folder.write("two.scene", text)).instances.size(), 2u);
    EXPECT_EQ(import_file(folder.write("two.scene.gz", packed(text))).instances.size(), 2u);
    const std::string path = folder.write("bad.scene.gz", packed("light position 0 0 0\nwrong 1\n"));
    EXPECT_NE(refusal(folder.write("deep.scene", "load bad.scene.gz\n")).find("bad.scene.gz"), std::string::npos);
    EXPECT_EQ(expect_error([&] { import_file(path); }, {}).compare(0, path.size() + 1, path + ":"), 0);
}

TEST(PackedFile, MayHaveAnyNameAndSeveralParts) {
    const Scratch folder;
    const std::string plain = content_of("roof.stl"), half = plain.substr(0, plain.size() / 2);
    EXPECT_EQ(import_file(folder.write("roof.stl", packed(plain))).triangle_count(), 2u);
    EXPECT_EQ(import_file(folder.write("ROOF.STL.GZ", packed(plain))).triangle_count(), 2u);
    EXPECT_EQ(import_file(folder.write("parts.stl.gz", packed(half) + packed(plain.substr(half.size())))).triangle_count(), 2u);
    EXPECT_EQ(import_file(folder.write("zeros.stl.gz", packed(plain) + std::string(100, '\0'))).triangle_count(), 2u);
}

TEST(PackedFile, ThatIsDamagedIsOneClearMessage) {
    const Scratch folder;
    const std::string whole = packed(content_of("polygons.obj"));
    EXPECT_NE(refusal(folder.write("a.obj.gz", whole.substr(0, whole.size() / 2))).find("end too early"), std::string::npos);
    EXPECT_NE(refusal(folder.write("b.obj.gz", whole.substr(0, whole.size() - 8) + "12345678")).find("damaged"),
              std::string::npos);
    EXPECT_NE(refusal(folder.write("c.obj.gz", content_of("polygons.obj"))).find("is no gzip file"), std::string::npos);
    EXPECT_NE(refusal(folder.write("d.obj.gz", packed(""))).find("nothing is in it"), std::string::npos);
    EXPECT_NE(refusal(folder.write("e.obj.gz", whole.substr(0, 5))).find("gzip"), std::string::npos);
    EXPECT_NE(refusal(folder.write("f.abc.gz", packed("abc"))).find("no importer reads"), std::string::npos);
    for (size_t at = 10; at < whole.size(); at += 7) {
        std::string bytes = whole;
        bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
        EXPECT_NE(refusal(folder.write("g.obj.gz", bytes)).find("gzip"), std::string::npos) << at;
    }
}

TEST(PackedFile, ThatFillsTheMemoryIsStopped) {
    const Scratch folder;
    // 1.1 GiB of zeros in a megabyte, also with a size at its end that says less.
    std::string bytes = packed(std::string(1 << 20, '\0'), 1130);
    ASSERT_LT(bytes.size(), size_t(2) << 20);
    EXPECT_NE(refusal(folder.write("a.obj.gz", bytes)).find("unpacks to more than"), std::string::npos);
    std::fill(bytes.end() - 4, bytes.end(), '\0');
    EXPECT_NE(refusal(folder.write("b.ply.gz", bytes)).find("unpacks to more than"), std::string::npos);
}

}  // namespace
}  // namespace clarity::test
