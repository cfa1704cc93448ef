// main.cpp -- the main function of test programs. A program holds the tests of an area; the variable CLARITY_TEST_FILES, by
// which ctest names the files of one of them, restricts a run to the cases in these files. With CLARITY_QUICK_TESTS and
// CLARITY_TEST_FEW_RAYS (FEW_RAYS in tests/CMakeLists.txt), PoCL compiles kernels without Clang's optimiser. ./test --all
// optimises all.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <sstream>
#include <string>

#include <fnmatch.h>
#include <gtest/gtest.h>

namespace {

const char* const kNone = "-*";  // the filter that no case passes

// Whether one of the parts between colons is accepted.
bool has_one_of(const std::string& list, const std::function<bool(const std::string&)>& accepts) {
    std::istringstream parts(list);
    for (std::string part; std::getline(parts, part, ':');)
        if (accepts(part)) return true;
    return false;
}

// As --gtest_filter: patterns, and after a '-' patterns of what is left out.
bool matches(const std::string& name, const std::string& filter) {
    const auto is_like = [&](const std::string& pattern) { return fnmatch(pattern.c_str(), name.c_str(), 0) == 0; };
    const size_t dash = std::min(filter.find('-'), filter.size());
    const std::string wanted = filter.substr(0, dash);
    return (wanted.empty() || has_one_of(wanted, is_like)) && !has_one_of(filter.substr(dash).erase(0, 1), is_like);
}

// The filter of the cases in `files` (paths' ends, with colons between them) that `filter` accepts.
std::string of_files(const std::string& files, const std::string& filter) {
    std::string names;
    const testing::UnitTest& all = *testing::UnitTest::GetInstance();
    for (int s = 0; s < all.total_test_suite_count(); ++s) {
        const testing::TestSuite& suite = *all.GetTestSuite(s);
        for (int i = 0; i < suite.total_test_count(); ++i) {
            const testing::TestInfo& test = *suite.GetTestInfo(i);
            const std::string path = test.file(), name = std::string(suite.name()) + "." + test.name();
            const auto is_end = [&](const std::string& file) {
                return path.size() > file.size() &&
                       path.compare(path.size() - file.size() - 1, std::string::npos, "/" + file) == 0;
            };
            if (has_one_of(files, is_end) && matches(name, filter)) names += (names.empty() ? "" : ":") + name;
        }
    }
    return names.empty() ? kNone : names;
}

}  // namespace

int main(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    if (std::getenv("CLARITY_QUICK_TESTS") && std::getenv("CLARITY_TEST_FEW_RAYS"))
        setenv("POCL_EXTRA_BUILD_FLAGS", "-cl-opt-disable", 0);  // before the driver is loaded
    if (const char* files = std::getenv("CLARITY_TEST_FILES")) {
        if (of_files(files, "*") == kNone) {
            std::fprintf(stderr, "CLARITY_TEST_FILES: %s has no cases of %s\n", argv[0], files);
            return 1;
        }
        testing::GTEST_FLAG(filter) = of_files(files, testing::GTEST_FLAG(filter));
    }
    return RUN_ALL_TESTS();
}
