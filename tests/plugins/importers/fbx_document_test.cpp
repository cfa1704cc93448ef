// fbx_document_test.cpp -- the tree of an FBX file in each of its forms, and damage at each place of it.
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <random>

#include "../../../plugins/importers/fbx/document.hpp"
#include "fbx_writer.hpp"

namespace clarity::test {
namespace {

using fbx_import::Broken;
using fbx_import::Document;
using fbx_import::Node;

std::string deflated(const std::string& plain) {
    uLongf size = compressBound(plain.size());
    std::string out(size, '\0');
    compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(plain.data()), plain.size());
    out.resize(size);
    return out;
}

const std::vector<FbxForm> kForms = {{true, false, false, 7400},  {true, false, true, 7400},  {true, false, false, 7500},
                                     {true, true, true, 7500},    {true, true, false, 6100},  {true, false, false, 6100},
                                     {false, false, false, 7400}, {false, false, false, 6100}};

std::vector<FbxNode> nodes_of(int version) {
    return {{"FBXHeaderExtension", {}, {{"FBXVersion", {whole(version)}, {}}}},
            {"Objects",
             {},
             {{"Geometry",
               {whole(1), text("Geometry::Roof"), text("Mesh")},
               {{"Vertices", {std::vector<double>{0, 1.5, -2, 1e-3, 4, 5}}, {}},
                {"PolygonVertexIndex", {std::vector<int32_t>{0, 1, -3}}, {}}}}}},
            {"After", {text("last"), 2.5}, {}}};
}
std::string file_of(const FbxForm& form) {
    return FbxWriter(form, deflated).file(nodes_of(form.version));
}

// Asks for everything that the document has.
double read_all(const Document& document, const Node& node) {
    double sum = 0;
    for (const Node& child : document.children(node)) {
        for (size_t i = 0; i < 4; ++i) sum += document.number(&child, i, 0) + double(document.text(&child, i).size());
        if (child.name == "Vertices" || child.name == "a") {
            for (const float x : document.numbers<float>(&child)) sum += x;
        }
        if (child.name == "PolygonVertexIndex") sum += double(document.numbers<int32_t>(&child).size());
        sum += double(document.content(child).size()) + read_all(document, child);
    }
    return sum;
}

// Reads the file. Returns the message, or an empty string. A message must name a place and be readable.
std::string trouble(const std::string& bytes) {
    try {
        const Document document(bytes);
        read_all(document, document.root());
        return {};
    } catch (const Broken& broken) {
        const std::string why = broken.what();
        for (const char c : why) EXPECT_GE(c, ' ') << why;
        const bool has_place = why.find("byte ") == 0 || why.find("line ") == 0 || why.find("not an FBX file") == 0;
        EXPECT_TRUE(has_place || why == "the file is empty") << why;
        return why;
    }
}

TEST(FbxDocument, ReadsEachForm) {
    for (const FbxForm& form : kForms) {
        SCOPED_TRACE(std::to_string(form.version) + (form.binary ? " binary" : " ascii") + (form.big_endian ? " big" : ""));
        const std::string bytes = file_of(form);
        const Document document(bytes);
        EXPECT_EQ(document.version(), form.version);
        EXPECT_EQ(document.is_binary(), form.binary);
        EXPECT_EQ(document.is_big_endian(), form.big_endian);
        const Node* geometry = document.child(document.child(&document.root(), "Objects"), "Geometry");
        ASSERT_TRUE(geometry);
        EXPECT_EQ(document.integer(geometry, 0, -1), 1);
        EXPECT_EQ(document.text(geometry, 2), "Mesh");
        EXPECT_EQ(document.integer(geometry, 9, -1), -1);
        EXPECT_EQ(document.numbers<float>(geometry, "Vertices"), (std::vector<float>{0, 1.5f, -2, 1e-3f, 4, 5}));
        EXPECT_EQ(document.numbers<int32_t>(geometry, "PolygonVertexIndex"), (std::vector<int32_t>{0, 1, -3}));
        EXPECT_EQ(document.numbers<int64_t>(geometry, "Nothing"), std::vector<int64_t>());
        const Node* after = document.child(&document.root(), "After");
        EXPECT_EQ(document.text(after, 0), "last");
        EXPECT_EQ(document.number(after, 1, 0), 2.5);
    }
}

TEST(FbxDocument, IsCutAtEachPlace) {
    for (const FbxForm& form : kForms) {
        const std::string bytes = file_of(form);
        // Behind the last record only the empty one is missing, and behind the last line nothing.
        for (size_t size = 0; size < bytes.size(); ++size) trouble(bytes.substr(0, size));
        EXPECT_NE(trouble(bytes.substr(0, bytes.size() / 2)), "");
    }
}

TEST(FbxDocument, IsDamagedAtEachPlace) {
    std::mt19937 random(1);
    for (const FbxForm& form : kForms) {
        const std::string bytes = file_of(form);
        for (size_t at = 0; at < bytes.size(); ++at) {
            for (const int value : {0, 0xFF, 0x80, int(random() % 256)}) {
                std::string damaged = bytes;
                damaged[at] = static_cast<char>(value);
                trouble(damaged);
            }
        }
    }
}

std::string head(int version, bool big_endian = false) {
    return FbxWriter({true, big_endian, false, version}).file({}).substr(0, 27);
}
std::string little(uint32_t value) {
    return {reinterpret_cast<const char*>(&value), 4};
}

TEST(FbxDocument, SaysWhatIsWrongAndWhere) {
    const auto expect = [](const std::string& bytes, const std::string& part) {
        EXPECT_NE(trouble(bytes).find(part), std::string::npos) << trouble(bytes) << "\nexpected: " << part;
    };
    expect("", "empty");
    expect("\x89PNG....", "not an FBX file but a PNG picture: call it .png");
    expect(std::string("Kaydara FBX Binary  \n\x1A", 22) + "....", "header of this binary FBX file is damaged");
    expect(head(7400) + little(9999) + little(0) + little(0) + '\1' + "A", "byte 27: a record says that it ends at byte 9999");
    expect(head(7400) + little(45) + little(7) + little(4) + '\1' + "Abcde",
           "byte 27: the record 'A' says that it has 7 values");
    expect(head(7400) + little(43) + little(1) + little(2) + '\1' + "A?x", "has the type 63");
    expect("; FBX 7.4.0 project file\nObjects:  {\n\tA: \"open\n}\n", "line 3: found quotes that nothing closes");
    expect("; FBX 7.4.0 project file\nObjects:  {\n\tA: 1\n", "line 2: the file ends within this block, 'Objects'");
    expect("; FBX 7.4.0 project file\nObjects  {\n}\n", "line 2: found 'Objects  {'; expected a name and ':'");
    expect("; FBX 7.4.0 project file\nVertices: *2 {\n\ta: 1,x\n}\n", "line 3: found 'x' among the values of 'a'");
    expect("; FBX 7.4.0 project file\nVertices: *9 {\n\ta: 1,2\n}\n", "line 2: 'Vertices' declares 9 values, but has 2");
}

// Counts that the bytes cannot hold must not be believed: nothing of that size is allocated.
TEST(FbxDocument, BelievesNoCount) {
    const auto array = [](uint32_t count, uint32_t encoding, const std::string& bytes) {
        const std::string value = "d" + little(count) + little(encoding) + little(static_cast<uint32_t>(bytes.size())) + bytes;
        const uint32_t end = static_cast<uint32_t>(27 + 13 + 8 + value.size());
        return head(7400) + little(end) + little(1) + little(static_cast<uint32_t>(value.size())) + '\x8' + "Vertices" + value +
               std::string(13, '\0');
    };
    EXPECT_NE(trouble(array(0xFFFFFFFF, 0, "12345678")).find("declares 4294967295 values of 8 bytes"), std::string::npos);
    EXPECT_NE(trouble(array(0xFFFFFFFF, 1, "12345678")).find("declares 4294967295 values of 8 bytes"), std::string::npos);
    EXPECT_NE(trouble(array(2, 2, "12345678")).find("encoding 2; expected 0 (plain) or 1 (deflated)"), std::string::npos);
    const std::string plain(800, '\0');
    EXPECT_EQ(trouble(array(100, 1, deflated(plain))), "");
    EXPECT_NE(trouble(array(99, 1, deflated(plain))).find("hold more than the 99 values"), std::string::npos);
    EXPECT_NE(trouble(array(101, 1, deflated(plain))).find("end or are damaged after 100 of 101 values"), std::string::npos);
}

TEST(FbxDocument, NestsNoDeeperThanItMay) {
    FbxNode deep = {"A", {}, {}};
    for (int i = 0; i < 100; ++i) deep = {"A", {}, {deep}};
    for (const FbxForm& form : kForms) {
        EXPECT_NE(trouble(FbxWriter(form).file({deep})).find("nested more than 64 deep"), std::string::npos);
    }
}

TEST(FbxDocument, ReadsTextAsProgramsWriteIt) {
    const std::string bytes =
        "; FBX 6.1.0 project file\r\n"
        "Key: \r\n\t1924423250,-0.5,L\r\n\t,7,1e2,C,s ; a comment\r\n"
        "Name: \"a, {b}; \", T, +3\n"
        "Empty:  {\n}\nNext: 1.#INF, nan,\n\t-2\nContent: ,\n\t\"QUJD\",\n\t\"RA==\"\nLast: 5";
    const Document document(bytes);
    const Node* key = document.child(&document.root(), "Key");
    EXPECT_EQ(document.integer(key, 0, 0), 1924423250);
    EXPECT_EQ(document.text(key, 2), "L");
    EXPECT_EQ(document.number(key, 4, 0), 100);
    EXPECT_EQ(document.text(key, 6), "s");
    EXPECT_EQ(document.value(*key, 7).kind, fbx_import::Value::none);
    const Node* name = document.child(&document.root(), "Name");
    EXPECT_EQ(document.text(name, 0), "a, {b}; ");
    EXPECT_EQ(document.text(name, 1), "T");
    EXPECT_EQ(document.integer(name, 2, 0), 3);
    const std::vector<double> next = document.numbers<double>(&document.root(), "Next");
    ASSERT_EQ(next.size(), 3u);
    EXPECT_TRUE(std::isnan(next[0]) && std::isnan(next[1]));
    EXPECT_EQ(next[2], -2);
    EXPECT_EQ(document.content(*document.child(&document.root(), "Content")), "ABCD");
    EXPECT_EQ(document.integer(document.child(&document.root(), "Last"), 0, 0), 5);
    EXPECT_EQ(document.version(), 6100);
}

std::string with_ends(const std::string& text, const std::string& end) {
    std::string out;
    for (const char c : text) out += c == '\n' ? end : std::string(1, c);
    return out;
}

// Each of these lists means 1, 2, 3, -4, with each end of line, behind a byte order mark and not.
TEST(FbxDocument, BreaksListsWhereProgramsDo) {
    for (const char* const list :
         {"1,2,3,-4", "1,2,\n3,-4", "1,2\n3,-4", "1,2\n,3,-4", "1\n2\n3\n-4", "1,2\n\n\n,\n3,-4", "\n1,2,3,-4",
          "1,2, ; the first two\n3,-4", "1,2 ; a: 5, {\n\t3,-4", "1,2\n; a line: of { its own\n3,-4",
          "; first\n1,2,3,-4 ; last", "1 , 2 , 3 , -4", "1 2 3 -4", "1,2,3,-4,", "+1,2e0,\t3.0,-4.", "1,2,3\n\t-4\n\t"}) {
        const std::string text = "; FBX 7.4.0 project file\nObjects:  {\n\tVertices: *4 {\n\t\ta: " + std::string(list) +
                                 "\n\t} \n\tEdges: *1\n\t{ a: 7 }\n\tPolygons: " + list + "\n\tLast: 5\n}\n";
        for (const char* const end : {"\n", "\r\n", "\r"}) {
            for (const char* const mark : {"", "\xEF\xBB\xBF"}) {
                SCOPED_TRACE(list + std::string(mark) + std::to_string(end[0]) + std::to_string(end[1]));
                const std::string bytes = mark + with_ends(text, end);
                const Document document(bytes);
                const Node* objects = document.child(&document.root(), "Objects");
                EXPECT_EQ(document.numbers<int32_t>(objects, "Vertices"), (std::vector<int32_t>{1, 2, 3, -4}));
                EXPECT_EQ(document.numbers<double>(objects, "Edges"), std::vector<double>{7});
                EXPECT_EQ(document.numbers<float>(objects, "Polygons"), (std::vector<float>{1, 2, 3, -4}));
                EXPECT_EQ(document.integer(document.child(objects, "Last"), 0, 0), 5);
            }
        }
    }
}

TEST(FbxDocument, TakesWordsOfTheFormatInNamesAndComments) {
    const std::string bytes =
        "; FBX: *4 {\nHead: 1\nModel: 3, \"Model::a; b { } , Model: 5 # *2\", \"x\" { ; { \n\tInner: ; 1\n\t}\n"
        "Shading: T ; Culling: 7\nPath: C:\\a\\b.png, D:x\nTime: 12:30:05\nVersion: 2 Next: 3\n\tLast: \"a\nb\"";
    const Document document(bytes + std::string(3, '\0'));
    const auto value = [&](const char* name, size_t i) { return document.text(document.child(&document.root(), name), i); };
    EXPECT_EQ(value("Model", 1), "Model::a; b { } , Model: 5 # *2");
    EXPECT_TRUE(document.child(document.child(&document.root(), "Model"), "Inner"));
    EXPECT_EQ(value("Shading", 0), "T");
    EXPECT_FALSE(document.child(&document.root(), "Culling"));
    EXPECT_EQ(value("Path", 0), "C:\\a\\b.png");
    EXPECT_EQ(value("Path", 1), "D:x");
    EXPECT_EQ(value("Time", 0), "12:30:05");
    EXPECT_EQ(document.integer(document.child(&document.root(), "Version"), 0, 0), 2);
    EXPECT_EQ(document.integer(document.child(&document.root(), "Next"), 0, 0), 3);
    EXPECT_EQ(value("Last", 0), "a\nb");
}

// Base64 may be cut anywhere, also within the digits of one byte.
TEST(FbxDocument, JoinsContentInPieces) {
    for (const char* const pieces : {"\"QUJDRA==\"", ",\n\t\"QUJD\",\n\t\"RA==\"", "\"QUJ\"\n\"DRA==\"",
                                     "\"Q\",\"UJDR\",\"A==\"", "\"QUJDRA=\",\"=\"", "\"QUJD\nRA==\"", "\"QQ==\", \"QkNE\""}) {
        const std::string bytes = "; FBX 7.4.0 project file\nContent: " + std::string(pieces) + "\nLast: 1\n";
        const Document document(bytes);
        EXPECT_EQ(document.content(*document.child(&document.root(), "Content")), "ABCD") << pieces;
    }
}

// In time that is linear in their length, or this test takes hours.
TEST(FbxDocument, PassesManyOfOneCharacter) {
    for (const char* const part :
         {":", ": ", "a:", " :a", ",", "\n", "\n,", ";", "-", "1 ", "\"\"", "; \r", "{}", "*", "a\n:"}) {
        std::string bytes = "; FBX 7.4.0 project file\nA: 1";
        while (bytes.size() < 1u << 20) bytes += part;
        trouble(bytes);
    }
}

TEST(FbxDocument, CountsLinesOfEachKindInMessages) {
    for (const char* const end : {"\n", "\r\n", "\r"}) {
        const std::string why = trouble(with_ends("; FBX 7.4.0 project file\n\nVertices: *2 {\n\ta: 1,x\n}\n", end));
        EXPECT_NE(why.find("line 4: found 'x'"), std::string::npos) << why;
    }
}

}  // namespace
}  // namespace clarity::test
