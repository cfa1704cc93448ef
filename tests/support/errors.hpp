// errors.hpp -- expects that something fails with a message.
#pragma once
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "base/error.hpp"

namespace clarity {

// Expects that `work` throws an Error whose message has all of the words, and which has the code, if one is given. Returns the
// message; "" if none was thrown.
template <class Work>
std::string expect_error(Work&& work, const std::vector<std::string>& words, std::optional<Exit> code = {}) {
    std::string message;
    try {
        work();
        ADD_FAILURE() << "nothing was thrown";
    } catch (const Error& error) {
        message = error.what();
        EXPECT_EQ(error.code(), code.value_or(error.code())) << message;
        for (const std::string& word : words) EXPECT_NE(message.find(word), std::string::npos) << word << "\nin: " << message;
    }
    return message;
}

}  // namespace clarity
