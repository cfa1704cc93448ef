// broken_test.cpp -- each broken plugin is found by the check that it is a case for, with the right reason.
#include <gtest/gtest.h>

#include "support/scratch.hpp"
#include "tools/check/run_check.hpp"

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>
#pragma GCC diagnostic pop

namespace {

class Broken : public testing::TestWithParam<Defect> {};

TEST_P(Broken, IsFound) {
    const Defect& defect = GetParam();
    std::vector<std::string> words = {"--only", defect.check};
    if (defect.lanes) words.insert(words.end(), {"--lanes", defect.lanes});
    expect_found(check(defect.library, words, 1), defect);
}

const Defect kDefects[] = {
    // what builders write
    {"dropped", "builds.refs", {"primitives are in no leaf", "rays cannot hit them"}},
    {"half", "builds.refs", {"primitives are in no leaf"}},
    {"dropped_at_limit", "builds.parameters", {"max_leaf=1", "in no leaf"}},
    {"ulp_short", "builds.bounds", {"is in no volume", "rounded to the wrong side"}},
    {"nan_planes", "builds.bounds", {"no volume", "nan"}},
    {"no_root", "builds.sound", {"no root for group 1"}},
    {"overrun", "builds.sound", {"slot broken_nodes"}},
    {"overrun_far", "builds.sound", {"crashed (segmentation fault", "beyond the end of slot broken_nodes"}},
    {"underrun", "builds.sound", {"slot broken_nodes"}},
    {"writes_input", "builds.sound", {"crashed (segmentation fault", "input prims (read-only)"}},
    {"wasteful", "builds.memory", {"slot broken_nodes", "written"}},
    // how builders behave
    {"race", "builds.threads", {"another than with one thread", "race"}},
    {"keeps_state", "builds.state", {"keeps state"}},
    {"writes_later", "builds.afterwards", {"crashed", "slot broken_nodes"}},
    {"ignores_cancel", "builds.cancel", {"must return RT_CANCELLED"}},
    {"leak", "builds.leaks", {"leaks memory"}},
    {"thread_leak", "builds.leaks", {"threads go on"}},
    {"segfault", "builds.sound", {"crashed (segmentation fault", "while building"}},
    {"aborts", "builds.sound", {"crashed (aborted"}},
    {"exits", "builds.sound", {"ended the process (exit code 0)"}},
    {"throws_in_thread", "builds.sound", {"thrown in a thread of the plugin"}},
    {"stack_overflow", "builds.sound", {"stack overflow"}},
    {"build_loop", "builds.sound", {"did not come to an end within 10 s", "while building"}},
    {"memory_hog", "builds.sound", {"memory"}},
    // trees that are wrong without a word
    {"root_of_another", "hits.instances", {"wrong"}},
    {"refs_of_another_group", "hits.instances", {"wrong"}},
    {"leaf_reaches_too_far", "hits.nested", {"behind the last leaf"}},  // the last leaf is one of the shells
    {"last_short", "hits.each", {"hit nothing", "a leaf's last primitive"}},
    {"counts_of_8_bits", "hits.each", {"hit nothing"}},
    {"leaf_far_outside", "hits.random", {"crashed (segmentation fault", "while tracing"}},
    {"leaf_off_by_three", "hits.random", {"wrong"}},
    // refits
    {"refit_forgets_parent", "builds.refit", {"after the refit", "is in no volume"}},
    {"refit_rounds_inwards", "builds.refit", {"after the refit", "no volume"}},
    {"refit_skips", "builds.refit", {"never asked for", "positions in leaf order"}},
    {"refit_asks_twice", "builds.refit", {"asked twice for position"}},
    {"refit_of_all", "builds.refit", {"is in a group that is not changed"}},
    {"refit_ignores_group", "builds.refit", {"wrote outside of its group"}},
    {"refit_only_grows", "builds.refit", {"depends on the pose before"}},
    {"refit_race", "builds.refit", {"another than with one thread"}},
    {"refit_throws", "builds.refit", {"the refit gave up"}},
    // refits on the device
    {"device_ranges_short", "builds.device", {"positions together"}},
    {"device_refit_forgets", "builds.device", {"after the refit", "is in no volume"}},
    {"device_refit_outside", "builds.device", {"wrote to element", "slot broken_nodes"}},
    {"device_no_costs", "builds.device", {"the cost nan"}},
    {"device_constant_costs", "builds.device", {"the cost", "does not follow its boxes"}},
    // trees that the device builds
    {"device_box", "builds.device", {"in groups of 256", "a box that does not hold them"}},
    {"device_loses", "builds.device", {"two leaves of place"}},
    {"device_counts", "builds.device", {"counted", "primitives below node"}},
    {"device_state", "builds.device", {"another tree when its plan runs again"}},
    {"device_group_size", "builds.device", {"with one work-item a group"}},
    {"device_writes_input", "builds.device", {"wrote to the primitives"}},
    {"device_depth", "builds.device", {"reported a depth", "stack would be too small"}},
    {"device_gives_up", "builds.device", {"there is no plan for this"}},
    {"device_small_buffer", "builds.device", {"a step would take", "bytes of buffer"}},
    {"device_unknown_buffer", "builds.device", {"named buffer 1000"}},
    {"device_arguments", "builds.device", {"halves_nodes has 9 arguments", "gives 8"}},
    {"device_no_kernel", "builds.device", {"kernel halves_node cannot be planned"}},
    // kernels
    {"octant", "hits.octants", {"direction signs (-,+,-)"}},
    {"any_forgets_t_max", "hits.limits", {"any-hit", "nothing is between t_min and t_max"}},
    {"any_returns_early", "hits.random", {"any-hit", "but something is hit"}, "4"},
    {"culls_eagerly", "hits.close", {"behind the nearest"}},
    {"axis", "hits.axes", {"wrong"}},
    {"planes", "hits.planes", {"rays with a zero in their direction"}},
    {"first_lane", "hits.random", {"wrong"}, "4"},
    {"lanes_8", "hits.random", {"all in lane 7"}, "8"},
    {"never_incoherent", "hits.random", {"wrong"}, "4"},
    {"device_loop", "hits.random", {"did not come to an end within 10 s", "while tracing"}},
    {"ignores_transform", "hits.instances", {"wrong"}},
    {"writes_t", "hits.random", {"wrong"}},
    {"stops_at_first_leaf", "hits.random", {"behind the nearest"}},
    {"all_stops", "hits.all", {"is not listed", "does not stop at a hit"}},
    {"reads_beyond_slot", "hits.random", {"crashed (segmentation fault", "beyond the end of slot broken_nodes"}},
    {"small_stack", "hits.stack", {"stack was full"}},
    {"forgets_deferred", "hits.stack", {"hit nothing", "has not come back from it"}},
    // boxes and planes without slack, and what is at their edges
    {"no_slack", "hits.floor", {"hit nothing", "need slack"}},
    {"strict_slabs", "hits.floor", {"hit nothing"}},
    {"divides", "hits.splits", {"0 or -0"}},
    {"sign_of_d", "hits.axes", {"hit nothing"}},
    {"rounds_boxes", "hits.edges", {"are wrong"}},
    {"not_far", "hits.distant", {"hit nothing"}},
    {"ends_at_a_million", "hits.scales", {"hit nothing"}},
    {"not_inside", "hits.inside", {"behind the nearest"}},
    // culls a little too much
    {"culls_closely", "hits.decals", {"are lost when t_max is just behind them"}},
    {"culls_leaves", "hits.decals", {"behind the nearest", "begins before the nearest hit"}},
    {"gives_up", "hits.uneven", {"are wrong"}},
    {"gives_up_late", "hits.crowd", {"are wrong", "gave up after a number of steps"}},
    {"lanes_16_any", "hits.random", {"any-hit", "but something is hit"}, "16"},
    // what must be asked
    {"unasked", "hits.pushes", {"it never asked RT_STACK_OK", "stack[BROKEN_STACK]"}},
    {"unasked_any", "hits.pushes", {"refuses every push", "any-hit queries"}},
    {"unasked_mesh", "hits.pushes", {"refuses every push", "nearest hits in meshes"}},
    {"unasked_deep", "hits.pushes", {"refuses all but the first 12 pushes", "one path down the tree"}},
    {"unasked_from_8", "hits.pushes", {"refuses all but the first 12 pushes", "at many triangles whose boxes overlap"}},
    {"unasked_odd", "hits.pushes", {"refuses all but the first 12 pushes"}},
    {"world_stack", "hits.stack", {"stack was full", "must hold the deepest tree"}},
    {"own_test", "hits.counts", {"tested none through the host"}},
    {"defines_lanes", "builds.sound", {"a define the name 'RT_LANES'", "are the host's"}},
    {"redefines_lanes", "hits.kernels", {"broken.cl:1", "`#define RT_LANES`"}},
    // sizes, ends and empty groups
    {"cut_positions", "hits.large", {"are wrong"}},
    {"random_when_large", "builds.threads", {"another than with one thread"}},
    {"wrong_at_most", "hits.parameters", {"with broken,max_leaf=8", "are wrong"}},
    // Code that one choice, or many primitives, turn on; wrong with several lanes alone.
    {"wrong_choice", "hits.parameters", {"way=second", "with 4 lanes", "are lost when t_max"}, nullptr},
    {"wrong_when_large", "hits.large", {"with 4 lanes", "behind the nearest"}, nullptr},
    {"reads_past_empty", "hits.empty", {"beyond the end of slot broken_nodes", "element 1"}},
    {"cuts_needles", "builds.bounds", {"is in no volume"}},
    // said well
    {"roots_rotated", "builds.bounds", {"root", "of the tree of group"}},
    {"leaf_very_far", "hits.random", {"crashed", "beyond the end of the leaves", "element"}},
    {"node_far_outside", "hits.random", {"crashed", "beyond the end of slot broken_nodes", "element"}},
    {"refit_constant_cost", "builds.refit", {"the cost", "does not follow its boxes"}},
    {"refit_costs_of_before", "builds.refit", {"the cost", "does not follow its boxes"}},
    {"refit_costs_of_world", "builds.refit", {"reports the cost of the world, but never that of group"}},
    {"refit_moves_leaves", "hits.refit", {"after a refit"}},
    {"build_after_refit", "hits.refit", {"after a refit and a new build"}},
};
INSTANTIATE_TEST_SUITE_P(Plugins, Broken, testing::ValuesIn(kDefects), name_of);

struct Counts {
    size_t red = 0, grey = 0;
};
Counts colors_of(const std::string& path) {
    int width = 0, height = 0, channels = 0;
    Counts counts;
    unsigned char* data = stbi_load(path.c_str(), &width, &height, &channels, 3);
    EXPECT_NE(data, nullptr) << path << ": " << stbi_failure_reason();
    for (int i = 0; i < width * height; ++i) {
        const unsigned char* p = data + 3 * i;
        counts.red += p[0] == 255 && p[1] == 0 && p[2] == 0;
        counts.grey += p[0] == p[1] && p[1] == p[2];
    }
    stbi_image_free(data);
    EXPECT_EQ(counts.red + counts.grey, size_t(width) * size_t(height));
    return counts;
}

// The pixels of one octant are wrong: they are red, and the others show the scene.
TEST(Report, APictureShowsWhichPixelsDiffer) {
    const Scratch scratch;
    const std::string folder = scratch.path("report");
    const nlohmann::json results = check("octant", {"--only", "hits.octants", "--lanes", "4", "--report", folder}, 1);
    ASSERT_EQ(results.size(), 1u) << results;
    const std::string picture = folder + "/broken.hits.octants.png", report = results[0]["report"];
    EXPECT_NE(report.find("broken.hits.octants.rays"), std::string::npos) << report;
    EXPECT_NE(report.find(picture), std::string::npos) << report;
    const Counts counts = colors_of(picture);
    EXPECT_GT(counts.red, 0u);
    EXPECT_GT(counts.grey, counts.red / 100);
    EXPECT_NE(report.find(std::to_string(counts.red) + " of " + std::to_string(counts.red + counts.grey) + " pixels differ"),
              std::string::npos)
        << report;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        EXPECT_TRUE(entry.path().extension() == ".png" || entry.path().extension() == ".rays") << entry.path() << " is left";
}

// The user's own scene and rays.
TEST(OwnScene, WrongHitsAreFound) {
    const Scratch scratch;
    scratch.write("a.scene", "sphere center 0 0 0 radius 1\n");
    scratch.write("a.rays", "10 -8 10 0 -1 0.8 -1 inf\n");
    expect_found(check("octant", {"--scene", scratch.path("a.scene"), "--rays", scratch.path("a.rays"), "--lanes", "1"}, 1),
                 {"octant", "hits.own", {"1 of 1 nearest hits are wrong", "hit nothing, but there is something"}});
}

// Rays in a tree that lacks a primitive.
TEST(Device, RaysMissWhatIsInNoLeaf) {
    expect_found(check("device_loses", {"--only", "hits.device"}, 1),
                 {"device_loses", "hits.device", {"after a build", "wrong"}});
}

// Without a defect the same plugin passes: so the tests above fail because of the defect.
TEST(Sound, PluginPasses) {
    for (const char* library : {"none", "device_none"}) {
        const nlohmann::json results = check(library, {}, 0);
        ASSERT_TRUE(results.is_array());
        EXPECT_GE(results.size(), 20u);
        for (const auto& result : results) EXPECT_NE(result["status"], "failed") << result.dump(2);
    }
}

}  // namespace
