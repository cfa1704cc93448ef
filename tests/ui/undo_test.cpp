// Undo and redo by keys.
#include <gtest/gtest.h>

#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

class Undo : public WindowTest {
 protected:
    static int steps(WindowDriver& window) {
        int count = 0;
        while (window.state()["undo"] != "" && count < 50) {
            window.key("ctrl+z");
            window.settle();
            ++count;
        }
        return count;
    }
};

TEST_F(Undo, EveryKindOfChangeCanBeUndoneAndRedone) {
    const auto window = open();
    std::vector<std::string> desired_states = {desired(*window)};
    std::vector<Pixels> pictures = {window->picture()};
    const char* const changes[] = {"set depth 2",
                                   "edit light.0 point,3,6,5,1,.2,.2",
                                   "edit light.1 off",
                                   "edit background .8,.2,.1",
                                   "edit material.1.color .1,.9,.1",
                                   "edit hide 0",
                                   "set tone reinhard",
                                   "accel spheres,max_leaf=8"};
    for (const char* change : changes) {
        ASSERT_EQ(window->command(change), "");
        window->settle();
        desired_states.push_back(desired(*window));
        pictures.push_back(window->picture());
        EXPECT_NE(desired_states.back(), desired_states[desired_states.size() - 2]) << change;
    }
    // Undo leaves the camera where the keys have moved it.
    const auto eye = window->state()["eye"];
    for (size_t i = desired_states.size() - 1; i-- > 0;) {
        SCOPED_TRACE(changes[i]);
        EXPECT_NE(window->state()["undo"], "");
        window->key("ctrl+z");
        window->settle();
        EXPECT_EQ(desired(*window), desired_states[i]);
        EXPECT_EQ(difference(window->picture(), pictures[i], 0), 0);
    }
    EXPECT_EQ(window->state()["undo"], "");
    window->key("ctrl+z");  // nothing left to undo: nothing happens
    window->settle();
    EXPECT_EQ(desired(*window), desired_states.front());
    for (size_t i = 1; i < desired_states.size(); ++i) {
        SCOPED_TRACE(changes[i - 1]);
        window->key("ctrl+y");
        window->settle();
        EXPECT_EQ(desired(*window), desired_states[i]);
    }
    EXPECT_EQ(difference(window->picture(), pictures.back(), 0), 0);
    EXPECT_EQ(window->state()["redo"], "");
    EXPECT_EQ(window->state()["eye"], eye);
    // A new change after an undo discards the steps to redo.
    window->key("ctrl+z");
    ASSERT_EQ(window->command("set depth 3"), "");
    window->settle();
    EXPECT_EQ(window->state()["redo"], "");
    EXPECT_EQ(window->state()["undo"], "Depth");
}

TEST_F(Undo, ADraggedSliderIsOneStep) {
    const auto window = open();
    const std::string before = desired(*window);
    window->drag(window->place_of("Depth", 0.9), window->place_of("Depth", 0.1));
    window->settle();
    EXPECT_LT(int(window->state()["depth"]), 4);
    EXPECT_EQ(window->state()["undo"], "Depth");
    EXPECT_EQ(steps(*window), 1);
    EXPECT_EQ(desired(*window), before);
}

TEST_F(Undo, AHeldKeyIsOneStep) {
    const auto window = open();
    const std::string before = desired(*window);
    const auto light = window->state()["light"];
    window->key_down("d");
    int moves = 0;  // times that the light was seen to move; several of them are one step
    for (nlohmann::json last = light; moves < 3;) {
        ASSERT_TRUE(window->reaches([&](const nlohmann::json& state) { return state["light"] != last; }));
        last = window->state()["light"];
        ++moves;
    }
    window->key_up("d");
    window->settle();
    EXPECT_EQ(steps(*window), 1);
    EXPECT_EQ(desired(*window), before);
}

TEST_F(Undo, AnotherSceneHasItsOwnHistory) {
    const auto window = open();
    ASSERT_EQ(window->command("set depth 2"), "");
    window->settle();
    ASSERT_EQ(window->state()["undo"], "Depth");
    ASSERT_EQ(window->command("open " + source_path("scenes/cornell.scene")), "");
    window->settle();
    EXPECT_EQ(window->state()["undo"], "");
    window->key("ctrl+z");
    window->settle();
    EXPECT_EQ(window->state()["files"][0], source_path("scenes/cornell.scene"));
    EXPECT_EQ(window->state()["depth"], 2);
}

}  // namespace
}  // namespace clarity::ui
