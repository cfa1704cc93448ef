// packet_streams_test.cpp -- packets that are traced together as a stream find bit for bit what each of them finds alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "support/generated.hpp"
#include "view/settings/accel_choice.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

// A packet of one block is traced alone. A packet with as many pixels in each direction as there are lanes is a whole stream.
std::vector<rt_hit> trace(const ScenePtr& scene, int lanes, bool together, bool portable, const std::vector<rt_ray>& rays,
                          RayQuery query) {
    Settings settings = make_settings({});
    if (together)
        Configuration{"bvh8", lanes, lanes, lanes}.apply(settings);
    else
        Configuration{"bvh8", lanes, lanes == 4 ? 2 : 4, lanes == 16 ? 4 : 2}.apply(settings);
    settings.portable = portable;
    return Workbench::get().rays(scene, settings, rays, query);
}

class Beams {
 public:
    // Adds rays for at least one stream. They start near one point or anywhere in a square. Their directions are within
    // `spread` of a common one, which may be close to the border of an octant.
    void add(float square, float spread, bool at_border) {
        Point eye, along, from;
        for (int k = 0; k < 3; ++k) eye[k] = 2 * at(), along[k] = 0.5f * at() - eye[k];
        if (at_border) along[count_++ % 3] = 0.01f * spread * at();
        for (int i = 0; i < 256; ++i) {
            rt_ray ray{};
            for (int k = 0; k < 3; ++k) {
                from[k] = eye[k] + square * at();
                ray.origin[k] = from[k];
                ray.direction[k] = along[k] + spread * at();
            }
            ray.t_max = std::numeric_limits<float>::infinity();
            rays.push_back(ray);
        }
    }
    float at() { return at_(random_); }

    std::vector<rt_ray> rays;

 private:
    std::mt19937 random_{21};
    std::uniform_real_distribution<float> at_{-1, 1};
    size_t count_ = 0;
};

std::vector<rt_ray> all_beams() {
    Beams beams;
    for (int i = 0; i < 8; ++i)
        for (const bool at_border : {false, true})
            for (const float square : {0.0f, 0.02f, 1.0f})
                for (const float spread : {0.001f, 0.1f, 0.8f}) beams.add(square, spread, at_border);
    return beams.rays;
}

// Rubble, and among it copies of a part of it, rotated, stretched and overlapping, and balls.
ScenePtr instanced_rubble() {
    Scene scene = *rubble();
    const Instance whole = scene.instances.at(0);
    Mesh part = scene.meshes.at(whole.mesh);
    part.triangle_count = 200;
    scene.meshes.push_back(part);
    std::mt19937 random(23);
    std::uniform_real_distribution<float> at(-1, 1);
    for (int i = 0; i < 40; ++i) {
        Instance copy = whole;
        copy.mesh = static_cast<rt_u32>(scene.meshes.size() - 1);
        for (int k = 0; k < 12; ++k) copy.world_from_object[k] = k % 4 == 3 ? 1.5f * at(random) : 0.4f * at(random);
        scene.instances.push_back(copy);
    }
    for (int i = 0; i < 5; ++i) {
        Sphere ball;
        ball.center = {at(random), at(random), at(random)};
        ball.radius = 0.3f;
        scene.spheres.push_back(ball);
    }
    return shared_scene(std::move(scene));
}

void expect_as_alone(const ScenePtr& scene, const std::vector<rt_ray>& rays, size_t least_hits,
                     const std::vector<int>& lane_counts) {
    for (const int lanes : lane_counts)
        for (const bool portable : {false, true})
            for (const bool any_hit : {false, true}) {
                if (portable && lanes == 16) continue;  // takes longest to compile
                const std::vector<rt_hit> alone = trace(scene, lanes, false, portable, rays, {any_hit}),
                                          together = trace(scene, lanes, true, portable, rays, {any_hit});
                size_t hits = 0, different = 0;
                for (size_t i = 0; i < rays.size(); ++i) {
                    hits += std::isfinite(alone[i].t);
                    different += std::memcmp(&alone[i], &together[i], any_hit ? sizeof(float) : offsetof(rt_hit, steps)) != 0;
                }
                EXPECT_GE(hits, least_hits);
                EXPECT_EQ(different, 0u) << lanes << " lanes" << (portable ? ", portable" : "") << (any_hit ? ", any hit" : "");
            }
}

}  // namespace

TEST(PacketStreams, BeamsOfAllWidths) {
    expect_as_alone(rubble(), all_beams(), 10000, {4, 8, 16});
}

// The packets of a stream that reach an instance enter it one after the other.
TEST(PacketStreams, InstancedScene) {
    expect_as_alone(instanced_rubble(), all_beams(), 10000, {16});
}

// Lanes and whole packets without rays, and rays with intervals that begin late and end early.
TEST(PacketStreams, InactiveRaysAndIntervals) {
    std::vector<rt_ray> rays = all_beams();
    std::mt19937 random(22);
    std::uniform_real_distribution<float> t(0, 4);
    for (size_t i = 0; i < rays.size(); ++i) {
        rays[i].t_min = 0.3f * t(random);
        rays[i].t_max = t(random);
        if (i / 16 % 5 == 2 || random() % 3 == 0) rays[i].t_max = -1;
    }
    expect_as_alone(rubble(), rays, 3000, {16});
}

// Numbers of packets that are no multiple of a stream's.
TEST(PacketStreams, IncompleteLastStream) {
    std::vector<rt_ray> rays = all_beams();
    for (const size_t left : {1, 17, 255, 256 + 40}) {
        rays.resize(left);
        expect_as_alone(rubble(), rays, 0, {16});
    }
}

// Streams count each packet's visits separately, so fetching a node once for all saves nothing here. But no packet may visit
// many more nodes than alone.
TEST(PacketStreams, VisitHardlyMoreNodesThanSinglePackets) {
    const std::vector<rt_ray> rays = all_beams();
    RayQuery counted;
    counted.count = true;
    uint64_t alone = 0, together = 0;
    for (const rt_hit& hit : trace(rubble(), 16, false, false, rays, counted)) alone += hit.steps;
    for (const rt_hit& hit : trace(rubble(), 16, true, false, rays, counted)) together += hit.steps;
    EXPECT_GT(together, alone * 9 / 10);
    EXPECT_LT(together, alone * 11 / 10);
}

// Triangles smaller than pixels, all half mirrors. Mirror and shadow rays start far apart compared with that size, so packets
// of a stream are split. This must not change any bit of the picture.
TEST(PacketStreams, SplittingAStreamChangesNoPixel) {
    Scene scene = scene_of(torus(1, 0.4, 200, 100));
    const ScenePtr shared = shared_scene(std::move(scene));
    View view = view_from({1, 3, 2}, {0, 0, 0}, 40);
    rt_light light{};
    light.position[0] = 3, light.position[1] = 0.5f, light.position[2] = -1;
    light.color[0] = light.color[1] = light.color[2] = 1;
    view.lights = {light};
    rt_material half = diffuse(0.8f, 0.8f, 0.8f);
    half.reflect = 0.5f;
    view.materials.assign(shared->materials.size(), half);
    FloatImage reference;
    for (const char* accel : {"bvh8,incoherent=packets", "bvh8,incoherent=single"})
        for (const int lanes : {16, 8}) {
            Settings settings = make_settings({{"size", "48x36"}, {"depth", "4"}});
            choose_accel(Workbench::get().plugins(), accel, settings);
            settings.lanes = lanes;
            settings.packet_w = settings.packet_h = lanes;
            FrameStats stats;
            const FloatImage image = Workbench::get().values(shared, settings, view, &stats);
            if (reference.pixels.empty()) {
                reference = image;
                EXPECT_GT(stats.secondary, 500u);
                EXPECT_GT(stats.shadow, 300u);
                EXPECT_GT(*std::max_element(image.pixels.begin(), image.pixels.end()), 0.2f);
                continue;
            }
            ASSERT_EQ(image.pixels.size(), reference.pixels.size());
            EXPECT_EQ(std::memcmp(image.pixels.data(), reference.pixels.data(), image.pixels.size() * sizeof(float)), 0)
                << accel << ", " << lanes << " lanes";
        }
}
