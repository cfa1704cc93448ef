// surface_test.cpp -- `clarity check` finds nothing wrong of oren_nayar and of the solution of the lab microfacet, whose lobes
// are narrow, and each fault that is planted into a copy of their kernels.
#include <gtest/gtest.h>

#include <filesystem>

#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"
#include "support/scratch.hpp"

namespace {

const std::string kLab = std::string(BROKEN_PLUGINS) + "/microfacet.so";

nlohmann::json check_surface(const std::string& plugin, const std::vector<std::string>& words, const std::string& kernels,
                             int exit_code) {
    std::vector<std::string> all = {"check", plugin, "--quick", "--json"};
    all.insert(all.end(), words.begin(), words.end());
    RunOptions options;
    options.environment["CLARITY_KERNEL_PATH"] = kernels;
    const ProgramResult result = run_program(all, options);
    EXPECT_EQ(result.exit_code, exit_code) << result.out << result.err;
    return nlohmann::json::parse(result.out, nullptr, false);
}

void expect_sound(const std::string& plugin, const std::string& kernels) {
    const nlohmann::json results = check_surface(plugin, {"--seed", "1"}, kernels, 0);
    ASSERT_TRUE(results.is_array());
    EXPECT_EQ(results.size(), 7u);
    for (const auto& result : results) EXPECT_EQ(result["status"], "passed") << result.dump(2);
}
TEST(SoundSurface, Passes) {
    expect_sound("oren_nayar", "");
}
// Down to rough 0.05, which is a lobe of 0.0025 rad.
TEST(SoundSurface, NarrowLobesPass) {
    expect_sound(kLab, "");
}

struct Fault {
    const char *name, *from, *to;
    const char* check;               // that must find it
    std::vector<const char*> words;  // of what it found
};
void PrintTo(const Fault& fault, std::ostream* out) {
    *out << fault.name;
}

// A folder with kernels of that name, in which a text becomes another.
std::string plant(const Scratch& scratch, const std::string& source, const std::string& id, const std::string& from,
                  const std::string& to) {
    std::ifstream file(std::string(CLARITY_SOURCE_DIR) + "/" + source);
    std::string text(std::istreambuf_iterator<char>(file), {});
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << source << " has no longer this text: " << from;
    EXPECT_EQ(text.find(from, at + 1), std::string::npos) << source << " has this text twice: " << from;
    std::filesystem::create_directories(scratch.path("cl"));
    scratch.write("plugins/surfaces/" + id + "/" + id + ".cl",
                  at == std::string::npos ? text : text.replace(at, from.size(), to));
    return scratch.path("cl");
}

void expect_found(const std::string& plugin, const std::string& source, const std::string& id, const Fault& fault) {
    const Scratch scratch;
    const std::string kernels = plant(scratch, source, id, fault.from, fault.to);
    const nlohmann::json results = check_surface(plugin, {"--only", fault.check}, kernels, 1);
    ASSERT_TRUE(results.is_array() && results.size() == 1) << results;
    EXPECT_EQ(results[0]["status"], "failed");
    const std::string found = results[0]["found"];
    for (const char* word : fault.words) EXPECT_NE(found.find(word), std::string::npos) << word << "\nin: " << found;
    testing::Test::RecordProperty("found", found);
}

class FaultySurface : public testing::TestWithParam<Fault> {};
TEST_P(FaultySurface, IsFound) {
    expect_found("oren_nayar", "plugins/surfaces/oren_nayar/oren_nayar.cl", "oren_nayar", GetParam());
}
class FaultyNarrowLobe : public testing::TestWithParam<Fault> {};
TEST_P(FaultyNarrowLobe, IsFound) {
    expect_found(kLab, "labs/microfacet/reference/microfacet.cl", "microfacet", GetParam());
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

const Fault kNarrowFaults[] = {
    // Half of a thousandth of the hemisphere is too bright by 4 %.
    {"lobe_not_normalised",
     "return 0.31830989f / (alpha",
     "return 0.3310423f / (alpha",
     "surface.total",
     {"the hemisphere is 1.03", "at most 1"}},
    {"lobe_too_wide",
     "const float alpha = microfacet_alpha(numbers), turn",
     "const float alpha = 1.1f * microfacet_alpha(numbers), turn",
     "surface.density",
     {"rough 0.3", "draws, expected"}},
    // Only where lobes are at their narrowest.
    {"narrow_lobe_too_wide",
     "const float alpha = microfacet_alpha(numbers), turn",
     "const float alpha = fmax(microfacet_alpha(numbers), 0.0027f), turn",
     "surface.density",
     {"rough 0.05", "draws, expected"}},
    {"half_of_the_lobe", "turn = 6.2831853f * u.x", "turn = 3.1415927f * u.x", "surface.density", {"draws, expected"}},
    {"facets_that_are_not_seen",
     "return microfacet_facets(normalize(wo + wi), alpha) / (2.0f * (1.0f + microfacet_smith(wo, alpha)) * wo.z);",
     "return microfacet_facets(normalize(wo + wi), alpha) / (4.0f * wo.z);",
     "surface.total",
     {"the hemisphere is 1"}},
    {"weight_of_one_shadow",
     "((1.0f + out) / (out + microfacet_smith(draw.wi, alpha)))",
     "(2.0f / (1.0f + microfacet_smith(draw.wi, alpha)))",
     "surface.weight",
     {"but f cos / pdf is"}},
    {"one_way",
     "(microfacet_smith(wo, alpha) + microfacet_smith(wi, alpha))",
     "(1.0f + microfacet_smith(wo, alpha))",
     "surface.reciprocity",
     {"in each other's place"}},
};
INSTANTIATE_TEST_SUITE_P(All, FaultyNarrowLobe, testing::ValuesIn(kNarrowFaults),
                         [](const testing::TestParamInfo<Fault>& info) { return std::string(info.param.name); });

}  // namespace
