// pictures_test.cpp -- compares `--aov t` and `prim` with Embree: real scenes, every structure, all lane counts and packet
// sizes.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "conformance/compare.hpp"
#include "conformance/degenerate.hpp"
#include "support/scenes.hpp"
#include "support/scratch.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

// A scene, its camera, and the oracle's answers at the two picture sizes.
class Case {
 public:
    Case(ScenePtr scene, const std::string& camera) : Case(scene, make_view(*scene, 4.0f / 3, camera)) {}
    Case(ScenePtr scene, const View& view) : scene_(geometry_of(scene)), view_(view), oracle_(scene_) {}

    // Compares the AOVs of one configuration with the oracle, and its distances, bit for bit, with the first of this size.
    Comparison picture(const Configuration& configuration, int width, int height, bool with_prims) {
        Settings settings = make_settings({{"aov", "t"}});
        configuration.apply(settings);
        settings.width = width;
        settings.height = height;
        look(width, height);
        const FloatImage t = bench().values(scene_, settings, view_);
        if (first_.pixels.size() != t.pixels.size()) {
            first_ = t;
            first_of_ = configuration.text();
        } else if (!hostile_) {
            EXPECT_EQ(other_bits(first_, t), 0u) << configuration.text() << " against " << first_of_;
        }
        FloatImage prims;
        if (with_prims) {
            settings.aov = "prim";
            prims = bench().values(scene_, settings, view_);
        }
        return compare(oracle_, truth_, rays_, t.pixels, with_prims ? &prims.pixels : nullptr);
    }

    // Compares a large picture with primitives for each of `large`, and then small pictures for all other configurations.
    void check(const std::vector<std::string>& large, const std::vector<Configuration>& small) {
        for (const std::string& accel : large) {
            const Configuration configuration{accel, 16, 4, 4};
            const Comparison c = picture(configuration, 1024, 768, true);
            expect(c, configuration.text());
            if (!hostile_) {
                EXPECT_LE(c.differing(), c.rays / 100000) << configuration.text() << ": " << c.text();
            }
        }
        size_t turn = 0;
        for (const Configuration& configuration : small)
            expect(picture(configuration, 259, 193, turn++ % 4 == 0), configuration.text());
    }
    // For scenes with surfaces at grazing angles up to the horizon: differences that the rounding of rays explains are allowed.
    Case& hostile() {
        hostile_ = true;
        return *this;
    }

 private:
    static size_t other_bits(const FloatImage& a, const FloatImage& b) {
        size_t count = 0;
        for (size_t i = 0; i < a.pixels.size(); ++i) count += std::memcmp(&a.pixels[i], &b.pixels[i], sizeof(float)) != 0;
        return count;
    }
    void look(int width, int height) {
        if (width_ == width && height_ == height) return;
        width_ = width;
        height_ = height;
        truth_ = oracle_.picture(view_.camera, width, height);
        rays_.resize(truth_.size());
        for (size_t i = 0; i < rays_.size(); ++i)
            rays_[i] = camera_ray(view_.camera, width, height, int(i % width), int(i / width));
    }
    static void expect(const Comparison& c, const std::string& what) {
        EXPECT_GT(c.hits, c.rays / 10) << what << ": the picture shows too little to prove anything";
        EXPECT_LE(c.wrong(), (c.rays + 99999) / 100000) << what << ": " << c.text();
        EXPECT_EQ(c.other_prim, 0u) << what << ": " << c.text();
        if (std::getenv("CLARITY_TEST_VERBOSE")) std::printf("%s: %s\n", what.c_str(), c.text().c_str());
    }

    ScenePtr scene_;
    View view_;
    Oracle oracle_;
    bool hostile_ = false;
    FloatImage first_;
    std::string first_of_;
    int width_ = 0, height_ = 0;
    std::vector<Truth> truth_;
    std::vector<Ray> rays_;
};

constexpr const char* kBunnyCamera = "0.00592697,0.128857,0.145301,-0.0228011,0.100129,0.00166033,45";
constexpr const char* kDragonCamera = "-0.0718446,0.149745,0.128104,-0.0239983,0.115569,-0.00859975,45";
constexpr const char* kCornellCamera = "0,0.795,2.75,0,0.795,0,45";

TEST(Pictures, Bunny) {
    CLARITY_SHARED_OR_SKIP(file, "scenes/models/bunny.ply");
    Case(load_scene(file), kBunnyCamera).check(bench().fast_accels(), all_pairs(bench().fast_accels()));
}

TEST(Pictures, Dragon) {
    CLARITY_SHARED_OR_SKIP(file, "scenes/models/dragon_res3.ply");
    Case(load_scene(file), kDragonCamera).check(bench().fast_accels(), {});
}

TEST(Pictures, DragonOfAMillionTriangles) {
    CLARITY_SHARED_OR_SKIP(packed, "scenes/models/dragon_871k.ply.gz");
    const Scratch scratch;
    const std::string file = scratch.path("dragon.ply");
    if (std::system(("gzip -dc '" + packed + "' > '" + file + "'").c_str()) != 0)
        GTEST_SKIP() << "SKIPPED: no gzip to unpack " << packed;
    Case(load_scene(file), kDragonCamera).check(bench().fast_accels(), {});
}

TEST(Pictures, CornellBoxWithSpheres) {
    CLARITY_SHARED_OR_SKIP(file, "scenes/models/CornellBox-Sphere.obj");
    Case(load_scene(file), kCornellCamera).check(bench().fast_accels(), all_pairs(bench().accels()));
}

TEST(Pictures, InstancesFromFbx) {
    CLARITY_SHARED_OR_SKIP(file, "scenes/fbx/blender_293_instancing_7400_binary.fbx");
    Case(load_scene(file), "").check(bench().fast_accels(), each_accel_and_lanes(bench().accels()));
}

TEST(Pictures, EveryPrimitiveOfTheTextScene) {
    Case(load_scene(source_file("scenes/primitives.scene")), "")
        .check(bench().accels(), each_accel_and_lanes(bench().accels()));
}

TEST(Pictures, DegenerateGeometry) {
    Case(shared_scene(degenerate_scene()), view_of_degenerate()).hostile().check(bench().accels(), all_pairs(bench().accels()));
}

}  // namespace
