// window_fixture.hpp -- tests of an open window: skipped, loudly, where nothing can show one.
#pragma once
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "window_driver.hpp"

namespace clarity {

class WindowTest : public ::testing::Test {
 protected:
    void SetUp() override {
        if (const std::string& missing = VirtualScreen::instance().missing(); !missing.empty())
            GTEST_SKIP() << "NOT TESTED: the window needs " << missing;
    }
    // A small window on a sample scene, at rest.
    std::unique_ptr<WindowDriver> open(std::map<std::string, std::string> environment = {}) {
        const std::vector<std::string> arguments = {"--size", "320x240", source_path("scenes/primitives.scene")};
        auto window = std::make_unique<WindowDriver>(arguments, std::move(environment));
        window->settle();
        return window;
    }
};

}  // namespace clarity
