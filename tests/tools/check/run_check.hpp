// run_check.hpp -- runs `clarity check` on a library of tests/tools/check, and says what it found.
#pragma once
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"

// A broken plugin.
struct Defect {
    const char* library;
    const char* check;               // that must fail
    std::vector<const char*> words;  // of what it found
    const char* lanes = "1";         // with which it is tried; nullptr: with those of a quick check
};
inline void PrintTo(const Defect& defect, std::ostream* out) {
    *out << defect.library;
}
inline std::string name_of(const testing::TestParamInfo<Defect>& info) {
    return info.param.library;
}

// The results of `clarity check LIBRARY --quick --json WORDS`.
inline nlohmann::json check(const std::string& library, const std::vector<std::string>& words, int exit_code) {
    std::vector<std::string> all = {"check", "--quick", "--json", std::string(BROKEN_PLUGINS) + "/" + library + ".so"};
    all.insert(all.end(), words.begin(), words.end());
    RunOptions options;
    options.limit_s = 300;
    const ProgramResult result = run_program(all, options);
    EXPECT_EQ(result.exit_code, exit_code) << result.out << result.err;
    return nlohmann::json::parse(result.out, nullptr, false);
}

// Expects that the last check that failed is the defect's, and that it found what it must.
inline void expect_found(const nlohmann::json& results, const Defect& defect) {
    ASSERT_TRUE(results.is_array() && !results.empty()) << results;
    const nlohmann::json* failed = nullptr;
    for (const auto& result : results)
        if (result["status"] == "failed") failed = &result;
    ASSERT_NE(failed, nullptr) << results.dump(2);
    EXPECT_EQ((*failed)["check"], defect.check);
    const std::string found = (*failed)["found"];
    for (const char* word : defect.words) EXPECT_NE(found.find(word), std::string::npos) << word << "\nin: " << found;
}
