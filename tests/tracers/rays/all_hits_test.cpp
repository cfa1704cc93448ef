// all_hits_test.cpp -- all hits of rays in their order: against every primitive tested by itself in double precision, the same
// for all structures and lane counts, none lost where a ray has more hits than a launch lists, none counted twice where a
// structure names a primitive in several places.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "reference/primitives.hpp"
#include "stand/ray_sets.hpp"
#include "support/generated.hpp"
#include "support/planted_faults.hpp"
#include "support/scenes.hpp"
#include "tracers/rays/ray_kernels.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

constexpr size_t kAtOnce = kHitsAtOnce;

// In quick tests, too, one that traces single rays and names a primitive in several places.
std::vector<std::string> structures() {
    std::vector<std::string> ids = few_ways() ? Workbench::get().fast_accels() : Workbench::get().accels();
    if (std::find(ids.begin(), ids.end(), "kdtree") == ids.end()) ids.push_back("kdtree");
    return ids;
}

std::vector<int> lanes_of(const std::string& accel) {
    return few_ways() ? std::vector<int>{accel == "kdtree" ? 1 : 16} : std::vector<int>{1, 16};
}

AllHits hits_of(const ScenePtr& scene, const std::vector<rt_ray>& rays, const std::string& accel, int lanes,
                bool count_only = false) {
    Settings settings;
    settings.accel = accel;
    settings.lanes = lanes;
    Progress progress;
    return Workbench::get().queries().trace_all(*Workbench::get().prepare(scene, settings), rays, {count_only, false},
                                                progress);
}

// Rays with origins in and around the box of half `size`, from all directions; every third has a limited interval.
std::vector<rt_ray> random_rays(size_t count, float size, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> at(-1.5f * size, 1.5f * size);
    std::normal_distribution<float> normal;
    std::vector<rt_ray> rays;
    for (size_t i = 0; i < count; ++i) {
        Point direction{normal(random), normal(random), normal(random)};
        const float length = std::sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
        for (float& d : direction) d /= length;
        rays.push_back(ray_of({at(random), at(random), at(random)}, direction));
        if (i % 3 == 1) rays.back().t_min = 0.2f * size;
        if (i % 3 == 2) rays.back().t_max = 1.1f * size;
    }
    return rays;
}

// Triangles of all sizes in a cube, many across all of it: structures that cut space name them in many places.
TriangleMesh soup(unsigned count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> at(-1, 1);
    TriangleMesh mesh;
    for (unsigned i = 0; i < count; ++i) {
        const double size = i % 2 ? 1.0 : 0.2, x = at(random), y = at(random), z = at(random);
        rt_u32 corners[3];
        for (rt_u32& corner : corners)
            corner = mesh.add_vertex(x + size * at(random), y + size * at(random), z + size * at(random));
        mesh.add_triangle(corners[0], corners[1], corners[2]);
    }
    return mesh;
}

// Squares of two triangles across the z axis, at z = 0, -1, -2, ...; `copies` of each at one place.
TriangleMesh plates(unsigned count, unsigned copies) {
    TriangleMesh mesh;
    for (unsigned i = 0; i < count * copies; ++i) {
        const double z = -double(i / copies);
        mesh.add_quad(Vec{-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z});
    }
    return mesh;
}

// Placed twice, with spheres, a polygon and a plane.
ScenePtr mixed() {
    Scene scene = scene_of(soup(40, 3));
    Instance second = scene.instances[0];
    second.world_from_object = {0.6f, 0, -0.8f, 0.5f, 0, 1, 0, 0.2f, 0.8f, 0, 0.6f, -0.4f};
    scene.instances.push_back(second);
    for (int i = 0; i < 6; ++i) scene.spheres.push_back({{0.2f * float(i) - 0.5f, 0.1f, 0.3f}, 0.3f + 0.1f * float(i), 0});
    scene.planes.push_back({{0, 1, 0}, -0.75f, 0});
    return shared_scene(scene);
}

// Ordered, in the interval, no primitive twice at one t; then, by every primitive for itself: what is clearly hit is listed,
// and what is listed can be a hit.
void expect_as_reference(const ScenePtr& scene, const std::vector<rt_ray>& rays, const AllHits& all) {
    const Primitives primitives(*scene);
    const int triangles = primitives.triangle_count(), spheres = static_cast<int>(scene->spheres.size()),
              others = static_cast<int>(scene->planes.size());
    size_t listed = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        const rt_hit *const begin = all.hits.data() + all.first[i], *const end = all.hits.data() + all.first[i + 1];
        const Ray ray = widened(rays[i]);
        std::map<int, unsigned> times;
        for (const rt_hit* hit = begin; hit != end; ++hit, ++listed) {
            ++times[hit->prim];
            ASSERT_TRUE(hit->t >= rays[i].t_min && hit->t < rays[i].t_max) << "ray " << i;
            if (hit > begin) {
                ASSERT_TRUE(hit[-1].t < hit->t || (hit[-1].t == hit->t && hit[-1].prim < hit->prim)) << "ray " << i;
            }
        }
        for (int prim = 0; prim < triangles + spheres + others; ++prim) {
            const auto found = times.find(prim);
            const unsigned count = found == times.end() ? 0 : found->second;
            if (prim >= triangles && prim < triangles + spheres) {
                // Both sides of a sphere, as far as they are in the interval, but for rays near its silhouette.
                const auto& sphere = scene->spheres[size_t(prim - triangles)];
                const Vec center = to_vec(sphere.center);
                const Vec from = ray.origin - center;
                const double b = dot(from, ray.direction), a = dot(ray.direction, ray.direction);
                const double least = std::sqrt(std::max(0.0, dot(from, from) - b * b / a));
                if (std::fabs(least - sphere.radius) < 1e-3 * sphere.radius) continue;
                unsigned expected = 0;
                bool sure = true;
                if (least < sphere.radius)
                    for (const double side : {-1.0, 1.0}) {
                        const double t =
                            (-b + side * std::sqrt(b * b - a * (dot(from, from) - double(sphere.radius) * sphere.radius))) / a;
                        sure &= std::fabs(t - ray.t_min) > 1e-4 && std::fabs(t - ray.t_max) > 1e-4;
                        expected += t > 0 && t >= ray.t_min && t < ray.t_max;
                    }
                if (sure) {
                    ASSERT_EQ(count, expected) << "ray " << i << ", sphere " << prim - triangles;
                }
                continue;
            }
            ASSERT_LE(count, 1u) << "ray " << i << ", primitive " << prim;
            Ray less = ray, more = ray;
            less.t_min += 1e-4, less.t_max -= 1e-4, more.t_min -= 1e-4, more.t_max += 1e-4;
            if (std::isfinite(primitives.distance(prim, less, -1e-4))) {
                ASSERT_EQ(count, 1u) << "ray " << i << " loses primitive " << prim;
            }
            if (count) {
                ASSERT_TRUE(std::isfinite(primitives.distance(prim, more, 1e-4))) << "ray " << i << ", primitive " << prim;
            }
        }
    }
    EXPECT_GT(listed, rays.size());
}

void expect_same(const AllHits& test, const AllHits& expected, const std::string& what) {
    ASSERT_EQ(test.first, expected.first) << what;
    ASSERT_EQ(test.hits.size(), expected.hits.size()) << what;
    for (size_t i = 0; i < test.hits.size(); ++i) {
        const rt_hit &a = test.hits[i], &b = expected.hits[i];
        ASSERT_TRUE(a.t == b.t && a.prim == b.prim && a.instance == b.instance && a.u == b.u && a.v == b.v)
            << what << ", hit " << i << ": t " << a.t << ", prim " << a.prim << "; expected t " << b.t << ", prim " << b.prim;
    }
}

void expect_everywhere(const ScenePtr& scene, const std::vector<rt_ray>& rays, bool has_reference = true) {
    const AllHits expected = hits_of(scene, rays, "linear", 1);
    ASSERT_EQ(expected.first.size(), rays.size() + 1);
    if (has_reference) {
        ASSERT_NO_FATAL_FAILURE(expect_as_reference(scene, rays, expected));
    }
    for (const std::string& accel : structures())
        for (const int lanes : lanes_of(accel)) {
            const std::string what = accel + ", " + std::to_string(lanes) + " lanes";
            ASSERT_NO_FATAL_FAILURE(expect_same(hits_of(scene, rays, accel, lanes), expected, what));
            // Counting is a kernel of its own, and the same for all kinds of primitives: shapes are counted by one structure.
            if (!has_reference && accel != structures().front()) continue;
            const AllHits counted = hits_of(scene, rays, accel, lanes, true);
            EXPECT_TRUE(counted.hits.empty());
            EXPECT_EQ(counted.first, expected.first) << what;
        }
}

TEST(AllHits, OfASoup) {
    expect_everywhere(shared_scene(scene_of(soup(300, 1))), random_rays(600, 1, 2));
}

TEST(AllHits, OfInstancesSpheresAndPlanes) {
    expect_everywhere(mixed(), random_rays(400, 1, 4));
}

TEST(AllHits, OfShapes) {
    const ScenePtr scene = geometry_of(load_scene(source_file("scenes/shapes.scene")));
    // From outside towards where the shapes stand.
    std::vector<rt_ray> rays = random_rays(400, 4, 5);
    std::mt19937 random(6);
    std::uniform_real_distribution<float> x(-4, 4), y(0, 1.4f), z(-1.2f, 2.2f);
    for (rt_ray& ray : rays) {
        for (float& d : ray.direction) d = -d;
        for (int k = 0; k < 3; ++k)
            ray.origin[k] = (k == 0 ? x(random) : k == 1 ? y(random) : z(random)) - 12 * ray.direction[k];
        ray.t_min = 0, ray.t_max = INFINITY;
    }
    expect_everywhere(scene, rays, false);
    // A ray that comes from outside leaves a closed shape as often as it enters it, unless it grazes it or passes an edge.
    const AllHits all = hits_of(scene, rays, "linear", 1);
    const size_t first_shape = scene->triangle_count() + scene->spheres.size() + scene->polygons.size() + scene->planes.size();
    size_t pairs = 0, odd = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        for (size_t s = 0; s < scene->shapes.size(); ++s) {
            const std::string& kind = scene->shape_kinds[scene->shapes[s].kind].id;
            if (kind != "box" && kind != "torus" && kind != "cone") continue;
            const auto of_shape = [&](const rt_hit& hit) { return size_t(hit.prim) == first_shape + s; };
            const auto count =
                std::count_if(all.hits.begin() + long(all.first[i]), all.hits.begin() + long(all.first[i + 1]), of_shape);
            if (count == 0) continue;
            ASSERT_LE(count, kind == "torus" ? 4 : 2) << "ray " << i << ", shape " << s;
            pairs += static_cast<size_t>(count / 2);
            odd += count % 2;
        }
    }
    EXPECT_GT(pairs, 100u);
    EXPECT_LE(odd, pairs / 50);
}

// Through the common edge of the two triangles of a plate, both count. With 16 plates that is four launches of eight exactly,
// and one that finds nothing more.
TEST(AllHits, AtEdgesAndWhereAListIsFull) {
    for (const unsigned count : {4u, 16u, 21u}) {
        const ScenePtr scene = shared_scene(scene_of(plates(count, 1)));
        const std::vector<rt_ray> rays = {ray_of({0.5f, 0.5f, 1}, {0, 0, -1}), ray_of({0.5f, 0.25f, 1}, {0, 0, -1}),
                                          ray_of({0.5f, 0.25f, 1}, {0, 0, -1}, 2), ray_of({0.5f, 0.25f, 1}, {0, 0, -1}, 0, 2),
                                          ray_of({2, 0, 1}, {0, 0, -1})};
        for (const std::string& accel : structures())
            for (const int lanes : lanes_of(accel)) {
                const AllHits all = hits_of(scene, rays, accel, lanes);
                const std::string what = accel + ", " + std::to_string(lanes) + " lanes, " + std::to_string(count) + " plates";
                EXPECT_EQ(all.count(0), 2 * count) << what;
                EXPECT_EQ(all.count(1), count) << what;
                EXPECT_EQ(all.count(2), count - 1) << what << ": t_min is in the interval";
                EXPECT_EQ(all.count(3), 1u) << what << ": t_max is not in the interval";
                EXPECT_EQ(all.count(4), 0u) << what;
                for (uint64_t i = 0; i < all.count(1); ++i) EXPECT_EQ(all.hits[all.first[1] + i].t, float(i + 1)) << what;
            }
    }
}

// Hits at one t are told apart by their numbers, also where the list ends among them.
TEST(AllHits, OfDuplicates) {
    constexpr unsigned kCopies = 21;
    static_assert(2 * kAtOnce < kCopies && kCopies < 3 * kAtOnce, "the list ends twice among the copies");
    const ScenePtr scene = shared_scene(scene_of(plates(2, kCopies)));
    std::vector<rt_ray> rays(40, ray_of({0.5f, 0.25f, 1}, {0, 0, -1}));
    for (size_t i = 0; i < rays.size(); i += 3) rays[i].t_max = -1;
    for (const std::string& accel : structures())
        for (const int lanes : lanes_of(accel)) {
            const AllHits all = hits_of(scene, rays, accel, lanes);
            for (size_t i = 0; i < rays.size(); ++i) {
                ASSERT_EQ(all.count(i), i % 3 ? 2 * kCopies : 0) << accel << ", " << lanes << " lanes, ray " << i;
                for (uint64_t k = 0; k < all.count(i); ++k) {
                    const rt_hit& hit = all.hits[all.first[i] + k];
                    ASSERT_EQ(hit.prim, rt_i32(2 * k)) << accel << ", " << lanes << " lanes";
                    ASSERT_EQ(hit.t, k < kCopies ? 1.0f : 2.0f) << accel << ", " << lanes << " lanes";
                }
            }
        }
}

TEST(AllHits, OfNoRay) {
    const AllHits none = hits_of(mixed(), {}, "linear", 16);
    EXPECT_EQ(none.first, std::vector<uint64_t>{0});
    EXPECT_TRUE(none.hits.empty());
}

const char* const kList = "lanes/hit_list.h";
const PlantedFault kAllHitsFaults[] = {
    {"what is listed is not sought", kList, "lanes &= ~(RT_MASK(list->t[i] == t) & RT_MASK(list->prim[i] == number));", ";",
     "AllHits.OfASoup"},
    {"the last place is never filled", kList, "rt_precedes(t, number, list->t[RT_ALL_HITS - 1u], list->prim[RT_ALL_HITS - 1u])",
     "rt_precedes(t, number, list->t[RT_ALL_HITS - 2u], list->prim[RT_ALL_HITS - 2u])", "AllHits.OfASoup"},
    {"the rest at one t is lost where a list ends", kList, "rt_precedes(list->after_t, list->after_prim, t, number)",
     "RT_MASK(list->after_t < t)", "AllHits.OfDuplicates"},
    {"lists end at the nearest hit", "primitives/record.h", "h->t = rt_select(closer, h->list->t[RT_ALL_HITS - 1u], h->t);",
     "h->t = rt_select(closer, t, h->t);", "AllHits.OfASoup"},
    {"so do those of single rays", "primitives/triangle_single_ray.h",
     "RT_AT(h->t, l) = rt_list_add_one(h->list, l, t, v * scale, w * scale, leaf->prim);",
     "rt_list_add_one(h->list, l, t, v * scale, w * scale, leaf->prim); RT_AT(h->t, l) = t;", "AllHits.OfASoup"},
    {"numbers within a mesh", "primitives/leaf_scene.h", "h->list->first_prim = visit->first;", "", "AllHits.OfInstances*"},
    {"hits stay in the instance", "primitives/leaf_scene.h", "h->list->inside = -1;", "", "AllHits.OfInstances*"},
    {"one side of a sphere", "primitives/sphere.h", "if (rt_any(enters)) RT_FN(rt_record)(", "if (0) RT_FN(rt_record)(",
     "AllHits.OfInstances*"},
    {"one side of a shape", "primitives/leaf_shape.h", "asking &= RT_MASK(next > found);", "asking &= ~asking;",
     "AllHits.OfShapes"},
};

TEST(AllHitsTexts, HaveTheirTexts) {
    expect_plantable(kAllHitsFaults);
}

TEST(AllHitsFaults, AreFound) {
    expect_found(kAllHitsFaults);
}

}  // namespace
