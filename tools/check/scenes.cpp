#include "tools/check/scenes.hpp"

#include <algorithm>
#include <cmath>

namespace clarity::check {
namespace {

constexpr Point kSoup{0, 0, 0}, kBoxes{40, 0, 0}, kFaces{0, 40, 0}, kDegenerate{-40, 0, 0}, kTiny{0, 0, 40},
    kFarAway{9000, 2000, -7000}, kShells{0, -40, 0}, kCopies{0, 0, -40}, kInstances{40, 40, 0}, kInstancesTiny{40, 0, 40},
    kInstancesFar{-3000, 500, 4000}, kSpheres{-40, 40, 0}, kPolygons{-40, 0, 40}, kShellsInstanced{-40, -40, 0};

// Flat faces in front of slanted ones, nearer by a share of 4e-4 of the distance: a traversal that culls a little too much
// loses them. The slanted faces' boxes begin well before.
void add_faces(SceneMaker& make) {
    for (int axis = 0; axis < 3; ++axis) {
        const auto turned = [&](float a, float b, float c) {
            Point p = kFaces;
            p[axis] += a;
            p[(axis + 1) % 3] += b;
            p[(axis + 2) % 3] += c;
            return p;
        };
        // A pair of slanted faces, a = b / 2, 6 from the centre on either side.
        for (const float side : {-6.0f, 6.0f}) {
            make.add_quad(turned(side - 1, -2, -2), turned(side + 1, 2, -2), turned(side + 1, 2, 2), turned(side - 1, -2, 2));
            for (int i = 0; i < 60; ++i) {
                const float b = 3.6f * make.random() - 1.8f, c = 3.6f * make.random() - 1.8f, s = 0.004f;
                for (const float off : {-0.004f, 0.004f}) {
                    const float a = side + b / 2 + off;
                    make.add_triangle(turned(a, b - s, c - s), turned(a, b + s, c - s), turned(a, b, c + s));
                }
            }
        }
    }
}

void add_degenerate(SceneMaker& make) {
    const Point& o = kDegenerate;
    const auto at = [&](float x, float y, float z) { return Point{o[0] + x, o[1] + y, o[2] + z}; };
    for (int i = 0; i < 24; ++i) {
        const float x = -3 + 0.25f * float(i);
        make.add_triangle(at(x, 1, 0), at(x, 1, 0), at(x, 1, 0));                   // a point
        make.add_triangle(at(x, -1, 0), at(x, 0, 0), at(x, 1, 0));                  // a line
        make.add_triangle(at(x, -2, 1), at(x + 1e-4f, -2, 1), at(x, 3, 1));         // a needle
        make.add_triangle(at(x, 0, -1), at(x + 0.2f, 0, -1), at(x, 0.2f, -1));      // sound, among them
        make.add_triangle(at(x, -3, 2), at(x + 0.2f, -3, 2), at(x + 0.1f, -3, 2));  // no area
    }
}

}  // namespace

const std::vector<Region>& mixed_regions() {
    static const std::vector<Region> regions = {
        {"random", kSoup, 5},
        {"boxes", kBoxes, 4},
        {"faces", kFaces, 3},
        {"degenerate", kDegenerate, 4},
        {"tiny", kTiny, 0.02f},
        {"far away", kFarAway, 12},
        {"nested", kShells, 8},
        {"nested, instanced", kShellsInstanced, 8},
        {"copies", kCopies, 2},
        {"instanced", kInstances, 8},
        {"instanced, tiny", kInstancesTiny, 0.05f},
        {"instanced, far away", kInstancesFar, 60},
        {"spheres", kSpheres, 4},
        {"polygons", kPolygons, 4},
    };
    return regions;
}

Scene mixed_scene(uint64_t seed) {
    SceneMaker make(seed);
    make.add_soup(kSoup, 4, 0.9f, 700);
    make.place_mesh();
    for (int i = 0; i < 27; ++i) {
        const int x = i % 3, y = i / 3 % 3, z = i / 9;
        const Point lo{kBoxes[0] - 3 + 2 * float(x), kBoxes[1] - 3 + 2 * float(y), kBoxes[2] - 3 + 2 * float(z)};
        make.add_box(to_vec(lo), {lo[0] + 2 - 1.5f * float(i % 2), lo[1] + 2, lo[2] + 2});
    }
    add_faces(make);
    make.place_mesh();
    add_degenerate(make);
    make.add_soup(kTiny, 0.015f, 0.004f, 150);
    make.add_soup(kFarAway, 9, 4, 150);
    for (int i = 0; i < 20; ++i)
        make.add_triangle({kCopies[0] - 1, kCopies[1] - 1, kCopies[2]}, {kCopies[0] + 1, kCopies[1] - 1, kCopies[2]},
                          {kCopies[0], kCopies[1] + 1, kCopies[2]});
    make.add_soup(kCopies, 1.5f, 0.5f, 40);
    // Huge: a floor far below and a wall far behind.
    make.add_quad(Point{-2e5f, -300, -2e5f}, {2e5f, -300, -2e5f}, {2e5f, -300, 2e5f}, {-2e5f, -300, 2e5f});
    make.add_triangle({-1e5f, -1e5f, -2e4f}, {1e5f, -1e5f, -2e4f}, {0, 1e5f, -2e4f});
    for (int i = 0; i < 30; ++i) {  // shells around one centre: a ray through it enters all boxes
        const float r = 0.02f * std::pow(1.22f, float(i));
        make.add_box({kShells[0] - r, kShells[1] - r, kShells[2] - r}, {kShells[0] + r, kShells[1] + r, kShells[2] + r});
    }
    make.place_mesh();

    make.add_ball({0, 0, 0}, 1, 10, 6);
    make.add_soup({0.4f, 0.2f, 0}, 1.2f, 0.5f, 40);
    const rt_u32 ball = make.end_mesh();
    make.add_soup({500, -200, 100}, 1, 0.7f, 80);  // far from its own origin: matrices must bring it back
    const rt_u32 cloud = make.end_mesh();
    make.add_triangle({-1, -1, 0}, {1, -1, 0}, {0, 1, 0});
    const rt_u32 single = make.end_mesh();
    const Point& i = kInstances;
    make.place(ball, placed(i, 0.4f, {1.5f, 1.5f, 1.5f}));
    make.place(ball, placed({i[0] + 4, i[1], i[2]}, 1.9f, {1, 2, 0.5f}));
    make.place(ball, placed({i[0] - 4, i[1] + 1, i[2]}, 2.6f, {-1, 1, 1}));          // mirrored
    make.place(ball, placed({i[0] - 4, i[1] + 1, i[2]}, 1.1f, {0.4f, 0.4f, 0.4f}));  // within the one before
    make.place(ball, placed(kInstancesTiny, 0.7f, {0.02f, 0.03f, 0.02f}));
    make.place(ball, placed({kInstancesTiny[0] + 0.03f, kInstancesTiny[1], kInstancesTiny[2]}, 3, {0.01f, 0.01f, -0.01f}));
    make.place(ball, placed(kInstancesFar, 5, {40, 30, 20}));
    for (int k = 0; k < 4; ++k) {
        Affine m = placed({0, 0, 0}, 0.9f * float(k), {1, 1, 1});
        const float center[3] = {500, -200, 100};
        for (int r = 0; r < 3; ++r) {
            float moved = 0;
            for (int j = 0; j < 3; ++j) moved += m[4 * r + j] * center[j];
            m[4 * r + 3] = i[r] + (r == 1 ? -4.0f : r == 2 ? 2 * float(k) - 3 : 0.0f) - moved;
        }
        make.place(cloud, m);
    }
    for (int k = 0; k < 12; ++k)
        make.place(single, placed({i[0] - 5 + float(k), i[1] + 5, i[2]}, 0.5f * float(k), {0.7f, 0.7f, 1}));

    place_shells(make, placed(kShellsInstanced, 0, {1, 1, 1}));

    for (int k = 0; k < 12; ++k) make.add_sphere(make.around(kSpheres, 3), 0.05f + make.random());
    make.add_sphere(kSpheres, 3.5f);  // around most of them
    make.add_sphere({kSpheres[0], kSpheres[1], kSpheres[2] + 3.8f}, 1e-3f);
    for (int k = 0; k < 6; ++k) {
        const float z = kPolygons[2] - 3 + float(k), t = 0.1f * float(k);
        const auto at = [&](float x, float y) { return Point{kPolygons[0] + x, kPolygons[1] + y, z + t * x}; };
        if (k % 2)
            make.add_polygon({at(-2, -2), at(2, -2), at(3, 1), at(0, 3), at(-3, 1)});
        else
            make.add_polygon({at(-2, -2), at(0, -0.5f), at(2, -2), at(0, 3)});  // concave
    }
    return std::move(make.scene);
}

Scene rippled(Scene mixed) {
    // How far a point moves, of a region of this radius around this centre.
    const auto moved = [](float* p, const Point& center, float radius) {
        float q[3];
        for (int k = 0; k < 3; ++k) q[k] = (p[k] - center[k]) / radius;
        for (int k = 0; k < 3; ++k) p[k] += 0.3f * radius * std::sin(5 * q[(k + 1) % 3] - 4 * q[(k + 2) % 3] + float(k));
    };
    const auto nearest = [](const float* p) {
        const Region* best = nullptr;
        float least = 4;  // radii
        for (const Region& region : mixed_regions()) {
            float d2 = 0;
            for (int k = 0; k < 3; ++k) d2 += (p[k] - region.center[k]) * (p[k] - region.center[k]);
            if (std::sqrt(d2) / region.radius < least) least = std::sqrt(d2) / region.radius, best = &region;
        }
        return best;
    };
    std::vector<int> uses(mixed.meshes.size(), 0);
    for (const Instance& instance : mixed.instances) ++uses[instance.mesh];
    for (size_t m = 0; m < mixed.meshes.size(); ++m)
        for (rt_u32 v = 0; v < mixed.meshes[m].vertex_count; ++v) {
            float* const p = &mixed.positions.own()[3 * size_t(mixed.meshes[m].first_vertex + v)];
            if (uses[m] > 1)
                moved(p, {0, 0, 0}, 1);  // in its own space
            else if (const Region* region = nearest(p))
                moved(p, region->center, region->radius);
        }
    for (Instance& instance : mixed.instances) {
        Affine& m = instance.world_from_object;
        float at[3] = {m[3], m[7], m[11]};
        const Region* const region = uses[instance.mesh] > 1 ? nearest(at) : nullptr;
        if (!region) continue;
        moved(at, region->center, region->radius);
        for (int k = 0; k < 3; ++k) m[4 * k + 3] = at[k];
    }
    return mixed;
}

Instance& place_shells(SceneMaker& make, const Affine& world_from_object) {
    for (int i = 0; i < 100; ++i) {
        const float s = 8 * std::pow(1.2f, -float(i));
        make.add_box({-s, -s, -s}, {s, s, s});
    }
    Instance& shells = make.place_mesh(world_from_object);
    shells.apart = true;
    return shells;
}

void add_common_part(SceneMaker& make, const Point& at) {
    place_shells(make, placed(at, 0, {1e-7f, 1e-7f, 1e-7f})).visible = false;
    make.add_sphere(at, 1e-7f);
    make.add_polygon({at, {at[0] + 1e-4f, at[1], at[2]}, {at[0], at[1], at[2] + 1e-4f}});
}

std::vector<NamedScene> small_scenes(uint64_t seed) {
    std::vector<NamedScene> scenes;
    const auto add = [&](const char* name, auto fill) {
        SceneMaker make(seed);
        fill(make);
        scenes.push_back({name, std::move(make.scene)});
    };
    add("empty", [](SceneMaker&) {});
    add("one triangle", [](SceneMaker& make) {
        make.add_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
        make.place_mesh();
    });
    for (const int count : {2, 3, 5, 9, 17})
        add(count == 2 ? "two triangles" : "a few triangles", [count](SceneMaker& make) {
            make.add_soup({0, 0, 0}, 3, 1, unsigned(count));
            make.place_mesh();
        });
    add("one sphere", [](SceneMaker& make) { make.add_sphere({1, 2, 3}, 0.5f); });
    add("only instances", [](SceneMaker& make) {
        make.add_soup({0, 0, 0}, 1, 1, 20);
        const rt_u32 mesh = make.end_mesh();
        for (int i = 0; i < 30; ++i) make.place(mesh, placed({3 * float(i), 0, 0}, float(i), {1, 1, 1}));
    });
    add("two instances of one triangle", [](SceneMaker& make) {
        make.add_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
        const rt_u32 mesh = make.end_mesh();
        make.place(mesh);
        make.place(mesh, placed({3, 0, 0}, 0, {1, 1, 1}));
    });
    add("300 times the same triangle", [](SceneMaker& make) {
        for (int i = 0; i < 300; ++i) make.add_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
        make.place_mesh();
    });
    add("300 times the same point", [](SceneMaker& make) {
        for (int i = 0; i < 300; ++i) make.add_triangle({5, 5, 5}, {5, 5, 5}, {5, 5, 5});
        make.place_mesh();
    });
    add("sizes that double", [](SceneMaker& make) {  // unbalanced: deep trees
        for (int i = 0; i < 60; ++i) {
            const float s = std::pow(2.0f, float(i) - 30);
            make.add_triangle({s, 0, 0}, {2 * s, 0, 0}, {s, s, s});
        }
        make.place_mesh();
    });
    add("in one plane", [](SceneMaker& make) {
        for (int y = 0; y < 20; ++y)
            for (int x = 0; x < 20; ++x)
                make.add_triangle({float(x), float(y), 0}, {float(x) + 1, float(y), 0}, {float(x), float(y) + 1, 0});
        make.place_mesh();
    });
    add("coordinates up to 1e18", [](SceneMaker& make) {
        make.add_soup({1e18f, -1e18f, 1e18f}, 1e18f, 1e17f, 200);
        make.add_soup({0, 0, 0}, 1, 0.1f, 100);
        make.place_mesh();
    });
    add("coordinates below 1e-30", [](SceneMaker& make) {
        make.add_soup({0, 0, 0}, 1e-30f, 1e-31f, 200);
        make.place_mesh();
    });
    scenes.push_back({"mixed", mixed_scene(seed)});
    return scenes;
}

Scene sparse_scene(unsigned count, uint64_t seed) {
    SceneMaker make(seed);
    const int side = static_cast<int>(std::ceil(std::cbrt(double(count))));
    for (unsigned i = 0; i < count; ++i) {
        const int n = static_cast<int>(i);
        const int x = n % side, y = n / side % side, z = n / side / side;
        const Point cell{float(x), float(y), float(z)};
        const Point p = make.around({3.1f * cell[0] - 7.3f, 2.9f * cell[1] + 1.7f, 3.3f * cell[2] - 2.9f}, 0.6f);
        make.add_triangle(make.around(p, 0.6f), make.around(p, 0.6f), make.around(p, 0.6f));
    }
    make.place_mesh();
    return std::move(make.scene);
}

Scene soup_scene(unsigned count, uint64_t seed) {
    SceneMaker make(seed);
    make.add_soup({0, 0, 0}, 50, 60 / std::cbrt(float(count + 1)), count);
    make.place_mesh();
    return std::move(make.scene);
}

Scene large_scene(unsigned count, uint64_t seed) {
    SceneMaker make(seed);
    add_faces(make);
    make.add_soup({200, 0, 0}, 50, 60 / std::cbrt(float(count + 1)), count);  // besides the faces, so that rays reach these
    make.place_mesh();
    return std::move(make.scene);
}

}  // namespace clarity::check
