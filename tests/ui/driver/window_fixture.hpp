// window_fixture.hpp -- base class of tests with an open window. They are skipped with a notice if nothing can show a window.
#pragma once
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "window_driver.hpp"

namespace clarity::ui {

using Point = std::array<double, 3>;

inline double distance_between(const Point& a, const Point& b) {
    return std::sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

class WindowTest : public ::testing::Test {
 protected:
    void SetUp() override {
        if (const std::string& missing = VirtualScreen::instance().missing(); !missing.empty())
            GTEST_SKIP() << "NOT TESTED: the window needs " << missing;
    }
    // Opens a small window on a sample scene and waits until it is idle.
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
    // Returns the command line that the window gives. run_command_line() runs it with the path of the program under test.
    static std::string command_line(WindowDriver& window, const std::string& output) {
        return window.query("command_line " + output)["command"];
    }
    static int run_command_line(const std::string& line) {
        const std::string program = "clarity ";
        if (line.rfind(program, 0) != 0) return -1;
        return std::system(("'" + program_path() + "' " + line.substr(program.size())).c_str());
    }
    // Describes the whole desired state in words, so that two states can be compared.
    static std::string desired(WindowDriver& window) { return command_line(window, "x.png"); }
    // `save`, and waits for the file.
    static void save(WindowDriver& window, const std::string& path) {
        ASSERT_EQ(window.command("save " + path), "");
        window.settle();
        ASSERT_TRUE(std::ifstream(path).good()) << path << ": " << window.errors();
    }
};

}  // namespace clarity::ui
