// invalid_test.cpp -- damaged and hostile files: the import gives one clear line, or a part of the file with a warning, within
// limits of time and memory.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <filesystem>

#include "base/error.hpp"
#include "measure.hpp"
#include "support/clock.hpp"

namespace clarity::test {
namespace {

using nlohmann::json;

constexpr long kMemoryKibAtMost = 2L << 20;

std::vector<std::string> invalid_names() {
    std::vector<std::string> names;
    if (shared_scenes().empty()) return names;
    for (const std::string& name : files_in(shared_scenes() + "truth", ".json")) {
        if (name.rfind("invalid__", 0) == 0) names.push_back(name);
    }
    return names;
}

bool anybody_reads(const json& record) {
    for (const char* tool : {"truth", "second_opinion", "third_opinion"}) {
        if (record.contains(tool) && record[tool].is_object() && record[tool].value("ok", false)) return true;
    }
    return false;
}

class Invalid : public testing::TestWithParam<std::string> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Invalid);

TEST_P(Invalid, IsRefusedWithOneMessage) {
    const json record = read_json(shared_scenes() + "truth/" + GetParam());
    const std::string file = record["file"], path = shared_scenes() + file;
    if (!has_importer_for(path)) GTEST_SKIP() << "SKIPPED: the importer for " << file << " was not built";
    const auto start = std::chrono::steady_clock::now();
    try {
        const Scene scene = import_file(path);
        EXPECT_TRUE(anybody_reads(record)) << "imported, though every other importer refuses it";
        EXPECT_EQ(validate(scene), "");
        if (scene.triangle_count() > 0) {
            EXPECT_TRUE(std::isfinite(scene.surface_area()));
        }
        // If a part is missing, a warning must say so, unless another importer reads the same part.
        const json& truth = record["truth"];
        const json& expected = truth.contains("static") ? truth["static"] : truth;
        const bool is_whole =
            truth.value("ok", false) && scene.placed_triangle_count() == expected["triangles"].get<uint64_t>();
        const bool second_reads = record.contains("second_opinion") && record["second_opinion"].value("ok", false);
        const bool is_as_second =
            second_reads && scene.placed_triangle_count() == record["second_opinion"]["triangles"].get<uint64_t>();
        EXPECT_TRUE(is_whole || is_as_second || !scene.warnings.empty()) << "a part of it is missing, and no warning says so";
    } catch (const Error& error) {
        const std::string message = error.what();
        EXPECT_EQ(error.code(), Exit::import_failed);
        EXPECT_NE(message.find(std::filesystem::path(path).filename().string()), message.npos) << message;
        EXPECT_EQ(message.find('\n'), message.npos) << message;
        EXPECT_GT(message.size(), path.size() + 10) << "no reason: " << message;
    }
    EXPECT_LT(seconds_since(start), at_most(kSecondsAtMost));
    rusage children{};
    getrusage(RUSAGE_CHILDREN, &children);
    EXPECT_LT(children.ru_maxrss, kMemoryKibAtMost);
}

INSTANTIATE_TEST_SUITE_P(Shared, Invalid, testing::ValuesIn(invalid_names()),
                         [](const auto& about) { return test_name(about.param.substr(0, about.param.size() - 5)); });

TEST(InvalidSet, HasMoreThan50Records) {
    if (shared_scenes().empty()) GTEST_SKIP() << "SKIPPED: no shared scenes; CLARITY_SHARED names their folder";
    EXPECT_GT(invalid_names().size(), 50u);
}

}  // namespace
}  // namespace clarity::test
