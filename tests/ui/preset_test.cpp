// Presets: all that determines a picture is written and read again; a wrong preset changes nothing.
#include <gtest/gtest.h>

#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

class Presets : public WindowTest {};

TEST_F(Presets, RestoreThePictureBitByBit) {
    const auto window = open();
    const TemporaryFolder folder;
    const std::string path = folder.path() + "/my preset.json";
    for (const char* change : {"edit light.0 point,3,6,5,1,.4,.2", "edit light.1 off", "edit material.1.color .1,.9,.1",
                               "edit hide 1", "set tone aces", "set exposure 1.3", "set spp 2", "edit ambient .3,.2,.1"})
        ASSERT_EQ(window->command(change), "") << change;
    window->key("Left");
    window->key("i");
    window->settle();
    const std::string saved = desired(*window);
    const Pixels picture = window->picture();
    ASSERT_EQ(window->command("save_preset " + path), "");

    for (const char* change :
         {"edit light.0 point,-3,2,1,.2,.4,1", "edit light.1 directional,0,1,0,1,1,1", "edit material.1.color .9,.1,.1",
          "edit material.3.reflect .1", "edit hide 0,2", "set tone linear", "set exposure .5", "set spp 1", "set depth 2",
          "edit background 1,0,0", "set size 160x120"})
        ASSERT_EQ(window->command(change), "") << change;
    window->key("Up");
    window->settle();
    EXPECT_NE(desired(*window), saved);
    EXPECT_GT(difference(picture, window->picture()), 0.1);

    ASSERT_EQ(window->command("load_preset " + path), "");
    window->settle();
    EXPECT_EQ(desired(*window), saved);
    EXPECT_EQ(difference(picture, window->picture(), 0), 0);
    // Loading a preset is one step of undo.
    window->key("ctrl+z");
    window->settle();
    EXPECT_EQ(window->state()["size"], "160x120");

    // The preset also works in another window on the same scene.
    const auto other = open();
    ASSERT_EQ(other->command("load_preset " + path), "");
    other->settle();
    EXPECT_EQ(difference(picture, other->picture(), 0), 0);
}

TEST_F(Presets, AnInvalidPresetChangesNothing) {
    const auto window = open();
    const TemporaryFolder folder;
    ASSERT_EQ(window->command("edit light.1 off"), "");
    ASSERT_EQ(window->command("set exposure 1.5"), "");
    window->settle();
    const std::string before = desired(*window);
    const std::string start = R"({"clarity_preset": 1, "settings": {"depth": "2", "tone": "aces"})";
    const std::vector<std::pair<std::string, std::string>> wrong = {
        {"", "preset"},
        {"{ \"clarity_preset\": 1,", "parse"},
        {"[1, 2]", "clarity_preset"},
        {R"({"clarity_preset": 99})", "version"},
        {start + R"(, "colour": 1})", "colour"},
        {start + R"(, "accel": {"id": "no_such_tree"}})", "no_such_tree"},
        {start + R"(, "accel": {"id": "bvh2", "max_leaf": "-3"}})", "max_leaf"},
        {start + R"(, "edits": [["exposure", "1"]]})", "edit"},
        {start + R"(, "edits": [["background", "1,0,0"], ["material.99.color", "1,0,0"]]})", "material.99"},
        {start + R"(, "edits": [["light.0", "off"], ["hide", "77"]]})", "hide"},
        {R"({"clarity_preset": 1, "settings": {"depth": "999"}})", "depth"},
    };
    for (size_t i = 0; i < wrong.size(); ++i) {
        SCOPED_TRACE(wrong[i].first);
        const std::string path = folder.path() + "/wrong" + std::to_string(i) + ".json";
        std::ofstream(path) << wrong[i].first;
        const std::string error = window->command("load_preset " + path);
        EXPECT_NE(error.find(path), std::string::npos) << error;
        EXPECT_NE(error.find(wrong[i].second), std::string::npos) << error;
        EXPECT_EQ(desired(*window), before);
    }
    EXPECT_NE(window->command("load_preset " + folder.path() + "/missing.json").find("missing.json"), std::string::npos);
    EXPECT_NE(window->command("save_preset " + folder.path() + "/no/such/folder.json"), "");
    window->settle();
    EXPECT_EQ(desired(*window), before);
    EXPECT_FALSE(window->state()["behind"]);
}

}  // namespace
}  // namespace clarity::ui
