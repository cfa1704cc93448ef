#include "tools/check/hits/ray_sets.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace clarity::check {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

const Region& region(const char* name) {
    for (const Region& r : mixed_regions())
        if (std::string(r.name) == name) return r;
    return mixed_regions().front();
}

// Camera rays: neighbours are alike, so packets stay together.
void add_view(const Region& at, float away, const Point& d, int side, std::vector<rt_ray>& rays) {
    const Point up = std::fabs(d[1]) < 0.9f ? Point{0, 1, 0} : Point{1, 0, 0};
    Point u{d[1] * up[2] - d[2] * up[1], d[2] * up[0] - d[0] * up[2], d[0] * up[1] - d[1] * up[0]};
    const float length = std::sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    for (float& c : u) c /= length;
    const Point v{d[1] * u[2] - d[2] * u[1], d[2] * u[0] - d[0] * u[2], d[0] * u[1] - d[1] * u[0]};
    Point eye = at.center;
    for (int k = 0; k < 3; ++k) eye[k] -= away * at.radius * d[k];
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            Point to = at.center;
            const float a = 2 * (float(x) + 0.37f) / float(side) - 1, b = 2 * (float(y) + 0.41f) / float(side) - 1;
            for (int k = 0; k < 3; ++k) to[k] += at.radius * (a * u[k] + b * v[k]);
            rays.push_back(RayMaker::from_to(eye, to));
        }
}

}  // namespace

void add_close_rays(const BuildScene& scene, size_t count, RayMaker& make, std::vector<rt_ray>& rays) {
    // The small flat faces are triangles of 0.008; aim at each from both sides, along the axis and nearly so.
    struct Face {
        Point middle;
        int axis;
    };
    std::vector<Face> faces;
    const Point center = region("faces").center;
    for (const rt_packed_prim& p : scene.triangles) {
        Point middle;
        float size = 0, away = 0;
        for (int k = 0; k < 3; ++k) {
            middle[k] = (p.a[k] + p.b[k] + p.c[k]) / 3;
            away = std::max(away, std::fabs(middle[k] - center[k]));
            size = std::max(size, std::fabs(p.a[k] - p.b[k]));
        }
        if (away > 10 || size > 0.05f) continue;
        for (int k = 0; k < 3; ++k)
            if (p.a[k] == p.b[k] && p.a[k] == p.c[k]) faces.push_back({middle, k});
    }
    const size_t every = (faces.size() / (2 * count) + 1) | 1;  // odd: faces are pairs
    for (size_t i = 0; i < faces.size(); i += every)
        for (const float side : {-1.0f, 1.0f}) {
            const auto& [middle, k] = faces[i];
            Point from = middle;
            from[k] += 10 * side;
            rays.push_back(RayMaker::from_to(from, middle));
            from[(k + 1) % 3] += 0.3f * (make.any() - 0.5f);
            rays.push_back(RayMaker::from_to(from, middle));
        }
}

std::vector<RaySet> ray_sets(const BuildScene& scene, size_t count, uint64_t seed) {
    std::vector<RaySet> sets;
    RayMaker make(4, seed);
    const auto add = [&](const char* name, const char* tried, auto fill, bool strange = false) {
        RaySet set{name, tried, {}, strange, ""};
        if (count > 0) fill(set.rays);
        sets.push_back(std::move(set));
    };
    const auto plain = [&](std::vector<rt_ray>& rays, std::initializer_list<const char*> names, size_t n) {
        for (size_t i = 0; i < n; ++i)
            for (const char* name : names) rays.push_back(make.into(region(name), i % 4 == 0 ? 0.3f : 1.5f + 2 * make.any()));
    };
    add("hits.random", "rays in random directions, no two alike, in a soup of triangles",
        [&](std::vector<rt_ray>& rays) { plain(rays, {"random"}, count); });
    add("hits.octants", "packets of rays whose directions agree in sign, in each of the eight octants",
        [&](std::vector<rt_ray>& rays) {
            const int side = std::max(8, static_cast<int>(std::sqrt(double(count) / 8)) / 8 * 8);
            for (int octant = 0; octant < 8; ++octant)
                add_view(region("random"), 3,
                         {octant & 1 ? -0.5f : 0.5f, octant & 2 ? -0.62f : 0.62f, octant & 4 ? -0.6f : 0.6f}, side, rays);
        });
    add("hits.camera", "camera rays, whose packets hold several octants", [&](std::vector<rt_ray>& rays) {
        const int side = std::max(8, static_cast<int>(std::sqrt(double(count) / 4)) / 8 * 8);
        for (const char* name : {"random", "instanced", "boxes", "spheres"}) add_view(region(name), 2, {0, 0, -1}, side, rays);
    });
    add("hits.instances", "rays at instances that are turned, mirrored, stretched, tiny and within each other",
        [&](std::vector<rt_ray>& rays) {
            plain(rays, {"instanced", "instanced", "instanced, tiny", "instanced, far away"}, count / 4);
        });
    add("hits.primitives", "rays at spheres and polygons",
        [&](std::vector<rt_ray>& rays) { plain(rays, {"spheres", "polygons"}, count / 3); });
    add("hits.axes", "rays along one axis or within a plane of two, zeros of either sign, also within faces of boxes",
        [&](std::vector<rt_ray>& rays) {
            for (size_t i = 0; i < count; ++i) {
                const Region& at = region(i % 3 == 0 ? "boxes" : i % 3 == 1 ? "random" : "instanced");
                Point from = make.within(at), d{};
                if (i % 4 == 0)  // on the boxes' planes
                    for (int k = 0; k < 3; ++k) from[k] = at.center[k] + std::round(from[k] - at.center[k]);
                for (float& c : d) c = make.any() < 0.5f ? 0.0f : -0.0f;
                d[i % 3] = i & 8 ? 1.0f : -1.0f;
                if (i % 2) d[(i + 1) % 3] = make.any() - 0.5f;
                from[i % 3] -= 2 * at.radius * d[i % 3];
                rays.push_back({{from[0], from[1], from[2]}, 0, {d[0], d[1], d[2]}, kFar});
            }
        });
    add("hits.grazing", "rays through corners and along edges of triangles", [&](std::vector<rt_ray>& rays) {
        const rt_group& world = scene.groups[0];
        for (size_t i = 0; i < count; ++i) {
            const rt_u32 ref = scene.prims[world.first + make.below(world.count)].ref;
            if (RT_REF_KIND(ref) != RT_REF_TRIANGLE) continue;
            const rt_packed_prim& p = scene.triangles[RT_REF_INDEX(ref)];
            const float *a = p.a, *b = i % 3 ? p.b : p.c;
            const float s = i % 2 ? make.any() : 0, far = 3;
            Point to, from;
            const Point d = make.direction();
            for (int k = 0; k < 3; ++k) to[k] = a[k] + s * (b[k] - a[k]);
            for (int k = 0; k < 3; ++k) from[k] = i % 5 == 4 ? a[k] - 2 * (b[k] - a[k]) : to[k] - far * d[k];
            if (from == to) continue;
            rays.push_back(RayMaker::from_to(from, to));
        }
    });
    add("hits.close", "rays at pairs of faces whose distances differ by 4 in 10000",
        [&](std::vector<rt_ray>& rays) { add_close_rays(scene, count, make, rays); });
    add("hits.scales", "rays at tiny, huge and far-away triangles, and from up to 10^10 away", [&](std::vector<rt_ray>& rays) {
        plain(rays, {"tiny", "far away"}, count / 4);
        for (size_t i = 0; i < count / 4; ++i) {
            const Region& at = mixed_regions()[i % mixed_regions().size()];
            rays.push_back(make.into(at, std::min(std::pow(10.0f, 1 + 3 * make.any()), 3e4f / at.radius)));
        }
        // At both sides of the floor of 400000 and of the wall, from up to 10^10 away: no distance stands for infinity.
        RayMaker far(12, seed);
        for (size_t i = 0; i < count / 4; ++i) {
            const Point d = far.direction();
            const float away = std::pow(10.0f, 5.5f + (i % 2 ? 4.5f : 3.5f) * far.any()), side = i % 4 < 2 ? away : -away;
            const float a = far.any() - 0.5f, b = far.any();
            const Point to = i % 2 ? Point{2e5f * a, -300, 2e5f * (b - 0.5f)} : Point{4e4f * a, 5e4f * b, -2e4f};
            Point from{to[0] + 0.3f * away * d[0], to[1] + 0.3f * away * std::fabs(d[1]), to[2] + 0.3f * away * d[2]};
            from[i % 2 ? 1 : 2] = side;
            rays.push_back(RayMaker::from_to(from, to));
        }
    });
    add("hits.nested", "rays through the common centre of many shells, which enter every box: the stack is as full as it gets",
        [&](std::vector<rt_ray>& rays) {
            for (size_t i = 0; i < count / 2; ++i) {
                const Region& at = region(i % 2 ? "nested, instanced" : "nested");
                const Point d = make.direction();
                Point from = at.center, to = at.center;
                for (int k = 0; k < 3; ++k) from[k] -= (i % 3 == 0 ? 0.0f : 2.0f) * at.radius * d[k];
                for (int k = 0; k < 3; ++k) to[k] += i % 3 == 0 ? d[k] : 0.01f * d[(k + 1) % 3];
                rays.push_back(RayMaker::from_to(from, to));
            }
            plain(rays, {"degenerate", "copies"}, count / 8);
        });
    add("hits.limits", "rays with a least and a greatest distance, also just before and behind a surface",
        [&](std::vector<rt_ray>& rays) {
            for (size_t i = 0; i < count; ++i) {
                const Region& at = region(i % 3 == 0 ? "instanced" : i % 3 == 1 ? "spheres" : "random");
                rt_ray ray = make.into(at, 2);
                const float a = 4 * at.radius * make.any(), b = 4 * at.radius * make.any();
                if (i % 2) ray.t_min = std::min(a, b);
                ray.t_max = i % 4 == 3 ? kFar : std::max(a, b);
                rays.push_back(ray);
            }
        });
    add("hits.unit", "directions that are not unit vectors", [&](std::vector<rt_ray>& rays) {
        for (size_t i = 0; i < count / 2; ++i) {
            rt_ray ray = make.into(region(i % 2 ? "instanced" : "random"), 2);
            const float scale = std::pow(10.0f, 6 * make.any() - 3);
            for (float& d : ray.direction) d *= scale;
            rays.push_back(ray);
        }
    });
    add(
        "hits.strange", "directions and origins that are zero, NaN or infinite, beside sound rays",
        [&](std::vector<rt_ray>& rays) {
            const float tiny = 1e-40f;
            const rt_ray strange[] = {
                {{0, 0, 5}, 0, {0, 0, 0}, kFar},
                {{0, 0, 5}, 0, {kNan, 0, -1}, kFar},
                {{0, 0, 5}, 0, {kNan, kNan, kNan}, kFar},
                {{kNan, 0, 5}, 0, {0, 0, -1}, kFar},
                {{0, kNan, 5}, 0, {0, 0, -1}, kFar},
                {{0, 0, kNan}, 0, {0, 0, -1}, kFar},
                {{kFar, 0, 5}, 0, {0, 0, -1}, kFar},
                {{0, 0, 5}, 0, {kFar, 0, -1}, kFar},
                {{0, 0, 5}, 0, {0, -kFar, kFar}, kFar},
                {{0, 0, 5}, 0, {1e30f, -1e30f, 1e30f}, kFar},
                {{0, 0, 5}, 0, {tiny, -tiny, -1}, kFar},
                {{0, 0, 5}, 0, {tiny, tiny, tiny}, kFar},
                {{1e30f, 1e30f, -1e30f}, 0, {-1, -1, 1}, kFar},
                {{0, 0, 5}, kNan, {0, 0, -1}, kFar},
                {{0, 0, 5}, 0, {0, 0, -1}, kNan},
                {{0, 0, 5}, 10, {0, 0, -1}, 1},
                {{0, 0, 5}, 0, {0, 0, -1}, -1},
            };
            // Sound rays: sixteen in random directions, then sixteen in one, and so on. That one has the signs of most strange
            // rays, so that a structure may bound them together.
            for (size_t i = 0; i < count; ++i) {
                if (i % 5 == 2) {
                    rays.push_back(strange[i / 5 % (sizeof strange / sizeof *strange)]);
                    continue;
                }
                const Region& at = region(i % 2 ? "instanced" : "random");
                rays.push_back(i / 16 % 2 ? make.along({0.1f, 0.2f, -1}, at, 2) : make.into(at, 2));
            }
        },
        true);
    return sets;
}

}  // namespace clarity::check
