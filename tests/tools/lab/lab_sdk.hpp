// lab_sdk.hpp -- the labs of the tree, and the SDK as it is installed.
#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

inline const std::string kLabs = std::string(CLARITY_SOURCE_DIR) + "/labs";
inline const std::string kSdk = std::string(CLARITY_BUILD_DIR) + "/tests/tools/lab/sdk";

// Plugins of submissions are built against it. Two tests that run at once install it one after the other; what is up to date is
// left as it is.
inline void install_sdk() {
    static const bool done = [] {
        const std::string command = "flock '" CLARITY_BUILD_DIR "/tests/tools/lab' cmake --install '" CLARITY_BUILD_DIR
                                    "' --component sdk --prefix '" +
                                    kSdk + "' >/dev/null";
        return std::system(command.c_str()) == 0;
    }();
    ASSERT_TRUE(done) << kSdk;
}
