// requeued_rays_test.cpp -- the caller's own rays in one launch, in two, with dynamic fetch, and a warp's rays together.
// The autotuner chooses the variant, so the same rays are traced often enough to cover all.
#include "tracers/rays/autotuner.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "support/generated.hpp"
#include "tracers/rays/ray_blocks.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

constexpr unsigned kTries = 15;
constexpr rt_u32 kLong = 64;  // steps: a node or two triangles each

// Rays towards the rubble from all sides. Some are horizontal, some reach only half-way, some are inactive.
std::vector<rt_ray> rays_at_rubble(int count) {
    std::vector<rt_ray> rays;
    for (int i = 0; i < count; ++i) {
        const float a = 0.7f * float(i), b = 1.9f * float(i), x = 6 * std::sin(a), y = 2 * std::cos(b), z = 6 * std::cos(a);
        const float tx = 2 * std::sin(3 * b), ty = 2 * std::cos(5 * a), tz = 2 * std::sin(7 * a);
        const float dx = tx - x, dy = i % 5 ? ty - y : 0, dz = tz - z, length = std::sqrt(dx * dx + dy * dy + dz * dz);
        const float reach = i % 11 == 5 ? -1.0f : i % 7 == 3 ? 6.5f : INFINITY;
        rays.push_back({{x, y, z}, 0, {dx / length, dy / length, dz / length}, reach});
    }
    return rays;
}

// Several copies at nearly the same place. Rays find many equal distances, and pass more triangles than they hit.
ScenePtr heap() {
    Scene scene = *rubble();
    for (int i = 0; i < 8; ++i) {
        Instance more = scene.instances[0];
        more.world_from_object[3] = 0.01f * float(i / 2);
        scene.instances.push_back(more);
    }
    scene.spheres.push_back({{0.3f, 0.2f, 0.1f}, 0.4f, 0});
    scene.planes.push_back({{0, 1, 0}, -1.5f, 0});
    return shared_scene(scene);
}

void expect_same_each_time(const ScenePtr& scene, const char* accel = "bvh4", int count = 3000) {
    const std::vector<rt_ray> rays = rays_at_rubble(count);
    const Settings settings = make_settings({{"accel", accel}, {"lanes", "1"}, {"packet", "1x1"}, {"portable", "true"}});
    const auto counted = Workbench::get().rays(scene, settings, rays, RayQuery{false, true});
    EXPECT_GT(
        std::count_if(counted.begin(), counted.end(), [](const rt_hit& hit) { return hit.steps + hit.leaf_tests / 2 > kLong; }),
        10);
    const RayBlocks packed(rays, 1);
    const auto trace = [&](RayQuery query) {
        std::vector<rt_hit> hits;
        Workbench::get().queries().trace(*Workbench::get().prepare(scene, settings), packed, query, &hits);
        return hits;
    };
    for (const bool brief : {false, true})
        for (unsigned i = 0; i < kTries; ++i) {
            const auto hits = trace(RayQuery{false, false, brief});
            ASSERT_EQ(hits.size(), rays.size());
            for (size_t k = 0; k < rays.size(); ++k) {
                ASSERT_EQ(hits[k].t, counted[k].t) << "try " << i << ", ray " << k;
                ASSERT_EQ(hits[k].prim, counted[k].prim) << "try " << i << ", ray " << k;
                if (brief) continue;
                ASSERT_EQ(hits[k].u, counted[k].u) << "try " << i << ", ray " << k;
                ASSERT_EQ(hits[k].v, counted[k].v) << "try " << i << ", ray " << k;
                ASSERT_EQ(hits[k].instance, counted[k].instance) << "try " << i << ", ray " << k;
            }
        }
    for (unsigned i = 0; i < kTries; ++i) {
        const auto shadows = trace(RayQuery{true});
        for (size_t k = 0; k < rays.size(); ++k)
            ASSERT_EQ(shadows[k].t, counted[k].prim >= 0 ? 0 : INFINITY) << "try " << i << ", ray " << k;
    }
}

}  // namespace

TEST(RequeuedRays, GiveTheHitsOfOneLaunch) {
    expect_same_each_time(rubble());
}

TEST(RequeuedRays, GiveTheHitsOfOneLaunchWithInstances) {
    expect_same_each_time(heap());
}

// Each work-item of a group tests some of the primitives.
TEST(RequeuedRays, GiveTheHitsOfOneLaunchWhereWorkItemsShareAList) {
    expect_same_each_time(rubble(), "brute", 1000);
    expect_same_each_time(heap(), "brute", 100);
}

// Scripts trace few sets of rays again and again, and ask different things of them: what was found out about one stays known.
TEST(RayQueries, KnowTheVariantsOfRaysThatComeByTurns) {
    const Settings settings = make_settings({{"accel", "bvh4"}, {"lanes", "1"}, {"packet", "1x1"}, {"portable", "true"}});
    const auto prepared = Workbench::get().prepare(rubble(), settings);
    RayQueries& queries = Workbench::get().queries();
    const RayBlocks some(rays_at_rubble(1000), 1), others(rays_at_rubble(500), 1);
    std::map<std::string, unsigned> uses;  // of the variant that was chosen; times that differ may lead to more trials later
    for (unsigned turn = 0; turn <= kTries; ++turn)
        for (const RayBlocks* rays : {&some, &others})
            for (const RayQuery query : {RayQuery{false}, RayQuery{true}}) {
                queries.trace(*prepared, *rays, query);
                ASSERT_TRUE(turn > 0 || queries.tuning().trial) << "there are several variants";
                uses[std::to_string(rays->ray_count()) + (query.any_hit ? " any-hit rays" : " rays")] +=
                    !queries.tuning().trial;
            }
    for (const auto& [what, count] : uses) EXPECT_GT(count, 0u) << what << " are tried as if they came for the first time";
}

TEST(Autotuner, UsesTheMinimumTimeWithoutTheWarmUp) {
    for (const unsigned variants : {1u, 2u, 3u, 5u})
        for (unsigned best = 0; best < variants; ++best) {
            Autotuner autotuner(variants);
            for (unsigned i = 0; i < 3 * variants; ++i) {
                EXPECT_EQ(autotuner.variant(), i % variants);
                const bool better = i % variants == best;
                autotuner.took(i < variants ? (better ? 9 : 1) : i < 2 * variants ? 50 : better ? 2 : 3);
            }
            for (int i = 0; i < 3; ++i) {
                EXPECT_EQ(autotuner.variant(), best);
                autotuner.took(autotuner.variant() == best ? 100 : 0);
            }
        }
}

TEST(Autotuner, TriesSlowVariantsOnlyTwice) {
    Autotuner autotuner(3);
    std::vector<unsigned> tried;
    for (int i = 0; i < 10; ++i) {
        tried.push_back(autotuner.variant());
        autotuner.took(autotuner.variant() == 1 ? 30 : autotuner.variant() == 2 ? 9 : 10);
    }
    EXPECT_EQ(tried, (std::vector<unsigned>{0, 1, 2, 0, 1, 2, 0, 2, 2, 2}));
}

TEST(Autotuner, KeepsItsChoiceIfTheGainIsSmall) {
    Autotuner autotuner(2);
    for (int i = 0; i < 6; ++i) autotuner.took(i % 2 == 0 ? 100 : 98);
    EXPECT_EQ(autotuner.variant(), 0u);
}

// Runs of variants that take `ms`, on a machine slower by `slowdown`. Returns the number of trials.
unsigned use(Autotuner& autotuner, const std::vector<double>& ms, double slowdown, int runs) {
    unsigned trials = 0;
    for (int i = 0; i < runs; ++i) {
        trials += autotuner.trying();
        autotuner.took(slowdown * ms[autotuner.variant()]);
    }
    return trials;
}

TEST(Autotuner, IsSettledOnceARunConfirmsTheChoice) {
    Autotuner autotuner(2);
    const std::vector<double> ms = {10, 5};
    EXPECT_EQ(use(autotuner, ms, 1, 5), 5u);
    EXPECT_FALSE(autotuner.trying());
    EXPECT_FALSE(autotuner.settled());
    autotuner.took(20);
    EXPECT_FALSE(autotuner.settled()) << "this run took another time than the one that decided the choice";
    autotuner.took(5.2);
    EXPECT_TRUE(autotuner.settled());
    EXPECT_TRUE(Autotuner(1).settled());
    EXPECT_FALSE(Autotuner(1).trying());
}

TEST(Autotuner, ReviewsTheChoiceWhenTimesChange) {
    Autotuner autotuner(2);
    use(autotuner, {10, 12}, 8, 6);
    EXPECT_EQ(autotuner.variant(), 0u);
    const std::vector<double> warm = {10, 7};  // at full clock the second variant is faster
    EXPECT_EQ(use(autotuner, warm, 1, 3), 0u);
    EXPECT_TRUE(autotuner.trying()) << "three runs took an eighth of the time";
    EXPECT_EQ(use(autotuner, warm, 1, 4), 4u);
    EXPECT_EQ(autotuner.variant(), 1u);
    // One or two disturbed runs change nothing.
    for (const double ms : {7.0, 30.0, 30.0, 7.0, 30.0}) autotuner.took(ms);
    EXPECT_FALSE(autotuner.trying());
}

TEST(Autotuner, ReviewsTheChoiceLessAndLessOften) {
    Autotuner autotuner(2);
    const std::vector<double> ms = {10, 9};
    EXPECT_EQ(use(autotuner, ms, 1, 6), 6u);
    EXPECT_EQ(use(autotuner, ms, 1, 16), 0u);
    EXPECT_EQ(use(autotuner, ms, 1, 4), 4u) << "after 16 uses";
    EXPECT_EQ(use(autotuner, ms, 1, 64), 0u);
    EXPECT_EQ(use(autotuner, ms, 1, 4), 4u) << "after 64 more";
    EXPECT_EQ(use(autotuner, ms, 1, 200), 0u);
}

TEST(Autotuner, AMachineThatIsNeverSteadyDoesNotTuneForEver) {
    Autotuner autotuner(2);
    unsigned trials = 0;
    for (int i = 0; i < 2000; ++i) trials += use(autotuner, {10, 9}, i / 5 % 2 ? 1 : 3, 1);
    EXPECT_LT(trials, 100u);
}
