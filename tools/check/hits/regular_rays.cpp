// regular_rays.cpp -- rays at edges, corners and planes of tessellations (regular_scenes.hpp).
#include <algorithm>
#include <cmath>
#include <cstring>

#include "scene/vec.hpp"
#include "tools/check/hits/ray_sets.hpp"
#include "tools/check/regular_scenes.hpp"

namespace clarity::check {
namespace {

constexpr const char* kSlack =
    "the edges and corners lie on planes of cells and splits: a ray that rounding moves across such a plane must still be "
    "tested "
    "against the primitives on both sides, so cells and planes need slack (cl/CONTRACT.md)";
constexpr const char* kPlanes =
    "the rays lie in planes of cells, splits or boxes, with components of the direction that are 0 or -0";
constexpr const char* kNear =
    "what is in front was culled though it begins before the nearest hit, or a node that begins before t_max was left out";

// What rays are aimed at.
struct Aim {
    const BuildScene& scene;
    rt_group group;
    float size;  // of a square

    const rt_packed_prim& triangle(RayMaker& make) const {
        rt_u32 ref = 0;
        do ref = scene.prims[group.first + make.below(group.count)].ref;
        while (RT_REF_KIND(ref) != RT_REF_TRIANGLE);
        return scene.triangles[RT_REF_INDEX(ref)];
    }
    // A corner, or a point of an edge; exact, some ulps beside it, or by 1e-7 to 1e-3 of a square.
    Point edge(RayMaker& make, int i) const {
        const rt_packed_prim& t = triangle(make);
        const float* const corners[3] = {t.a, t.b, t.c};
        const size_t c = make.below(3);
        const float *a = corners[c], *b = corners[(c + 1) % 3], s = i % 4 == 0 ? 0 : make.any();
        Point p;
        for (int k = 0; k < 3; ++k) {
            p[k] = a[k] == b[k] ? a[k] : a[k] + s * (b[k] - a[k]);
            if (i % 3 == 1)
                for (size_t n = make.below(4), up = make.below(2); n > 0; --n) p[k] = std::nextafter(p[k], up ? kFar : -kFar);
            if (i % 3 == 2) p[k] += (make.any() < 0.5f ? -size : size) * std::pow(10.0f, -7 + 4 * make.any());
        }
        return p;
    }
    // The middle of a triangle.
    Point middle(RayMaker& make) const {
        const rt_packed_prim& t = triangle(make);
        return {(t.a[0] + t.b[0] + t.c[0]) / 3, (t.a[1] + t.b[1] + t.c[1]) / 3, (t.a[2] + t.b[2] + t.c[2]) / 3};
    }
};

// In any direction; close to an axis; or with zeros of either sign.
Point direction(RayMaker& make, int i) {
    Point d = make.direction();
    const int k = static_cast<int>(make.below(3));
    if (i % 4 == 1)
        for (int j = 1; j < 3; ++j) d[(k + j) % 3] *= std::pow(10.0f, -6 + 5 * make.any());
    if (i % 4 == 2) d[k] = make.any() < 0.5f ? 0.0f : -0.0f;
    if (i % 16 == 2) d[(k + 1) % 3] = make.any() < 0.5f ? 0.0f : -0.0f;
    const float length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    for (float& c : d) c /= length;
    return d;
}

rt_ray from(const Point& to, const Point& d, float distance) {
    rt_ray ray{{}, 0, {d[0], d[1], d[2]}, kFar};
    for (int k = 0; k < 3; ++k) ray.origin[k] = d[k] == 0 ? to[k] : static_cast<float>(to[k] - double(distance) * d[k]);
    return ray;
}

using Rays = std::vector<rt_ray>;

void add_edges(const Aim& aim, RayMaker& make, size_t count, float least, float most, Rays& rays) {
    for (size_t n = 0; n < count; ++n) {
        const int i = static_cast<int>(n);
        rays.push_back(from(aim.edge(make, i), direction(make, i / 2), least * std::pow(most / least, make.any())));
    }
}

void add_planes(const Aim& aim, RayMaker& make, size_t count, Rays& rays) {
    for (size_t n = 0; n < count; ++n) {
        const int i = static_cast<int>(n);
        rays.push_back(from(aim.edge(make, 3 * i), direction(make, 2 + 4 * i), aim.size * std::pow(10.0f, 3 * make.any())));
    }
}

// Starts on edges and corners, or in the middle of cells; every other one with a t_min.
void add_inside(const Aim& aim, RayMaker& make, size_t count, Rays& rays) {
    for (size_t n = 0; n < count; ++n) {
        const int i = static_cast<int>(n);
        Point start = aim.edge(make, i);
        if (i % 4 == 3)
            for (float& c : start) c += aim.size * (make.any() - 0.5f);
        rt_ray ray = from(start, direction(make, i / 2), 0);
        if (i % 2) ray.t_min = aim.size * std::pow(10.0f, -4 + 4 * make.any());
        rays.push_back(ray);
    }
}

void add_middles(const Aim& aim, RayMaker& make, size_t count, float distance, Rays& rays) {
    for (size_t n = 0; n < count; ++n) rays.push_back(from(aim.middle(make), direction(make, static_cast<int>(n)), distance));
}

// Along the axis on which a decal is flat, or nearly.
void add_decals(const Aim& aim, RayMaker& make, size_t count, Rays& rays) {
    for (size_t n = 0; n < count; ++n) {
        const rt_packed_prim& t = aim.triangle(make);
        Point to, size;
        for (int k = 0; k < 3; ++k) {
            to[k] = (t.a[k] + t.b[k] + t.c[k]) / 3;
            size[k] = std::max({t.a[k], t.b[k], t.c[k]}) - std::min({t.a[k], t.b[k], t.c[k]});
        }
        if (size[0] + size[1] + size[2] > 1) continue;  // a large face
        const int k = static_cast<int>(std::min_element(size.begin(), size.end()) - size.begin());
        Point d{};
        d[k] = n % 2 ? 1.0f : -1.0f;
        if (n % 3) d[(k + 1) % 3] = 0.02f * (make.any() - 0.5f), d[(k + 2) % 3] = 0.02f * (make.any() - 0.5f);
        const float length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        for (float& c : d) c /= length;
        rays.push_back(from(to, d, 10));
    }
}

Aim aim_at(const BuildScene& scene, size_t patch) {
    // Without rays there is no scene.
    if (scene.groups.empty()) return {scene, {0, 0}, 1};
    return {scene, scene.groups[scene.group_of_mesh[patch]], patches()[patch].size};
}

}  // namespace

std::vector<RaySet> regular_ray_sets(const BuildScene& scene, size_t count, uint64_t seed) {
    std::vector<RaySet> sets;
    RayMaker make(5, seed);
    const auto add = [&](const char* name, const char* tried, const char* hint, std::initializer_list<const char*> names,
                         auto fill) {
        RaySet set{name, tried, {}, false, hint};
        if (count > 0)
            for (size_t p = 0; p < patches().size(); ++p)
                for (const char* wanted : names)
                    if (std::strcmp(patches()[p].name, wanted) == 0) fill(aim_at(scene, p), count / names.size(), set.rays);
        sets.push_back(std::move(set));
    };
    add("hits.edges", "rays at edges and corners of floors and lattices, some ulps beside them, from near", kSlack,
        {"floor", "wall", "cubes", "blocks", "tiny floor"},
        [&](const Aim& aim, size_t n, Rays& rays) { add_edges(aim, make, 3 * n, 2 * aim.size, 100 * aim.size, rays); });
    add("hits.distant", "rays at edges and corners of floors and lattices from up to 100000 away", kSlack,
        {"floor", "wall", "cubes", "blocks"},
        [&](const Aim& aim, size_t n, Rays& rays) { add_edges(aim, make, 2 * n, 10, 1e5f, rays); });
    add("hits.splits", "rays within planes of cells and splits, zeros of either sign", kPlanes,
        {"floor", "wall", "cubes", "blocks", "copies"},
        [&](const Aim& aim, size_t n, Rays& rays) { add_planes(aim, make, n, rays); });
    add("hits.inside", "rays that start within lattices and trees, on planes and corners, also with t_min", kSlack,
        {"floor", "cubes", "blocks", "needles", "deep", "stadium"},
        [&](const Aim& aim, size_t n, Rays& rays) { add_inside(aim, make, n, rays); });
    add("hits.decals", "rays at small faces just in front of large slanted ones, nearer by 5e-5 to 1e-3", kNear, {"decals"},
        [&](const Aim& aim, size_t n, Rays& rays) { add_decals(aim, make, n, rays); });
    add("hits.uneven", "rays at needles across many cells, deep trees, copies, and something tiny in something large", "",
        {"needles", "deep", "stadium", "copies"}, [&](const Aim& aim, size_t n, Rays& rays) {
            add_middles(aim, make, n / 2, 20 * aim.size, rays);
            add_middles(aim, make, n / 2, 300, rays);
        });
    return sets;
}

std::vector<RaySet> floor_ray_sets(const BuildScene& scene, size_t count, uint64_t seed) {
    std::vector<RaySet> sets;
    RayMaker make(6, seed);
    RaySet set{"hits.floor",
               "rays at edges, corners and planes of one flat floor, from near and from up to 100000 away",
               {},
               false,
               kSlack};
    if (count > 0) {
        const Aim aim{scene, scene.groups[0], patches()[0].size};
        add_edges(aim, make, 2 * count, 1, 100, set.rays);
        add_edges(aim, make, count, 10, 1e5f, set.rays);
        add_planes(aim, make, count / 2, set.rays);
        add_inside(aim, make, count / 2, set.rays);
    }
    sets.push_back(std::move(set));
    return sets;
}

std::vector<RaySet> each_ray_sets(const BuildScene& scene, size_t count, uint64_t) {
    RaySet set{"hits.each",
               "a short ray at each triangle of trees of 1 to 20, and of 300, also if their boxes have one centre",
               {},
               false,
               "a leaf's last primitive, a small tree or a kind of leaf is left out"};
    for (size_t i = 0; count > 0 && i <= scene.instances.size(); ++i) {  // the last one stands for the world
        const bool world = i == scene.instances.size();
        if (!world && scene.instances[i].hidden != 0) continue;
        const rt_group& group = scene.groups[world ? 0 : scene.group_of_instance[i]];
        const Affine m = world ? kIdentity : scene.world_from_object[i];
        for (rt_u32 p = group.first; p < group.first + group.count; ++p) {
            const rt_u32 ref = scene.prims[p].ref;
            if (RT_REF_KIND(ref) != RT_REF_TRIANGLE) continue;
            const rt_packed_prim& t = scene.triangles[RT_REF_INDEX(ref)];
            const auto a = transform_point(m, t.a), b = transform_point(m, t.b), c = transform_point(m, t.c);
            const Vec at = {a[0], a[1], a[2]}, ab = Vec{b[0], b[1], b[2]} - at, ac = Vec{c[0], c[1], c[2]} - at;
            const Vec n = (p % 2 ? 1 : -1) * normalized(cross(ab, ac)), from = at + (1.0 / 3) * (ab + ac) - 0.01 * n;
            rt_ray ray{{}, 0, {}, 0.02f};
            for (size_t k = 0; k < 3; ++k)
                ray.origin[k] = static_cast<float>(from[k]), ray.direction[k] = static_cast<float>(n[k]);
            set.rays.push_back(ray);
        }
    }
    return {set};
}

std::vector<RaySet> crowd_ray_sets(const BuildScene&, size_t count, uint64_t seed) {
    RayMaker make(11, seed);
    RaySet set{"hits.crowd",
               "rays that enter the boxes of all primitives, of tens of thousands if the structure names each once",
               {},
               false,
               "a ray gave up after a number of steps, or what the stack had no room for was left out"};
    for (size_t i = 0; i < std::min<size_t>(count, 32); ++i) {
        const Point d = make.direction();
        const float along = (d[0] + d[1] + d[2]) / 3;
        const Point from = make.within({"", {0, 0, 0}, 0.1f});
        set.rays.push_back(RayMaker::from_to(from, {from[0] + d[0] - along, from[1] + d[1] - along, from[2] + d[2] - along}));
    }
    return {set};
}

std::vector<RaySet> row_ray_sets(const BuildScene& scene, size_t, uint64_t) {
    RaySet set{"hits.row",
               "rays that enter every box of a row of triangles, each four times as large as the one before",
               {},
               false,
               "what was put on the stack has not come back from it"};
    const auto pairs = static_cast<unsigned>(scene.triangles.size() / 2);
    for (unsigned i = 0; i < pairs; ++i) {
        const float y = row_place(i, pairs);
        set.rays.push_back(RayMaker::from_to({0, 0, 0}, {1, y, 0.32f - y}));
    }
    for (int i = 0; i < 8; ++i) set.rays.push_back(RayMaker::from_to({0, 0, 0}, {1, 0.002f * float(i), 0.01f}));
    return {set};
}

}  // namespace clarity::check
