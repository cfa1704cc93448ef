// faulty_driver.hpp -- base class of tests of a window on a driver that misbehaves on demand (tests/compile/faulty_icd.c).
#pragma once
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "support/scratch.hpp"
#include "window_fixture.hpp"

namespace clarity::ui {

class FaultyDriverTest : public WindowTest {
 protected:
    void SetUp() override {
        WindowTest::SetUp();
        scratch_.write("vendors/faulty.icd", std::string(FAULTY_DRIVER) + "\n");
        fault("");
    }
    // What the driver does from now on.
    void fault(const std::string& words) {
        scratch_.write("next", words);
        std::filesystem::rename(scratch_.path("next"), scratch_.path("fault"));
    }
    // always: what the driver does from the start. more: further variables. arguments: for a window on another scene.
    std::unique_ptr<WindowDriver> open_on_faulty(const char* always, const std::map<std::string, std::string>& more,
                                                 const std::vector<std::string>& arguments = {}) {
        std::map<std::string, std::string> environment = {{"OCL_ICD_VENDORS", scratch_.path("vendors")},
                                                          {"CLARITY_FAULT", always},
                                                          {"CLARITY_FAULT_FILE", scratch_.path("fault")},
                                                          {"CLARITY_PROGRAM_CACHE", scratch_.path("programs")},
                                                          {"CLARITY_DEVICE", ""}};
        environment.insert(more.begin(), more.end());
        if (arguments.empty()) return open(environment);
        auto window = std::make_unique<WindowDriver>(arguments, environment);
        window->settle();
        return window;
    }

 private:
    Scratch scratch_;
};

}  // namespace clarity::ui
