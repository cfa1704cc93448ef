// shape_test.cpp -- each broken shape is found by the check that it is a case for, with the right reason.
#include <gtest/gtest.h>

#include "tools/check/run_check.hpp"

namespace {

class BrokenShape : public testing::TestWithParam<Defect> {};

TEST_P(BrokenShape, IsFound) {
    const Defect& defect = GetParam();
    std::vector<std::string> words = {"--only", defect.check, "--lanes", "1"};
    if (defect.lanes != std::string("1")) words.insert(words.end(), {"--lanes", defect.lanes});
    expect_found(check(std::string("shape_") + defect.library, words, 1), defect);
}

const Defect kShapeDefects[] = {
    // on the host
    {"crashes", "keys.values", {"crashed (segmentation fault"}},
    {"endless", "keys.values", {"did not come to an end"}},
    {"exits", "keys.values", {"ended the process (exit code 0)"}},
    {"no_reason", "keys.values", {"refused without a reason"}},
    {"box_inside_out", "keys.ends", {"`radius` at its greatest value", "box that is not finite, too large or inside out"}},
    {"keeps_state", "keys.state", {"keeps state"}},
    {"leaks", "keys.leaks", {"leaks memory"}},
    // hits
    {"does_not_compile", "hits.kernels", {"for 1 lane"}},
    {"small_box", "hits.box", {"outside of the box"}},
    {"forgets_t_min", "hits.box", {"below t_min"}},
    {"nan", "hits.box", {"no number"}},
    {"far_root", "hits.again", {"rays miss the surface"}},
    {"octant", "hits.again", {"direction signs (-,+,-)"}},
    {"one_sided", "hits.again", {"come from behind the surface"}},
    {"axis", "hits.again", {"rays miss the surface"}},
    {"slim", "hits.again", {"rays miss the surface"}},
    {"hole", "hits.again", {"rays miss the surface"}},
    {"loop", "hits.again", {"did not come to an end"}},
    {"reads_beyond", "hits.again", {"crashed (segmentation fault", "numbers of the shape"}},
    {"unit_direction", "hits.length", {"not of unit length"}},
    {"first_lane", "hits.lanes", {"with 4 lanes", "every lane must be computed by itself"}, "4"},
    {"lanes_8", "hits.lanes", {"in lane 7"}, "8"},
    {"zero_radius", "hits.ends", {"`radius` at its least value", "no number"}},
    // the surface
    {"wrong_radius", "surface.height", {"heights disagree with the hits"}},
    {"wrong_scale", "surface.height", {"along the normal has the height"}},
    {"wrong_normal", "surface.normal", {"normals are not across the surface"}},
    {"inward", "surface.normal", {"normals point outwards"}},
    {"wrong_uv", "surface.uv", {"not within 0 and 1"}},
    {"uv_seam", "surface.uv", {"u jumps by", "while the surface is smooth"}},
    {"uv_off_centre", "surface.uv", {"v comes to its end", "u does not turn"}},
    {"uv_world_centre", "surface.uv", {"v comes to its end", "u does not turn"}},
    {"uv_twice", "surface.uv", {"u goes from 1 to 0", "begins anew within the surface"}},
    {"uv_constant", "surface.uv", {"a picture has no area there"}},
    {"uv_one_direction", "surface.uv", {"a picture has no area there"}},
    {"uv_steps", "surface.uv", {"a picture has no area there"}},
    {"uv_clamped", "surface.uv", {"a picture has no area there"}},
    {"uv_halves", "surface.uv", {"v goes from 1 to 0", "begins anew within the surface"}},
    {"uv_never_ends", "surface.uv", {"u jumps by 0.2"}},
    {"uv_mirrored_half", "surface.uv", {"around this point u does not turn"}},
    {"inexact", "surface.leaving", {"make s->error larger"}},
};
INSTANTIATE_TEST_SUITE_P(Plugins, BrokenShape, testing::ValuesIn(kShapeDefects), name_of);

// Without a defect the same plugin passes: so the tests above fail because of the defect.
TEST(SoundShape, Passes) {
    const nlohmann::json results = check("shape_none", {}, 0);
    ASSERT_TRUE(results.is_array());
    EXPECT_GE(results.size(), 15u);
    for (const auto& result : results) EXPECT_NE(result["status"], "failed") << result.dump(2);
}

}  // namespace
