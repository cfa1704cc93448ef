// window_fixture.hpp -- tests of an open window: skipped, loudly, where nothing can show one.
#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "window_driver.hpp"

namespace clarity::ui {

class WindowTest : public ::testing::Test {
 protected:
    void SetUp() override {
        if (const std::string& missing = VirtualScreen::instance().missing(); !missing.empty())
            GTEST_SKIP() << "NOT TESTED: the window needs " << missing;
    }
    // A small window on a sample scene, at rest.
    std::unique_ptr<WindowDriver> open(std::map<std::string, std::string> environment = {}) {
        return open_scene(source_path("scenes/primitives.scene"), "320x240", std::move(environment));
    }
    std::unique_ptr<WindowDriver> open_scene(const std::string& scene, const std::string& size = "320x240",
                                             std::map<std::string, std::string> environment = {}) {
        const std::vector<std::string> arguments = {"--size", size, scene};
        auto window = std::make_unique<WindowDriver>(arguments, std::move(environment));
        window->settle();
        return window;
    }
    // The line that the window gives, run as it is but for the program's path.
    static std::string command_line(WindowDriver& window, const std::string& output) {
        return window.query("command_line " + output)["command"];
    }
    static int run_command_line(const std::string& line) {
        const std::string program = "clarity ";
        if (line.rfind(program, 0) != 0) return -1;
        return std::system(("'" + program_path() + "' " + line.substr(program.size())).c_str());
    }
    // All that the window's wish is, in words: what two states have in common must be the same here.
    static std::string desired(WindowDriver& window) { return command_line(window, "x.png"); }
    // `save`, and waits for the file.
    static void save(WindowDriver& window, const std::string& path) {
        ASSERT_EQ(window.command("save " + path), "");
        window.settle();
        ASSERT_TRUE(std::ifstream(path).good()) << path << ": " << window.errors();
    }
};

}  // namespace clarity::ui
