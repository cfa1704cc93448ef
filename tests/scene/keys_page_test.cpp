// The tables of lights, skies, materials and their textures in docs/scene_format.md are those of the program.
// CLARITY_WRITE_PAGES=1 writes them.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

#include "base/numbers.hpp"
#include "scene/light_kinds.hpp"
#include "scene/map_uses.hpp"
#include "scene/material_keys.hpp"
#include "scene/sky_kinds.hpp"

namespace clarity {
namespace {

constexpr const char* kPage = CLARITY_SOURCE_DIR "/docs/scene_format.md";

std::string words_of(const Key& key) {
    std::string words;
    for (size_t i = 0; key.words && key.words[i]; ++i) words += (i ? ", `" : "`") + std::string(key.words[i]) + "`";
    return words;
}

// "`color r g b`", the default, and what it means, with its range.
std::string row(const Key& key, const std::string& first) {
    std::string help = key.help, argument = "f";
    if (count_of(key) == 3) {
        argument = key.kind == RT_KEY_COLOR ? "r g b" : "x y z";
        help = help.substr(std::min(help.size(), argument.size()));
        if (help.rfind(", ", 0) == 0) help = help.substr(2);
    }
    if (key.kind == RT_KEY_WORD) argument = "WORD";
    std::string meaning = key.kind == RT_KEY_WORD ? words_of(key) + ": " + help : help;
    if (*key.more) meaning += (meaning.empty() ? "" : "; ") + std::string(key.more);
    const bool is_number = key.kind != RT_KEY_WORD && key.kind != RT_KEY_FLAG;
    if (is_number && key.max < kMostNumber) meaning += "; " + exact_text(key.min) + " to " + exact_text(key.max);
    const std::string name = std::string(key.name) + (key.kind == RT_KEY_FLAG ? "" : " " + argument);
    const bool is_grey = key.kind == RT_KEY_COLOR && key.def[0] == key.def[1] && key.def[1] == key.def[2];
    const std::string def = is_grey ? exact_text(key.def[0]) : value_text(key, key.def, " ");
    return "|" + first + " `" + name + "` | `" + def + "` | " + meaning + " |\n";
}

std::string material_table() {
    std::string table = "| key | default | meaning |\n|---|---|---|\n";
    for (const Key& key : material_keys()) table += row(key, "");
    return table;
}

// The kinds of lights or skies, with their keys.
template <class Kind>
std::string kind_table(const char* what, const std::vector<Kind>& kinds) {
    std::string table = "| " + std::string(what) + " | key | default | meaning |\n|---|---|---|---|\n";
    for (const Kind& kind : kinds) {
        std::string first = " **" + std::string(kind.name) + "**, " + kind.help + " |";
        for (const Key& key : kind.keys) {
            table += row(key, first);
            first = " |";
        }
    }
    return table;
}

void expect_in_page(const std::string& name, const std::string& table) {
    std::ifstream in(kPage);
    std::string page{std::istreambuf_iterator<char>(in), {}};
    const std::string begin = "<!-- " + name + " -->\n", end = "<!-- end -->";
    const size_t from = page.find(begin), to = page.find(end, from);
    ASSERT_NE(to, std::string::npos) << kPage << " has no table between " << begin << " and " << end;
    const size_t first = from + begin.size();
    if (std::getenv("CLARITY_WRITE_PAGES")) {
        page.replace(first, to - first, table);
        std::ofstream(kPage) << page;
        return;
    }
    EXPECT_EQ(page.substr(first, to - first), table) << "run this test with CLARITY_WRITE_PAGES=1 and look at the page";
}

TEST(KeysPage, HasTheLights) {
    expect_in_page("lights", kind_table("light", light_kinds()));
}

TEST(KeysPage, HasTheSky) {
    expect_in_page("sky", kind_table("sky", sky_kinds()));
}

TEST(KeysPage, HasTheMaterial) {
    expect_in_page("material", material_table());
}

TEST(KeysPage, HasTheMaps) {
    std::string table = "| key | space | multiplies | channels |\n|---|---|---|---|\n";
    for (const MapUse& use : map_uses()) {
        std::string keys;
        for (const char* const* key = use.multiplies.data(); *key; ++key)
            keys += (keys.empty() ? "`" : ", `") + std::string(*key) + "`";
        table += "| `" + std::string(use.name) + " NAME` | `" + (use.space == RT_SPACE_SRGB ? "srgb" : "linear") + "` | " +
                 keys + " | " + use.help + " |\n";
    }
    expect_in_page("maps", table);
}

// A key that a texture multiplies exists, and reaches 1.
TEST(MapUses, MultiplyKeysOfMaterials) {
    for (const MapUse& use : map_uses())
        for (const char* const* name = use.multiplies.data(); *name; ++name) {
            const Key* key = find_key(material_keys(), *name);
            ASSERT_TRUE(key) << *name;
            EXPECT_TRUE(key->min <= 1 && key->max >= 1) << *name;
        }
}

}  // namespace
}  // namespace clarity
