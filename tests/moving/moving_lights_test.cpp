// moving_lights_test.cpp -- surfaces that emit are drawn by `path` where a pose has put them: moved by the device, by the host,
// and in motion blur.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "moving/on_device/device_mover.hpp"
#include "moving/on_host/host_mover.hpp"
#include "moving_scenes.hpp"
#include "scene/motion/pose.hpp"
#include "stand/motion_blur.hpp"
#include "stand/team.hpp"
#include "support/scratch.hpp"
#include "view/view.hpp"

namespace clarity::test {
namespace {

constexpr unsigned kSamples = 64;

// A glowing triangle beside a glowing square of four times the size, and a ball, over a floor. The instances are kept apart.
ScenePtr lit_floor(const Affine& square, const Affine& triangle) {
    TriangleMesh quad, small;
    for (const float x : {-0.5f, 0.5f})
        for (const float z : {-0.5f, 0.5f}) quad.add_vertex(x, 0, z);
    quad.add_triangle(0, 1, 2);
    quad.add_triangle(2, 1, 3);
    small.add_vertex(0, 0, 0), small.add_vertex(0.5f, 0, 0), small.add_vertex(0, 0.25f, 0.5f);
    small.add_triangle(0, 1, 2);
    Scene s = scene_of(quad);
    s.materials[0].values = diffuse(0.7f, 0.7f, 0.7f);
    rt_material glow = diffuse(0, 0, 0);
    glow.emission[0] = glow.emission[1] = glow.emission[2] = 5;
    const rt_u32 glowing = add_material(s, glow);
    s.instances[0].world_from_object = square;
    s.instances[0].material = glowing;
    place(s, add_mesh(s, small), triangle);
    s.instances[1].material = glowing;
    place(s, add_mesh(s, uv_sphere(0.4, 24, 16)), moved_to(0.3f, 0.4f, 0.2f));
    for (Instance& instance : s.instances) instance.apart = true;
    s.planes.push_back({{0, 1, 0}, 0, 0});
    return shared_scene(std::move(s));
}

View view_of_floor() {
    View view = view_from({0, 3, 3}, {0, 0, 0}, 50);
    view.background = {0, 0, 0};
    return view;
}

const Affine kFirst = moved_to(-1.5f, 2, 0), kFirstSmall = moved_to(0.5f, 1.5f, 1);
const Affine kThen = {1.6f, 0, 0, 0.6f, 0, 0.8f, -0.9f, 1.4f, 0, 0.6f, 1.2f, -0.4f};  // turned, stretched
const Affine kThenSmall = {-1, 0, 0, -0.8f, 0, 1, 0, 0.8f, 0, 0, 1, 0.5f};            // mirrored

double mean(const FloatImage& image) {
    double sum = 0;
    for (const float x : image.pixels) sum += x;
    return sum / double(image.pixels.size());
}
double mean_difference(const FloatImage& a, const FloatImage& b) {
    double sum = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) sum += std::fabs(double(a.pixels[i]) - double(b.pixels[i]));
    return sum / double(a.pixels.size());
}

class MovingLights : public ::testing::TestWithParam<const char*> {
 protected:
    MovingLights() : preparer_(Workbench::get().plugins(), Workbench::get().shared_device()) {}
    Settings settings() const {
        return make_settings({{"tracer", "path"},
                              {"strategy", GetParam()},
                              {"accel", "bvh4"},
                              {"lanes", "4"},
                              {"packet", "4x4"},
                              {"size", "48x32"},
                              {"depth", "2"}});
    }
    FloatImage picture(const Prepared& prepared) {
        Workbench& bench = Workbench::get();
        bench.frames().trace(prepared, settings(), view_of_floor(), Samples(0, kSamples), false, progress_);
        return bench.frames().read_values();
    }
    Preparer preparer_;
    Progress progress_;
};

// The same random numbers draw the same points, wherever the structure was moved: the noise is the same, too.
void expect_same(const FloatImage& moved, const FloatImage& built, const FloatImage& before) {
    EXPECT_GT(mean(built), 0.02);
    EXPECT_LT(mean_difference(moved, built), 1e-3 * mean(built));
    EXPECT_GT(mean_difference(moved, before), 0.1 * mean(built)) << "they did not move";
}

TEST_P(MovingLights, FollowPosesOnTheDevice) {
    const ScenePtr scene = lit_floor(kFirst, kFirstSmall);
    const auto prepared = preparer_.prepare(scene, settings(), progress_);
    const FloatImage before = picture(*prepared),
                     built = picture(*preparer_.prepare(lit_floor(kThen, kThenSmall), settings(), progress_));
    DeviceMover mover(Workbench::get().shared_device(), scene, prepared->accel, prepared->on_device, nullptr,
                      BuildForm::automatic);
    ASSERT_EQ(mover.cannot(), "");
    Pose pose = pose_at_rest(*scene);
    pose.instances[0].world_from_object = kThen;
    pose.instances[1].world_from_object = kThenSmall;
    for (const auto update : {DeviceMover::Update::refit, DeviceMover::Update::build}) {
        if (update == DeviceMover::Update::build && !mover.can_build()) continue;
        // To and fro, so that the buffers of an earlier pose are used again.
        for (int i = 0; i < 4; ++i) {
            const MovedOnDevice back = mover.move(pose_at_rest(*scene), update), moved = mover.move(pose, update);
            ASSERT_TRUE(back.on_device && moved.on_device) << moved.why;
            if (i == 0 || i == 3)
                expect_same(picture(*preparer_.prepare(scene, settings(), progress_, mover.accel(), {moved.on_device, true})),
                            built, before);
        }
    }
}

TEST_P(MovingLights, FollowPosesOnTheHost) {
    const ScenePtr scene = lit_floor(kFirst, kFirstSmall), posed = lit_floor(kThen, kThenSmall);
    const auto prepared = preparer_.prepare(scene, settings(), progress_);
    const FloatImage before = picture(*prepared), built = picture(*preparer_.prepare(posed, settings(), progress_));
    HostMover mover(scene, prepared->accel);
    Pose pose = pose_at_rest(*scene);
    pose.instances[0].world_from_object = kThen;
    pose.instances[1].world_from_object = kThenSmall;
    const MovedStructure moved = mover.move(pose, false, progress_);
    ASSERT_TRUE(moved.accel) << moved.why;
    expect_same(picture(*preparer_.prepare(posed, settings(), progress_, moved.accel)), built, before);
}

// Means over the columns of the picture's six parts.
std::array<double, 6> parts(const FloatImage& image) {
    std::array<double, 6> sums{};
    for (size_t i = 0; i < image.pixels.size(); i += 3) {
        const size_t column = i / 3 % image.width;
        sums[column * 6 / image.width] += image.pixels[i] / (image.width * image.height / 6.0);
    }
    return sums;
}

// A lamp that goes from left to right, and turns, while the shutter is open.
TEST_P(MovingLights, BlurIsTheMeanOfStillPictures) {
    Scratch scratch;
    scratch.write("lamp.obj", "v -.6 0 -.6\nv .6 0 -.6\nv .6 0 .6\nv -.6 0 .6\nf 1 2 3 4\n");
    const ScenePtr rest = load_scene(scratch.write("moves.scene",
                                                   "camera main eye 0 3 3 target 0 0 0 fov 50\nbackground 0 0 0\n"
                                                   "material glow color 0 0 0 emission 4 4 4\nmaterial matt color .7 .7 .7\n"
                                                   "plane normal 0 1 0 offset 0 material matt\n"
                                                   "load lamp.obj name lamp material glow\n"
                                                   "animate lamp translate 0 -1.5 1.5 0  1 1.5 1.5 0\n"
                                                   "animate lamp rotate 0 0 0 1 0  1 0 0 1 30\n"));
    Settings blurred = settings();
    blurred.spp = 256;
    blurred.shutter = 1;
    Team team("cpu");
    const auto scene_at = [&](double time_s) {
        return std::make_shared<const Scene>(posed(*rest, evaluate(*rest, {}, time_s)));
    };
    const ScenePtr middle = scene_at(0.5);
    const View view = make_view(*middle, 1.5f);
    MotionBlur::Source source;
    source.rest = rest;
    MotionBlur blur(source, {0.5, 1, 256}, team.preparer.prepare(middle, with_optics(blurred, *middle, view), team.progress));
    for (unsigned i = 0; i < 256; ++i) {
        const MotionBlur::Sample& sample = blur.at(i, view, team.progress);
        team.frames.trace(sample.prepared, blurred, *sample.view, i, false, team.progress);
    }
    EXPECT_EQ(blur.refitted(), 256u);
    const std::array<double, 6> seen = parts(team.frames.read_values());
    std::array<double, 6> wanted{};
    for (int i = 0; i < 32; ++i) {
        team.trace(scene_at((i + 0.5) / 32), settings(), view, 0, 32);
        const std::array<double, 6> one = parts(team.frames.read_values());
        for (size_t k = 0; k < 6; ++k) wanted[k] += one[k] / 32;
    }
    for (size_t k = 0; k < 6; ++k) EXPECT_NEAR(seen[k], wanted[k], 0.04 * wanted[k]) << "part " << k;
}

INSTANTIATE_TEST_SUITE_P(Strategies, MovingLights, ::testing::Values("nee", "bsdf", "mis"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace clarity::test
