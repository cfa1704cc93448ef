// messages_test.cpp -- damages files in many ways, the same in every run, and reads the messages. Each must be one that a user
// can act on: with the file, in words of ours, and for formats that we check ourselves with the place and with what was
// expected.
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <random>
#include <regex>

#include "base/error.hpp"
#include "import/import.hpp"
#include "measure.hpp"
#include "support/errors.hpp"

namespace clarity::test {
namespace {

#ifndef CLARITY_MUTATIONS
#define CLARITY_MUTATIONS 60  // of each seed; the long test has more
#endif

std::string read_file(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::string little_endian(uint32_t value, size_t bytes) {
    std::string out;
    for (size_t i = 0; i < bytes; ++i) out += static_cast<char>(value >> (8 * i));
    return out;
}

std::string chunk_3ds(uint32_t kind, const std::string& content) {
    return little_endian(kind, 2) + little_endian(static_cast<uint32_t>(content.size() + 6), 4) + content;
}

std::string model_3ds() {
    const std::string vertices = little_endian(4, 2) + floats({0, 0, 0, 1, 0, 1, 2, 0, 0, 0, 1, 0});
    std::string faces = little_endian(2, 2);
    for (const uint32_t number : {0, 1, 2, 0, 0, 2, 3, 0}) faces += little_endian(number, 2);
    const std::string mesh = chunk_3ds(0x4100, chunk_3ds(0x4110, vertices) + chunk_3ds(0x4120, faces));
    return chunk_3ds(0x4D4D,
                     chunk_3ds(2, little_endian(3, 4)) + chunk_3ds(0x3D3D, chunk_3ds(0x4000, std::string("roof\0", 5) + mesh)));
}

std::string binary_stl() {
    std::string bytes(80, ' ');
    bytes += little_endian(2, 4);
    for (int i = 0; i < 2; ++i) bytes += floats({0, 0, 1, 0, 0, 0, 1, 0, 0, 1, float(i + 1), 0}) + std::string(2, '\0');
    return bytes;
}

std::string binary_ply() {
    return "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 1\nproperty list uchar int vertex_indices\nend_header\n" +
           floats({0, 0, 0, 1, 0, 0, 0, 1, 0}) + "\3" + little_endian(0, 4) + little_endian(1, 4) + little_endian(2, 4);
}

std::string as_glb(std::string json) {
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const auto size = static_cast<uint32_t>(json.size());
    return "glTF" + little_endian(2, 4) + little_endian(size + 20, 4) + little_endian(size, 4) + "JSON" + json;
}

class Mutator {
 public:
    explicit Mutator(uint32_t seed) : random_(seed) {}
    std::string mutate(std::string bytes) {
        static const char* const words[] = {"4294967295",           "-1",   "\x01\x02", "nan",  "<", "{", "\"",
                                            "99999999999999999999", "\xFF", ",",        "1e400"};
        const size_t at = below(bytes.size()), length = 1 + below(std::min<size_t>(40, bytes.size() - at));
        switch (below(8)) {
            case 0:
                return bytes.erase(at, 1);
            case 1:
                return bytes[at] = static_cast<char>(below(256)), bytes;
            case 2:
                return bytes.substr(0, at);
            case 3:
                return bytes.insert(at, words[below(std::size(words))]);
            case 4:
                return bytes.erase(at, length);
            case 5:
                return bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8))), bytes;
            case 6:
                return bytes.insert(at, bytes.substr(at, length));
            default:
                return mark(bytes, at);
        }
    }

 private:
    size_t below(size_t count) { return random_() % count; }
    // Removes the next sign that holds a text together, or makes the next number huge.
    std::string mark(std::string bytes, size_t at) {
        const size_t sign = bytes.find_first_of(below(2) ? ",:{}[]\"</>=" : "0123456789", at);
        if (sign == bytes.npos) return bytes.substr(0, at);
        return std::strchr("0123456789", bytes[sign]) ? bytes.insert(sign, "99999999") : bytes.erase(sign, 1);
    }
    std::mt19937 random_;
};

// The message without what it quotes from the file, which may be anything.
std::string own_words(const std::string& message) {
    const size_t first = message.find('\''), last = message.rfind('\'');
    return first == last ? message : message.substr(0, first) + message.substr(last + 1);
}

void expect_readable(const std::string& message) {
    for (const char c : message)
        EXPECT_TRUE(static_cast<unsigned char>(c) >= ' ' && c != 0x7F) << "control byte in: " << message;
    const std::string words = own_words(message);
    for (const char* bad : {"std::", "vector::", "basic_string", "bad_alloc", "exception", "No suitable reader", "nknown error",
                            "nknown type", "out of memory", "does not say why"}) {
        EXPECT_EQ(words.find(bad), words.npos) << "a library speaks, not we: " << message;
    }
}

struct Seed {
    std::string extension, bytes;
    bool has_places;  // each refusal has a place, what was found and what was expected
};

class Messages : public testing::TestWithParam<const char*> {};

Seed seed_of(const std::string& name) {
    const std::string data = CLARITY_SOURCE_DIR "/tests/plugins/importers/data/";
    if (name == "glb") return {"glb", as_glb(read_file(data + "nodes.gltf")), true};
    if (name == "3ds") return {"3ds", model_3ds(), false};
    if (name == "binary_stl") return {"stl", binary_stl(), false};
    if (name == "binary_ply") return {"ply", binary_ply(), false};
    const std::string extension = name.substr(name.rfind('.') + 1);
    return {extension, read_file(data + name), extension == "gltf"};
}

TEST_P(Messages, CanBeActedOn) {
    const Seed seed = seed_of(GetParam());
    ASSERT_FALSE(seed.bytes.empty());
    if (!has_importer_for("a." + seed.extension))
        GTEST_SKIP() << "SKIPPED: the importer for " << seed.extension << " was not built";
    // Importers of ours run in this process, which saves the start of a worker. A library's may crash, and the host then says
    // so in words of its own.
    import::ImportOptions options;
    options.in_process = seed.extension != "dae" && seed.extension != "3ds";
    options.log_warnings = false;
    static const PluginRegistry plugins = PluginRegistry::discover();
    const int count = options.in_process ? CLARITY_MUTATIONS : CLARITY_MUTATIONS / 2;
    // A file of which only faces without corners are left is sound to its importer; the host refuses it, and says what the
    // faces lack.
    const std::regex faceless("nothing of it can be used: \\d+ of \\d+ faces .*");
    const std::regex place("(line \\d+, column \\d+|byte \\d+|[a-zA-Z_0-9.\\[\\]]+|the top level).*: found .*, expected .*");
    const Scratch folder;
    int refused = 0;
    for (int i = 0; i < count; ++i) {
        const std::string name = "damaged." + seed.extension, bytes = Mutator(static_cast<uint32_t>(i)).mutate(seed.bytes);
        try {
            Progress progress;
            const Scene scene = import::import_scene(plugins, {folder.write(name, bytes)}, options, progress);
            for (const std::string& warning : scene.warnings) expect_readable(warning);
        } catch (const Error& error) {
            ++refused;
            const std::string message = error.what();
            const size_t at = message.find(name + ": ");
            EXPECT_NE(at, message.npos) << message;
            expect_readable(message);
            if (seed.has_places && bytes.size() > 0) {
                const std::string reason = message.substr(at == message.npos ? 0 : at + name.size() + 2);
                EXPECT_TRUE(std::regex_match(reason, place) || std::regex_match(reason, faceless))
                    << "without place, found or expected: " << message;
            }
        }
        if (HasFailure()) {
            ADD_FAILURE() << "mutation " << i;
            break;
        }
    }
    RecordProperty("refused", refused);
    if (seed.has_places) {
        EXPECT_GT(refused, count / 4);
    }
}

std::string repeated(const std::string& text, int times) {
    std::string out;
    for (int i = 0; i < times; ++i) out += text;
    return out;
}

// What would crash assimp is refused with its place, and assimp's own words say why it refuses the rest.
TEST(ColladaMessages, SayWhatIsWrong) {
    if (!has_importer_for("a.dae")) GTEST_SKIP() << "SKIPPED: the importer for dae was not built";
#ifdef __SANITIZE_THREAD__
    GTEST_SKIP() << "SKIPPED: with this sanitizer's memory, assimp does not crash";
#endif
    const std::string good = seed_of("box.dae").bytes;
    const Scratch folder;
    const auto expect = [&](const std::string& what, const std::string& instead, const std::string& why) {
        std::string bytes = good;
        const size_t at = bytes.find(what);
        ASSERT_NE(at, bytes.npos) << what;
        expect_error([&] { import_file(folder.write("damaged.dae", bytes.replace(at, what.size(), instead))); },
                     {"damaged.dae: " + why});
    };
    expect("stride=\"3\"", "stride=\"999999993\"",
           "line 30, column 14: found an <accessor> to 6 elements of 999999993 numbers from the number 0 on, expected elements "
           "within the 18 numbers of '#roof-array'");
    expect("count=\"18\">0 0 0 1 0 1 2 0 0 0 1 0 1 1 1 2 1 0</float_array>", "count=\"0\"/>",
           "line 30, column 14: found an <accessor> to 6 elements");
    expect("roof-array\" count", "roof-array\" uount", "line 28, column 12: found <float_array> without 'count'");
    expect("0 1 0 1 2", "0 <!-- > --> 1 0 1",
           "line 30, column 14: found an <accessor> to 6 elements of 3 numbers from the number 0 on, "
           "expected elements within the 17 numbers");
    expect("<mesh>", "<mesh>" + repeated("<a b='>'>", 1000),
           "line 26, column 8978: found another level, expected at most 1000");
    expect("<polylist material=\"paint\" count=\"2\"", "<polylist material=\"paint\" count=\"999999992\"",
           "found a number that counts more than the file can hold");
    expect("0 1 4 3 1", "0 1 81 3 1", "assimp cannot read it: Invalid data index (81/6) in primitive specification");
    expect("semantic=\"POSITION\" source", "semantic=\"POSITION\" _ource", "assimp cannot read it: Unknown reference format");
    expect("semantic=\"VERTEX\"", "semantic=\"VETEX\"", "assimp cannot read it: Invalid data index");
    expect("</vertices>", "! </vertices>", "assimp cannot read it: Unexpected sub element <> in tag <vertices>");
    expect("<color>0.8", "<color>0X8", "assimp cannot read it: Cannot parse string \"X8 0.1 0.1 1\" as a real number");
    expect("visual_scene url", "visual_scene rl", "assimp cannot read it: Unknown reference format in <instance_visual_scene>");
    expect("0 0 0 1 0 1 2", "0 0 0 \x01 0 1 2", "assimp cannot read it: Cannot parse string \"? 0 1 2 0");
    for (const char* const broken : {"<geometry 1d", "</geometry", "<geometry id=\"roof", "<!- Made"})
        expect("<geometry id", broken, "assimp cannot read it: Unable to read file, malformed XML");
}

INSTANTIATE_TEST_SUITE_P(Formats, Messages,
                         testing::Values("nodes.gltf", "glb", "polygons.obj", "roof.ply", "binary_ply", "roof.off", "roof.stl",
                                         "binary_stl", "box.dae", "3ds"),
                         [](const auto& about) { return test_name(about.param); });

}  // namespace
}  // namespace clarity::test
