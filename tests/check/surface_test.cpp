// surface_test.cpp -- `clarity check` finds nothing wrong of oren_nayar, and each fault that is planted into a copy of its
// kernels.
#include <gtest/gtest.h>

#include <filesystem>

#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"
#include "support/scratch.hpp"

namespace {

const char* const kFile = "plugins/surfaces/oren_nayar/oren_nayar.cl";

nlohmann::json check_surface(const std::vector<std::string>& words, const std::string& kernels, int exit_code) {
    std::vector<std::string> all = {"check", "oren_nayar", "--quick", "--json"};
    all.insert(all.end(), words.begin(), words.end());
    RunOptions options;
    options.environment["CLARITY_KERNEL_PATH"] = kernels;
    const ProgramResult result = run_program(all, options);
    EXPECT_EQ(result.exit_code, exit_code) << result.out << result.err;
    return nlohmann::json::parse(result.out, nullptr, false);
}

TEST(SoundSurface, Passes) {
    const nlohmann::json results = check_surface({"--seed", "1"}, "", 0);
    ASSERT_TRUE(results.is_array());
    EXPECT_EQ(results.size(), 7u);
    for (const auto& result : results) EXPECT_EQ(result["status"], "passed") << result.dump(2);
}

struct Fault {
    const char *name, *from, *to;
    const char* check;               // that must find it
    std::vector<const char*> words;  // of what it found
};
void PrintTo(const Fault& fault, std::ostream* out) {
    *out << fault.name;
}

class FaultySurface : public testing::TestWithParam<Fault> {};

TEST_P(FaultySurface, IsFound) {
    const Fault& fault = GetParam();
    std::ifstream file(std::string(CLARITY_SOURCE_DIR) + "/" + kFile);
    std::string text(std::istreambuf_iterator<char>(file), {});
    const size_t at = text.find(fault.from);
    ASSERT_NE(at, std::string::npos) << "the plugin has no longer this text";
    ASSERT_EQ(text.find(fault.from, at + 1), std::string::npos) << "the plugin has this text twice";
    const Scratch scratch;
    std::filesystem::create_directories(scratch.path("cl"));
    scratch.write(kFile, text.replace(at, std::string(fault.from).size(), fault.to));
    const nlohmann::json results = check_surface({"--only", fault.check}, scratch.path("cl"), 1);
    ASSERT_TRUE(results.is_array() && results.size() == 1) << results;
    EXPECT_EQ(results[0]["status"], "failed");
    const std::string found = results[0]["found"];
    for (const char* word : fault.words) EXPECT_NE(found.find(word), std::string::npos) << word << "\nin: " << found;
    RecordProperty("found", found);
}

const Fault kFaults[] = {
    {"another_function_of_the_host",
     "return wi.z * 0.31830989f;",
     "return rt_cosine_density(wi);",
     "surface.kernels",
     {"oren_nayar.cl:9:", "rt_cosine_density"}},
    {"divides_by_zero", "s > 0.0f ? fmax(wo.z, wi.z) : 1.0f", "s", "surface.finite", {"eval is (", "grooves 0", "for wo ("}},
    {"negative_along_the_surface",
     "(1.0f + sigma * s / t)",
     "(1.0f + 1.02f * sigma * s / t)",
     "surface.finite",
     {"eval is (-", "grooves 1", "none below 0"}},
    {"no_unit_vector", "radius = sqrt(u.x)", "radius = 0.9f * sqrt(u.x)", "surface.finite", {"no unit vector", "and u ("}},
    {"reads_beyond_its_keys",
     "sigma = numbers[0]",
     "sigma = numbers[5]",
     "surface.finite",
     {"crashed (segmentation fault", "numbers of the surface"}},
    {"weight_off",
     "draw.weight = 3.1415927f *",
     "draw.weight = 3.16f *",
     "surface.weight",
     {"but f cos / pdf is", "which draws wi"}},
    {"one_way", "fmax(wo.z, wi.z)", "wo.z", "surface.reciprocity", {"in each other's place", "grooves 0.5"}},
    {"density_above_1",
     "return wi.z * 0.31830989f;",
     "return wi.z * 0.33f;",
     "surface.total",
     {"the hemisphere is 1.03", "at most 1"}},
    {"never_draws_a_part", "turn = 6.2831853f", "turn = 6.1f", "surface.density", {"draws, expected", "sigma"}},
    {"brighter_than_light",
     "* 0.31830989f * color",
     "* 0.325f * color",
     "surface.energy",
     {"it sends back 1.02", "color 1 1 1"}},
};
INSTANTIATE_TEST_SUITE_P(All, FaultySurface, testing::ValuesIn(kFaults),
                         [](const testing::TestParamInfo<Fault>& info) { return std::string(info.param.name); });

}  // namespace
