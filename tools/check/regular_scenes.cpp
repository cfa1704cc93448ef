#include "tools/check/regular_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/angle.hpp"

namespace clarity::check {
namespace {

// n x m squares from `lo`, across the axis `across`.
void add_squares(SceneMaker& make, const Point& lo, int across, float size, int n, int m) {
    const int u = (across + 1) % 3, v = (across + 2) % 3;
    const auto at = [&](int i, int j) {
        Point p = lo;
        p[u] += size * float(i), p[v] += size * float(j);
        return p;
    };
    for (int j = 0; j < m; ++j)
        for (int i = 0; i < n; ++i) make.add_quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
}

// n^3 cubes from `lo`, one every `pitch`. Neighbours share their corners if `size` is the pitch.
void add_cubes(SceneMaker& make, const Point& lo, float pitch, float size, int n) {
    for (int i = 0; i < n * n * n; ++i) {
        const int at[3] = {i % n, i / n % n, i / n / n};
        Point a, b;
        for (int k = 0; k < 3; ++k) {
            a[k] = lo[k] + pitch * float(at[k]);
            b[k] = size == pitch ? lo[k] + pitch * float(at[k] + 1) : a[k] + size;
        }
        make.add_box(to_vec(a), to_vec(b));
    }
}

// Large slanted faces, and small ones just in front of them and behind: nearer by 5e-5 to 1e-3 of the distance of 10, from
// which rays come. The large face's box begins well before, so it is hit first.
void add_decals(SceneMaker& make, const Point& center) {
    for (int axis = 0; axis < 3; ++axis) {
        const auto turned = [&](float a, float b, float c) {
            Point p = center;
            p[axis] += a, p[(axis + 1) % 3] += b, p[(axis + 2) % 3] += c;
            return p;
        };
        for (const float side : {-6.0f, 6.0f}) {
            make.add_quad(turned(side - 1, -2, -2), turned(side + 1, 2, -2), turned(side + 1, 2, 2), turned(side - 1, -2, 2));
            for (int i = 0; i < 100; ++i) {
                const float b = 3.6f * make.random() - 1.8f, c = 3.6f * make.random() - 1.8f, s = 0.0015f;
                const float away = 10 * std::pow(10.0f, -4.3f + 1.3f * make.random()), slant = i % 2 ? 0.5f * s : 0.0f;
                for (const float off : {-away, away}) {
                    const float a = side + b / 2 + off;
                    make.add_triangle(turned(a - slant, b - s, c - s), turned(a + slant, b + s, c - s), turned(a, b, c + s));
                }
            }
        }
    }
}

// Slim triangles through many cells, in all directions.
void add_needles(SceneMaker& make, const Point& center) {
    for (int i = 0; i < 400; ++i) {
        const Point p = make.around(center, 4), q = make.around(center, 4);
        Point r = q;
        r[size_t(i) % 3] += 0.02f + 0.1f * make.random();
        make.add_triangle(p, q, r);
    }
}

// Sizes that grow by a half around one point: a tree that is as deep as there are sizes. Small squares among them fill it.
void add_deep(SceneMaker& make, const Point& center) {
    for (int i = 0; i < 70; ++i) {
        const float s = 0.001f * std::pow(1.22f, float(i));
        make.add_box({center[0] - s, center[1] - s, center[2] - s}, {center[0] + s, center[1] + s, center[2] + s});
    }
    make.add_soup(center, 3, 0.2f, 3000);
}

// A bowl of 200 across, and in its middle a ball of 0.1 of as many triangles.
void add_stadium(SceneMaker& make, const Point& center) {
    const auto at = [&](int ring, int s) {
        const float phi = 2 * float(kPi) * float(s % 48) / 48, r = 40 + 5 * float(ring);
        return Point{center[0] + r * std::cos(phi), center[1] + 0.25f * float(ring * ring), center[2] + r * std::sin(phi)};
    };
    for (int ring = 0; ring < 12; ++ring)
        for (int s = 0; s < 48; ++s) make.add_quad(at(ring, s), at(ring + 1, s), at(ring + 1, s + 1), at(ring, s + 1));
    make.add_ball(center, 0.05f, 32, 18);
    make.add_quad(Point{center[0] - 40, center[1] - 0.05f, center[2] - 40}, {center[0] + 40, center[1] - 0.05f, center[2] - 40},
                  {center[0] + 40, center[1] - 0.05f, center[2] + 40}, {center[0] - 40, center[1] - 0.05f, center[2] + 40});
}

// The same small floor forty times, in one place.
void add_copies(SceneMaker& make, const Point& lo) {
    for (int i = 0; i < 40; ++i) add_squares(make, lo, 1, 0.5f, 4, 4);
}

struct PatchRow {
    Patch patch;
    void (*fill)(SceneMaker& make);
};
const PatchRow kPatchRows[] = {
    {{"floor", 10.0f / 64}, [](SceneMaker& make) { add_squares(make, {0, 0, 0}, 1, 10.0f / 64, 64, 64); }},
    {{"wall", 0.1f}, [](SceneMaker& make) { add_squares(make, {-100.1f, 7.3f, -50.7f}, 0, 0.1f, 40, 36); }},
    {{"cubes", 1.0f / 3}, [](SceneMaker& make) { add_cubes(make, {-20, 30, 110}, 1.0f / 3, 1.0f / 3, 6); }},
    {{"blocks", 8}, [](SceneMaker& make) { add_cubes(make, {1000, 1000, 1000}, 16, 8, 5); }},
    {{"tiny floor", 1e-3f}, [](SceneMaker& make) { add_squares(make, {5.5f, 40, -60.25f}, 2, 1e-3f, 32, 32); }},
    {{"decals", 0.0015f}, [](SceneMaker& make) { add_decals(make, {0, 120, 0}); }},
    {{"needles", 0.1f}, [](SceneMaker& make) { add_needles(make, {60, 60, -200}); }},
    {{"deep", 0.1f}, [](SceneMaker& make) { add_deep(make, {-200, 0, 0}); }},
    {{"stadium", 0.02f}, [](SceneMaker& make) { add_stadium(make, {0, -400, 0}); }},
    {{"copies", 0.5f}, [](SceneMaker& make) { add_copies(make, {200, 16, -8}); }},
};

}  // namespace

const std::vector<Patch>& patches() {
    static const std::vector<Patch> all = [] {
        std::vector<Patch> list;
        for (const PatchRow& row : kPatchRows) list.push_back(row.patch);
        return list;
    }();
    return all;
}

Scene regular_scene(uint64_t seed) {
    SceneMaker make(seed);
    for (const PatchRow& row : kPatchRows) {
        row.fill(make);
        make.place_mesh().apart = true;
    }
    add_common_part(make, {0, 60, 60});
    return std::move(make.scene);
}

Scene bent(Scene regular) {
    std::vector<float>& positions = regular.positions.own();
    for (size_t m = 0; m < std::size(kPatchRows); ++m) {
        const float size = kPatchRows[m].patch.size;
        for (rt_u32 v = 0; v < regular.meshes[m].vertex_count; ++v) {
            float* const p = &positions[3 * size_t(regular.meshes[m].first_vertex + v)];
            const float x = p[0] / size, y = p[1] / size, z = p[2] / size;
            p[0] += 2 * size * std::sin(0.3f * y + 0.2f * z);
            p[1] += 2 * size * std::sin(0.3f * z + 0.2f * x);
            p[2] += 2 * size * std::sin(0.3f * x + 0.2f * y);
        }
    }
    return regular;
}

Scene sizes_scene(uint64_t seed) {
    SceneMaker make(seed);
    make.add_soup({0, 0, 0}, 6, 1, 300);
    make.place_mesh();
    for (unsigned count = 1; count <= 20; ++count) {
        make.add_soup({0, 0, 0}, 2, 1, count);
        make.place_mesh(placed({20 + 5 * float(count), 0, 5}, 0.3f * float(count), {1, 1, -1})).apart = true;
    }
    for (int i = 0; i < 300; ++i) {
        const float s = 1 + make.random(), h = 0.2f + make.random(), c = h * (2 * make.random() - 1);
        make.add_triangle({-s, -s, -h}, {s, -s, h}, {-s, s, c});
    }
    make.place_mesh(placed({-30, 0, 0}, 0.4f, {1, 2, 1})).apart = true;
    add_common_part(make, {0, 30, 0});
    return std::move(make.scene);
}

Scene crowd_scene(unsigned count) {
    SceneMaker make;
    make.add_box({-60, -60, -60}, {60, 60, 60});
    for (unsigned i = 0; i < count; ++i) {
        const float s = 1 + make.random();
        const Point o = make.around({0, 0, 0}, 0.2f);
        const auto corner = [&](int k) {  // in the plane where the coordinates add up to s and to those of o
            Point p;
            for (int j = 0; j < 3; ++j) p[j] = o[j] + (j == k ? 2 : -0.5f) * s;
            return p;
        };
        make.add_triangle(corner(0), corner(1), corner(2));
    }
    make.place_mesh();
    add_common_part(make, {30, 33, 31});
    return std::move(make.scene);
}

Scene row_scene(unsigned count) {
    SceneMaker make;
    for (unsigned i = 0; i < count; ++i) {
        const float s = std::pow(4.0f, float(i) - 12), x = 1.02f * s, y = row_place(i, count) * x, z = 0.32f * x - y,
                    r = 0.003f * s;
        make.add_triangle({s, -0.2f * s, -0.2f * s}, {1.05f * s, 0.3f * s, -0.2f * s}, {s, -0.2f * s, 0.3f * s});
        make.add_triangle({x, y - r, z - r}, {x, y + r, z - r}, {x, y, z + r});
    }
    make.place_mesh();
    return std::move(make.scene);
}

Scene floor_scene() {
    SceneMaker make;
    kPatchRows[0].fill(make);
    make.place_mesh();
    add_common_part(make, {5.05f, 0, 5.03f});
    return std::move(make.scene);
}

}  // namespace clarity::check
