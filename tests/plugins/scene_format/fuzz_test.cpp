// Mutations of valid scenes, and noise; both the same in every run. For any bytes, the importer must soon return a valid scene,
// or errors with their places. Builds with sanitizers run this test too.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "recorder.hpp"

namespace {

const char* const kSeed = R"(# every statement
camera main eye 0 2 8 target 0 1 0 up 0 1 0 fov 45
light point position 5 10 5 color 1 1 1 intensity 2 name key
light directional direction 0 -1 .5 color .5
background 0.2 0.3 0.5
ambient .1
sky "room.hdr" rotate 90 strength 2 visible false
material glass color .9 1 1 reflect .1 refract .9 ior 1.5 specular 1 shininess 100 emission 0
material "wood floor" texture "tex/wood floor.png" wrap clamp mirror checker
sphere center 0 1 0 radius 1 material glass
plane normal 0 1 0 offset 0 material "wood floor"
polygon material glass vertices 0 0 0  2 0 0  2 2 0  0 2 0
triangle vertices 0 0 0 1 0 0 0 1 0 material glass
load "car.fbx" translate 1 0 0 rotate 0 1 0 45 scale .01 material glass name car
animate car translate 0 0 0 0  2 1 0 0
)";

const char* const kWords[] = {"sphere",
                              "polygon",
                              "vertices",
                              "material",
                              "load",
                              "\"",
                              "#",
                              "\n",
                              "\r\n",
                              "\t",
                              "nan",
                              "-inf",
                              "1e308",
                              "-1e-308",
                              "1e18",
                              "-0",
                              "0",
                              "+",
                              "-",
                              ".",
                              "e",
                              "0x7f",
                              "1e",
                              "99999999999999999999",
                              "\xFF",
                              "\xC3",
                              "\xEF\xBB\xBF",
                              "\x01",
                              "\x7F",
                              "\xED\xA0\x80",
                              "name name name",
                              "eye",
                              "scale 0",
                              "rotate 0 0 0 1",
                              "glass",
                              "\"\"",
                              "camera camera",
                              "1 2 3 4 5 6 7 8 9 10 11 12"};

class Mutator {
 public:
    explicit Mutator(uint32_t seed) : random_(seed) {}

    size_t below(size_t count) { return count == 0 ? 0 : random_() % count; }

    void mutate(std::string& text) {
        const size_t at = below(text.size() + 1);
        const size_t length = std::min(below(12), text.size() - at);
        switch (below(8)) {
            case 0:
                if (at < text.size()) text[at] = static_cast<char>(below(256));
                break;
            case 1:
                text.insert(at, 1, static_cast<char>(below(256)));
                break;
            case 2:
                text.erase(at, length);
                break;
            case 3:
                text.insert(below(text.size() + 1), text.substr(at, length));
                break;
            case 4:
                text.insert(at, std::string(" ") + kWords[below(std::size(kWords))] + " ");
                break;
            case 5:
                text.replace(at, length, kWords[below(std::size(kWords))]);
                break;
            case 6: {  // swap the halves of a line or two
                const size_t end = std::min(text.size(), at + below(120));
                text = text.substr(0, at) + text.substr(end) + text.substr(at, end - at);
                break;
            }
            default:
                if (below(10) == 0) text.resize(at);
                break;
        }
    }

    std::string noise(size_t bytes) {
        std::string text(bytes, '\0');
        for (char& c : text) c = static_cast<char>(below(256));
        return text;
    }

 private:
    std::mt19937 random_;
};

// True for "test.scene:LINE:COLUMN: message" on a line that the file has, without control characters.
bool is_located(const std::string& text, size_t line_count) {
    const std::string prefix = "test.scene:";
    if (text.compare(0, prefix.size(), prefix) != 0) return false;
    char* end = nullptr;
    const unsigned long line = std::strtoul(text.c_str() + prefix.size(), &end, 10);
    if (line < 1 || line > line_count || *end != ':') return false;
    const unsigned long column = std::strtoul(end + 1, &end, 10);
    if (column < 1 || std::string(end, 2) != ": ") return false;
    return std::none_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
}

void check(const std::string& text, const std::string& which) {
    const std::clock_t start = std::clock();
    const Recording r = import_text(text);
    // CPU time, because other processes may keep the machine busy.
    const double cpu_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    EXPECT_LT(cpu_s, 2.0) << which;
    const size_t line_count =
        1 + static_cast<size_t>(std::count_if(text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }));
    for (const std::string& warning : r.warnings) EXPECT_TRUE(is_located(warning, line_count)) << which << ": " << warning;
    for (const std::string& line : r.log) EXPECT_TRUE(is_located(line, line_count)) << which << ": " << line;
    if (r.status == RT_OK) {
        EXPECT_EQ(r.unsound(), "") << which;
    } else {
        EXPECT_TRUE(is_located(r.why, line_count)) << which << ": " << r.why;
        EXPECT_TRUE(r.order.empty()) << which << ": half-loaded";
    }
}

std::vector<std::string> seeds() {
    std::vector<std::string> texts = {kSeed};
    std::error_code none;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(CLARITY_SOURCE_DIR "/scenes", none)) {
        if (entry.path().extension() == ".scene") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    for (const auto& path : files) {
        std::ifstream file(path, std::ios::binary);
        texts.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    }
    return texts;
}

TEST(SceneFormatFuzz, SurvivesMutations) {
    const std::vector<std::string> texts = seeds();
    ASSERT_EQ(import_text(texts[0]).status, RT_OK);
    for (uint32_t i = 0; i < 6000 && !HasFailure(); ++i) {
        Mutator mutator(i);
        std::string text = texts[mutator.below(texts.size())];
        for (size_t n = 1 + mutator.below(6); n > 0; --n) mutator.mutate(text);
        check(text, "mutation " + std::to_string(i));
    }
}

TEST(SceneFormatFuzz, SurvivesNoise) {
    for (uint32_t i = 0; i < 500 && !HasFailure(); ++i) {
        Mutator mutator(i);
        check(mutator.noise(mutator.below(2000)), "noise " + std::to_string(i));
    }
}

TEST(SceneFormatFuzz, SurvivesLargeInput) {
    check(std::string(1u << 20, '"'), "quotes");
    check(std::string(1u << 20, '\n') + "sphere\n", "empty lines");
    check("polygon vertices" + std::string(1u << 19, ' ') + "1", "spaces");
    std::string numbers = "polygon vertices";
    for (int i = 0; i < 150000; ++i) numbers += " 1";
    check(numbers, "numbers");
    std::string names;
    for (int i = 0; i < 20000; ++i) names += "material m" + std::to_string(i) + "\n";
    check(names + "sphere material m_\n", "names");
    check("sphere radius " + std::string(1u << 18, '9') + "\n", "digits");
    check("sphere radius 0." + std::string(1u << 18, '0') + "1\n", "zeros");
}

}  // namespace
