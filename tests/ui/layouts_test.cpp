// Keys follow the letters on the caps: first the rule on tables of layouts, then a real window while the X server's layout
// changes.
#include <gtest/gtest.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cstdlib>

#include "ui/driver/window_fixture.hpp"
#include "ui/widgets/key_map.hpp"

namespace clarity::ui {
namespace {

// The caps of a layout, where they differ from a US keyboard.
Caps layout(std::map<int, std::string> caps) {
    return [caps = std::move(caps)](int place) {
        if (const auto found = caps.find(place); found != caps.end()) return found->second;
        const bool exists = place < 128 && (std::string("'`,-./;=[\\]").find(char(place)) != std::string::npos ||
                                            std::isupper(place) || std::isdigit(place));
        return exists ? std::string(1, char(std::tolower(place))) : std::string();
    };
}
const Caps us = layout({});
const Caps german = layout({{'Y', "z"}, {'Z', "y"}, {';', "\u00f6"}, {'-', "\u00df"}, {'/', "-"}});
const Caps french = layout({{'Q', "a"}, {'A', "q"},      {'W', "z"}, {'Z', "w"},      {';', "m"},      {'M', ","}, {',', ";"},
                            {'.', ":"}, {'/', "!"},      {'1', "&"}, {'2', "\u00e9"}, {'3', "\""},     {'4', "'"}, {'5', "("},
                            {'6', "-"}, {'7', "\u00e8"}, {'8', "_"}, {'9', "\u00e7"}, {'0', "\u00e0"}, {'-', ")"}});
const Caps dvorak = layout({{'Q', "'"}, {'W', ","}, {'E', "."}, {'R', "p"},  {'T', "y"}, {'Y', "f"}, {'U', "g"}, {'I', "c"},
                            {'O', "r"}, {'P', "l"}, {'S', "o"}, {'D', "e"},  {'F', "u"}, {'G', "i"}, {'H', "d"}, {'J', "h"},
                            {'K', "t"}, {'L', "n"}, {';', "s"}, {'\'', "-"}, {'Z', ";"}, {'X', "q"}, {'C', "j"}, {'V', "k"},
                            {'B', "x"}, {'N', "b"}, {',', "w"}, {'.', "v"},  {'/', "z"}, {'-', "["}, {'=', "]"}});
const Caps programmer = layout(
    {{'1', "&"}, {'2', "["}, {'3', "{"}, {'4', "}"}, {'5', "("}, {'6', "="}, {'7', "*"}, {'8', ")"}, {'9', "+"}, {'0', "]"}});
const Caps one_hand =
    layout({{'1', "["}, {'4', "p"}, {'5', "f"}, {'P', "5"}, {'F', "4"}});  // two of Dvorak's digits and letters
const Caps russian =
    layout({{'Q', "\u0439"}, {'W', "\u0446"}, {'Z', "\u044f"}, {'Y', "\u043d"}, {',', "\u0431"}, {'.', "\u044e"}, {'/', "."}});
const Caps greek = layout({{'Q', ";"}, {'W', "\u03c2"}, {'Z', "\u03b6"}, {';', ""}});
const Caps hebrew =
    layout({{'Q', "/"}, {'W', "'"}, {'Z', "\u05d6"}, {'\'', ","}, {',', "\u05ea"}, {'.', "\u05e5"}, {'/', "."}});

TEST(KeyboardLayouts, TheCapDecidesElseThePlace) {
    constexpr int none = GLFW_KEY_UNKNOWN;
    struct Case {
        const char* name;
        const Caps& caps;
        std::map<int, int> keys;  // what the key at a place means
    };
    const Case cases[] = {
        {"us", us, {{'Z', 'Z'}, {'Y', 'Y'}, {'1', '1'}, {',', ','}, {'.', '.'}}},
        {"german", german, {{'Z', 'Y'}, {'Y', 'Z'}, {'A', 'A'}, {'1', '1'}, {'0', '0'}, {',', ','}, {'.', '.'}}},
        {"french",
         french,
         {{'W', 'Z'},
          {'Z', 'W'},
          {'Q', 'A'},
          {'A', 'Q'},
          {';', 'M'},
          {'M', ','},
          {'.', '.'},
          {',', none},
          {'1', '1'},
          {'4', '4'},
          {'6', '6'},
          {'0', '0'}}},
        {"dvorak", dvorak, {{'/', 'Z'}, {'T', 'Y'}, {'Q', none}, {'W', ','}, {'E', '.'}, {',', 'W'}, {'1', '1'}}},
        {"programmer", programmer, {{'1', '1'}, {'2', '2'}, {'6', '6'}, {'0', '0'}}},
        {"one hand", one_hand, {{'1', '1'}, {'4', 'P'}, {'5', 'F'}, {'P', '5'}, {'F', '4'}}},
        {"russian", russian, {{'Q', 'Q'}, {'W', 'W'}, {'Z', 'Z'}, {'Y', 'Y'}, {',', ','}, {'.', none}, {'/', '.'}}},
        {"greek", greek, {{'Q', 'Q'}, {'W', 'W'}, {'Z', 'Z'}, {';', ';'}}},
        {"hebrew", hebrew, {{'Q', 'Q'}, {'W', 'W'}, {'Z', 'Z'}, {'\'', ','}, {'/', '.'}, {',', none}, {'.', none}}},
    };
    for (const Case& c : cases)
        for (const auto& [place, key] : c.keys) EXPECT_EQ(meant_key(place, false, c.caps), key) << c.name << " " << char(place);
    // Each key that a map binds is on exactly one key of each layout.
    for (const Case& c : cases)
        for (const char key : std::string("ABCDEFGIKLMNOPRSWXYZ1234567890,.")) {
            if (c.name == std::string("one hand")) continue;  // its table is not whole
            int found = 0;
            for (int place = 33; place < 128; ++place) found += meant_key(place, false, c.caps) == key;
            EXPECT_EQ(found, 1) << c.name << " " << key;
        }
}

TEST(KeyboardLayouts, KeysWithoutSignsAndTheKeypad) {
    for (const int key : {GLFW_KEY_SPACE, GLFW_KEY_LEFT, GLFW_KEY_F1, GLFW_KEY_ESCAPE, GLFW_KEY_HOME, GLFW_KEY_LEFT_CONTROL,
                          GLFW_KEY_KP_ENTER, GLFW_KEY_KP_ADD})
        for (const bool num_lock : {false, true}) EXPECT_EQ(meant_key(key, num_lock, french), key);
    EXPECT_EQ(meant_key(GLFW_KEY_KP_0, true, french), GLFW_KEY_0);
    EXPECT_EQ(meant_key(GLFW_KEY_KP_9, true, french), GLFW_KEY_9);
    EXPECT_EQ(meant_key(GLFW_KEY_KP_DECIMAL, true, french), GLFW_KEY_KP_DECIMAL);
    EXPECT_EQ(meant_key(GLFW_KEY_KP_4, false, french), GLFW_KEY_LEFT);
    EXPECT_EQ(meant_key(GLFW_KEY_KP_9, false, french), GLFW_KEY_PAGE_UP);
    EXPECT_EQ(meant_key(GLFW_KEY_KP_5, false, french), GLFW_KEY_UNKNOWN);
    EXPECT_EQ(meant_key(GLFW_KEY_KP_DECIMAL, false, french), GLFW_KEY_DELETE);
}

TEST(KeyboardLayouts, NamesAreThoseOnTheCaps) {
    EXPECT_EQ(name_on_cap('.', ".", us), ".");
    EXPECT_EQ(name_on_cap('.', ".", french), ":");
    EXPECT_EQ(name_on_cap(',', ",", french), ",");  // on another key
    EXPECT_EQ(name_on_cap(',', ",", russian), "\u0431");
    EXPECT_EQ(name_on_cap('Z', "Ctrl+Z", russian), "Ctrl+Z");  // Latin letters are on the caps, too
    EXPECT_EQ(name_on_cap('1', "1", french), "1");
    EXPECT_EQ(name_on_cap(GLFW_KEY_LEFT, "\u2190", french), "\u2190");
}

// A window on the X server, whose layout is changed while the window runs.
class Layouts : public WindowTest {
 protected:
    void SetUp() override {
        WindowTest::SetUp();
        if (!IsSkipped() && std::system("command -v setxkbmap >/dev/null && command -v xkbcomp >/dev/null") != 0)
            GTEST_SKIP() << "NOT TESTED: layouts need setxkbmap and xkbcomp";
    }
    void TearDown() override {
        if (VirtualScreen::instance().missing().empty()) use("us");
    }
    static void use(const std::string& layout) {
        const std::string command = "setxkbmap -display " + VirtualScreen::instance().display() + " " + layout;
        ASSERT_EQ(std::system(command.c_str()), 0) << command;
    }
    static bool shows(WindowDriver& window, const char* key, const nlohmann::json& value) {
        return window.reaches([&](const nlohmann::json& state) { return state[key] == value; });
    }
};

// X names of keys. `by_place`: layouts without Latin letters, where xdotool takes codes of places.
struct XKeys {
    const char *layout, *z, *y, *w, *m, *a, *x, *v, *d;
};
const XKeys by_letter(const char* layout) {
    return {layout, "z", "y", "w", "m", "a", "x", "v", "d"};
}
const XKeys by_place(const char* layout) {
    return {layout, "52", "29", "25", "58", "38", "53", "55", "40"};
}

TEST_F(Layouts, KeysFollowTheLettersWhileTheLayoutChanges) {
    const auto window = open_scene(source_path("scenes/primitives.scene"), "96x72");
    const int depth = window->state()["depth"];
    ASSERT_NE(depth, 2);
    for (const XKeys& keys :
         {by_letter("de"), by_letter("fr"), by_letter("us -variant dvorak"), by_place("ru"), by_letter("fr -variant bepo"),
          by_place("gr"), by_letter("cz -variant qwerty"), by_letter("us")}) {
        SCOPED_TRACE(keys.layout);
        use(keys.layout);
        ASSERT_EQ(window->command("set depth 2"), "");
        ASSERT_TRUE(shows(*window, "depth", 2));
        window->key(std::string("ctrl+") + keys.z);
        EXPECT_TRUE(shows(*window, "depth", depth));
        window->key(std::string("ctrl+") + keys.y);
        EXPECT_TRUE(shows(*window, "depth", 2));
        window->key(std::string("ctrl+") + keys.z);
        ASSERT_TRUE(shows(*window, "depth", depth));
        window->key(keys.m);
        EXPECT_TRUE(shows(*window, "move_handles", true));
        window->key(keys.m);
        EXPECT_TRUE(shows(*window, "move_handles", false));
        // The light of the thesis's keys: W away from the camera, which looks along -Z; D to the right.
        for (const auto& [key, axis, sign] : {std::tuple(keys.w, 2, -1), std::tuple(keys.d, 0, 1)}) {
            const std::array<double, 3> was = window->state()["light"];
            window->key(key);
            window->settle();
            const std::array<double, 3> now = window->state()["light"];
            for (int k = 0; k < 3; ++k) {
                const double moved = now[size_t(k)] - was[size_t(k)];
                if (k == axis)
                    EXPECT_GT(sign * moved, 1e-3) << key;
                else
                    EXPECT_NEAR(moved, 0, 1e-4) << key;
            }
        }
        // The row of digits, by place: code 10 is the key at the left.
        for (const auto& [code, level] : {std::pair("10", 0L), {"11", 1L}, {"15", 5L}, {"18", 8L}, {"19", 0xffffffffL}}) {
            window->key(code);
            EXPECT_TRUE(shows(*window, "level", level)) << code;
            window->key(code);
            EXPECT_TRUE(shows(*window, "level", -1)) << code;
        }
        EXPECT_EQ(window->state()["message"], "");
    }
}

// ImGui's own shortcuts in a text field: all, cut, paste, undo.
TEST_F(Layouts, TextFieldsFollowTheLetters) {
    const auto window = open();
    ASSERT_EQ(window->command("focus path"), "");
    ASSERT_TRUE(shows(*window, "typing", true));
    window->type("some/file.obj");
    ASSERT_TRUE(shows(*window, "path", "some/file.obj"));
    for (const XKeys& keys : {by_letter("fr"), by_letter("us -variant dvorak"), by_letter("de"), by_place("ru")}) {
        SCOPED_TRACE(keys.layout);
        use(keys.layout);
        const auto with_ctrl = [&](const char* key) {
            window->key_down("ctrl");
            window->tap(key);
            window->key_up("ctrl");
        };
        with_ctrl(keys.a);
        with_ctrl(keys.x);
        EXPECT_TRUE(shows(*window, "path", ""));
        with_ctrl(keys.v);
        EXPECT_TRUE(shows(*window, "path", "some/file.obj"));
        with_ctrl(keys.z);
        EXPECT_TRUE(shows(*window, "path", ""));
        with_ctrl(keys.y);
        EXPECT_TRUE(shows(*window, "path", "some/file.obj"));
        EXPECT_TRUE(window->state()["typing"]);
    }
}

// A key that is held while the layout changes is released all the same.
TEST_F(Layouts, AKeyHeldWhileTheLayoutChangesIsReleased) {
    const auto window = open_scene(source_path("scenes/primitives.scene"), "96x72");
    const auto light = [&] { return window->state()["light"]; };
    const auto before = light();
    window->key_down("25");  // W
    ASSERT_TRUE(window->reaches([&](const nlohmann::json& state) { return state["light"] != before; }));
    use("fr");  // now it is Z
    window->key_up("25");
    window->settle();
    const auto moved = light();
    usleep(300000);
    window->settle();
    EXPECT_EQ(light(), moved);
}

TEST_F(Layouts, TheKeypadHasDigitsOrArrows) {
    const auto window = open_scene(source_path("scenes/primitives.scene"), "96x72");
    const auto eye = [&] { return std::array<double, 3>(window->state()["eye"]); };
    const auto before = eye();
    window->key("83");  // 4 of the keypad
    window->settle();
    EXPECT_LT(eye()[0], before[0] - 1e-3);
    window->key("Num_Lock");
    window->key("83");
    EXPECT_TRUE(shows(*window, "level", 3));
    window->key("83");
    window->key("Num_Lock");
    EXPECT_TRUE(shows(*window, "level", -1));
}

}  // namespace
}  // namespace clarity::ui
