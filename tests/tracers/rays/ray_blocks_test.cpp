// ray_blocks_test.cpp -- packs the caller's rays for kernels and unpacks answers: blocks of all lane counts, full or not.
#include "tracers/rays/ray_blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.hpp"
#include "support/generated.hpp"
#include "support/scenes.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

constexpr unsigned kLanes[] = {1, 4, 8, 16};
constexpr size_t kCounts[] = {1, 3, 4, 15, 16, 17, 33, 20000};  // the last one needs more than one task

std::vector<rt_ray> numbered_rays(size_t count) {
    std::vector<rt_ray> rays(count);
    for (size_t i = 0; i < count; ++i) {
        float fields[8];
        for (int k = 0; k < 8; ++k) fields[k] = float(8 * i) + float(k);
        std::memcpy(&rays[i], fields, sizeof fields);
    }
    return rays;
}

// Rays through a tilted grid over the unit ball: some hit, some miss.
std::vector<rt_ray> rays_at_ball(size_t count) {
    std::vector<rt_ray> rays;
    for (size_t i = 0; i < count; ++i) {
        const float x = 1.3f * std::sin(0.7f * float(i)), y = 1.3f * std::cos(1.9f * float(i));
        rays.push_back({{x, y, 5}, 0, {0.02f * y, -0.03f * x, -1}, i % 7 == 3 ? 4.2f : INFINITY});
    }
    return rays;
}

ScenePtr ball() {
    static const ScenePtr scene = shared_scene(scene_of(uv_sphere(1, 24, 12)));
    return scene;
}

std::vector<rt_hit> traced(unsigned lanes, const std::vector<rt_ray>& rays, RayQuery query) {
    return Workbench::get().rays(ball(), make_settings({{"accel", "bvh2"}, {"lanes", std::to_string(lanes)}}), rays, query);
}

std::vector<rt_hit> unpacked(const std::vector<float>& answers, size_t count, rt_u32 fields) {
    std::vector<rt_hit> hits(count);
    unpack_hits(answers.data(), count, answer_stride(count), fields,
                [&](size_t first, size_t some, const rt_hit* from) { std::copy(from, from + some, &hits[first]); });
    return hits;
}

}  // namespace

TEST(RayBlocks, StoreRaysFieldByField) {
    for (const unsigned lanes : kLanes)
        for (const size_t count : kCounts) {
            const RayBlocks blocks(numbered_rays(count), lanes);
            EXPECT_EQ(blocks.ray_count(), count);
            EXPECT_EQ(blocks.lanes(), lanes);
            ASSERT_EQ(blocks.block_count(), (count + lanes - 1) / lanes);
            ASSERT_EQ(blocks.floats().size(), blocks.block_count() * lanes * 8);
            for (size_t i = 0; i < blocks.block_count() * lanes; ++i)
                for (size_t k = 0; k < 8; ++k) {
                    const float found = blocks.floats()[(i / lanes * 8 + k) * lanes + i % lanes];
                    const float like_last = float(8 * std::min(i, count - 1) + k);
                    ASSERT_EQ(found, i >= count && k == 7 ? -1 : like_last) << lanes << " lanes, ray " << i << " of " << count;
                }
        }
    EXPECT_EQ(RayBlocks({}, 16).block_count(), 0u);
    EXPECT_TRUE(RayBlocks({}, 16).floats().empty());
}

// With one lane, rays have the layout of the struct.
TEST(RayBlocks, WithOneLaneHaveTheLayoutOfTheStruct) {
    const std::vector<rt_ray> rays = numbered_rays(5);
    const RayBlocks blocks(rays, 1);
    EXPECT_EQ(std::memcmp(blocks.floats().data(), rays.data(), sizeof(rt_ray) * rays.size()), 0);
}

TEST(RayBlocks, AnswersAreArraysOneAfterTheOther) {
    for (const size_t count : kCounts) {
        const size_t stride = answer_stride(count);
        ASSERT_TRUE(stride >= count && stride % 64 == 0);
        std::vector<float> answers(stride * kAnswerCounted, -77);
        const auto put = [&](size_t field, size_t i, auto number) {
            std::memcpy(&answers[field * stride + i], &number, sizeof number);
        };
        for (size_t i = 0; i < count; ++i) {
            const auto n = rt_u32(i);
            put(0, i, float(i) + .5f);
            put(1, i, rt_i32(3 * i));
            put(2, 2 * i, float(i) + .25f);
            put(2, 2 * i + 1, float(i) + .125f);
            put(4, i, rt_i32(i % 5) - 1);
            for (const rt_u32 k : {5u, 6u, 7u, 8u, 9u, 10u, 11u}) put(k, i, k * n);
        }
        const auto counted = unpacked(answers, count, kAnswerCounted), placed = unpacked(answers, count, RT_ANSWER_PLACED),
                   plain = unpacked(answers, count, RT_ANSWER_HIT), nearest = unpacked(answers, count, RT_ANSWER_NEAREST),
                   occlusion = unpacked(answers, count, RT_ANSWER_OCCLUSION);
        const std::vector<RayWork> work = unpack_work(answers.data(), count, stride);
        for (size_t i = 0; i < count; ++i) {
            const auto n = rt_u32(i);
            for (const rt_hit& hit : {counted[i], placed[i], plain[i], nearest[i], occlusion[i]})
                ASSERT_EQ(hit.t, float(i) + .5f);
            for (const rt_hit& hit : {counted[i], placed[i], plain[i], nearest[i]}) ASSERT_EQ(hit.prim, rt_i32(3 * i));
            for (const rt_hit& hit : {counted[i], placed[i], plain[i]})
                ASSERT_TRUE(hit.u == float(i) + .25f && hit.v == float(i) + .125f) << i;
            for (const rt_hit& hit : {counted[i], placed[i]}) ASSERT_EQ(hit.instance, rt_i32(i % 5) - 1);
            ASSERT_TRUE(counted[i].steps == 5 * n && counted[i].leaf_tests == 6 * n && counted[i].lane_steps == 7 * n);
            ASSERT_TRUE(work[i].boxes == 8 * n && work[i].own_steps == 9 * n && work[i].own_boxes == 10 * n &&
                        work[i].own_tests == 11 * n);
            ASSERT_EQ(placed[i].steps + placed[i].leaf_tests + placed[i].lane_steps, 0u);
            ASSERT_TRUE(plain[i].instance == -1 && nearest[i].u == 0 && occlusion[i].prim == -1);
        }
    }
}

// On the device: answers do not depend on the lane count, on blocks being full, or on counting.
TEST(RayBlocks, HitsDoNotDependOnLanes) {
    const std::vector<rt_ray> all = rays_at_ball(333);
    const std::vector<rt_hit> nearest = traced(1, all, {false, false}), any = traced(1, all, {true, false});
    for (const unsigned lanes : kLanes) {
        const std::vector<rt_hit> brief = traced(lanes, all, {false, false, true});
        ASSERT_EQ(brief.size(), all.size());
        for (size_t i = 0; i < all.size(); ++i) {
            ASSERT_EQ(brief[i].t, nearest[i].t) << lanes << " lanes, ray " << i;
            ASSERT_EQ(brief[i].prim, nearest[i].prim) << lanes << " lanes, ray " << i;
        }
    }
    size_t met = 0, occluded = 0;
    for (size_t i = 0; i < all.size(); ++i) {
        met += nearest[i].prim >= 0;
        occluded += any[i].t == 0;
        EXPECT_EQ(any[i].t, nearest[i].prim >= 0 ? 0 : INFINITY) << "ray " << i;
    }
    EXPECT_EQ(met, occluded);
    EXPECT_GT(met, 50u);
    EXPECT_LT(met, 300u);
    for (const unsigned lanes : kLanes)
        for (const size_t count : {1, 5, 16, 17, 333})
            for (const bool count_too : {false, true}) {
                const std::vector<rt_ray> rays(all.begin(), all.begin() + count);
                const auto hits = traced(lanes, rays, {false, count_too}), shadows = traced(lanes, rays, {true, count_too});
                ASSERT_EQ(hits.size(), count);
                ASSERT_EQ(shadows.size(), count);
                for (size_t i = 0; i < size_t(count); ++i) {
                    const std::string what = std::to_string(lanes) + " lanes, ray " + std::to_string(i);
                    ASSERT_EQ(hits[i].t, nearest[i].t) << what;
                    ASSERT_EQ(hits[i].prim, nearest[i].prim) << what;
                    ASSERT_EQ(hits[i].instance, nearest[i].instance) << what;
                    ASSERT_EQ(hits[i].u, nearest[i].u) << what;
                    ASSERT_EQ(hits[i].v, nearest[i].v) << what;
                    ASSERT_EQ(shadows[i].t, any[i].t) << what;
                    ASSERT_EQ(hits[i].steps > 0, count_too) << what;
                    ASSERT_EQ(shadows[i].steps > 0, count_too) << what;
                }
            }
}

TEST(RayBlocks, PackedForOtherLanesAreRefused) {
    Workbench& bench = Workbench::get();
    const auto prepared = bench.prepare(ball(), make_settings({{"accel", "bvh2"}, {"lanes", "4"}}));
    std::vector<rt_hit> hits(2);
    EXPECT_THROW(bench.queries().trace(*prepared, RayBlocks(rays_at_ball(20), 8), {}, &hits), Error);
    bench.queries().trace(*prepared, RayBlocks({}, 4), {}, &hits);
    EXPECT_TRUE(hits.empty());
}
