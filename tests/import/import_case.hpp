// import_case.hpp -- fixture with a folder for test files, and functions to import them.
#pragma once
#include <gtest/gtest.h>

#include <mutex>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/log.hpp"
#include "import/import.hpp"
#include "support/scratch.hpp"

namespace clarity {
using namespace import;

class ImportCase : public ::testing::Test {
 protected:
    void SetUp() override;
    void TearDown() override;

    // Writes a file into this test's folder; returns its path.
    std::string file(const std::string& name, const std::string& text) const { return scratch_.write(name, text); }
    std::string path(const std::string& name) const { return scratch_.path(name); }

    static const PluginRegistry& plugins();  // with the importer of tests
    Scene import(const std::vector<std::string>& files);
    Scene import_text(const std::string& text) { return import({file("case.cltest", text)}); }
    // The message of the Error(import_failed) which the import must throw. If it throws none, the test fails and the result is
    // empty.
    std::string failure(const std::vector<std::string>& files);
    std::string failure_of_text(const std::string& text) { return failure({file("case.cltest", text)}); }

    // Lines of the log so far.
    std::vector<std::string> logged() const;

    ImportOptions options_;
    Progress progress_;

 private:
    Scratch scratch_;
    mutable std::mutex mutex_;
    std::vector<std::string> log_;
};

::testing::AssertionResult contains(const std::string& text, const std::string& part);

#ifdef __SANITIZE_ADDRESS__
inline constexpr bool kAddressSanitizer = true;  // it reports crashes itself
#else
inline constexpr bool kAddressSanitizer = false;
#endif
#ifdef __SANITIZE_THREAD__
inline constexpr bool kThreadSanitizer = true;  // it takes several times as much memory
#else
inline constexpr bool kThreadSanitizer = false;
#endif
inline constexpr bool kSanitizer = kAddressSanitizer || kThreadSanitizer;

}  // namespace clarity
