// watertight_polygons_test.cpp -- no ray leaves a closed surface of polygons through edges and corners that they share with
// each other or with triangles. The polygons have many or few corners and are convex or not. A leak would show as black pixels
// along the edges of a room.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>

#include "leaks.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

using Matrix = std::array<double, 9>;

// The faces of a closed surface as loops of corners. Neighbours have exactly the same corners.
struct Faces {
    std::vector<Point> corners;
    std::vector<std::vector<rt_u32>> loops;

    rt_u32 add(double x, double y, double z) {
        corners.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
        return static_cast<rt_u32>(corners.size() - 1);
    }
    void transform(const Matrix& m, double scale, const std::array<double, 3>& offset) {
        for (Point& p : corners) {
            const Point q = p;
            for (int k = 0; k < 3; ++k)
                p[k] = static_cast<float>(scale * (m[3 * k] * q[0] + m[3 * k + 1] * q[1] + m[3 * k + 2] * q[2]) + offset[k]);
        }
    }
    std::vector<Edge> edges() const {
        std::vector<Edge> found;
        for (const std::vector<rt_u32>& loop : loops)
            for (size_t i = 0; i < loop.size(); ++i) found.emplace_back(corners[loop[i]], corners[loop[(i + 1) % loop.size()]]);
        return found;
    }
    bool is_closed() const {
        std::map<std::pair<rt_u32, rt_u32>, int> ways;
        for (const std::vector<rt_u32>& loop : loops)
            for (size_t i = 0; i < loop.size(); ++i) ++ways[{loop[i], loop[(i + 1) % loop.size()]}];
        for (const auto& [way, count] : ways) {
            const auto back = ways.find({way.second, way.first});
            if (count != 1 || back == ways.end() || back->second != 1) return false;
        }
        return !ways.empty();
    }
};

// Two loops of `n` corners, one above the other, with a quadrilateral for each edge.
Faces prism(const std::vector<std::array<double, 2>>& outline) {
    Faces faces;
    const auto n = static_cast<rt_u32>(outline.size());
    for (const double y : {-0.75, 0.75})
        for (const auto& [x, z] : outline) faces.add(x, y, z);
    std::vector<rt_u32> lower, upper;
    for (rt_u32 i = 0; i < n; ++i) {
        lower.push_back(i);
        upper.push_back(2 * n - 1 - i);
        const rt_u32 next = (i + 1) % n;
        faces.loops.push_back({next, i, n + i, n + next});
    }
    faces.loops.push_back(lower);
    faces.loops.push_back(upper);
    return faces;
}

Faces room() {
    return prism({{-1, -1}, {-1, 1}, {1, 1}, {1, -1}});
}

// Corners are near and far alternately, so that floor and ceiling are far from convex.
Faces star(unsigned points) {
    std::vector<std::array<double, 2>> outline;
    for (unsigned i = 0; i < 2 * points; ++i) {
        const double r = i % 2 ? 0.4 : 1, phi = 3.14159265358979 * i / points;
        outline.push_back({r * std::sin(phi), r * std::cos(phi)});
    }
    return prism(outline);
}

// A sphere of trapezoids, with a cap of many corners at each end.
Faces globe(unsigned segments, unsigned rings) {
    Faces faces;
    for (unsigned r = 1; r < rings; ++r)
        for (unsigned s = 0; s < segments; ++s) {
            const double theta = 3.14159265358979 * r / rings, phi = 2 * 3.14159265358979 * s / segments;
            faces.add(std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi));
        }
    std::vector<rt_u32> north, south;
    const auto at = [&](unsigned r, unsigned s) { return (r - 1) * segments + s % segments; };
    for (unsigned s = 0; s < segments; ++s) {
        north.push_back(at(1, s));
        south.push_back(at(rings - 1, segments - s));
        for (unsigned r = 1; r + 1 < rings; ++r)
            faces.loops.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1), at(r, s + 1)});
    }
    faces.loops.push_back(north);
    faces.loops.push_back(south);
    return faces;
}

// Every `nth` face of four corners becomes two triangles; the rest are polygons.
ScenePtr scene_of(const Faces& faces, size_t nth) {
    TriangleMesh mesh;
    std::vector<const std::vector<rt_u32>*> polygons;
    size_t quads = 0;
    for (const std::vector<rt_u32>& loop : faces.loops) {
        if (nth == 0 || loop.size() != 4 || quads++ % nth != 0) {
            polygons.push_back(&loop);
            continue;
        }
        const auto corner = [&](size_t i) { return faces.corners[loop[i]]; };
        mesh.add_quad(corner(0), corner(1), corner(2), corner(3));
    }
    Scene scene = test::scene_of(mesh);
    if (mesh.triangles.empty()) {
        scene.meshes.clear();
        scene.instances.clear();
    }
    for (const std::vector<rt_u32>* loop : polygons) {
        scene.polygons.push_back({static_cast<rt_u32>(scene.polygon_corners.size() / 3), static_cast<rt_u32>(loop->size()), 0});
        for (const rt_u32 i : *loop)
            scene.polygon_corners.insert(scene.polygon_corners.end(), faces.corners[i].begin(), faces.corners[i].end());
    }
    return shared_scene(std::move(scene));
}

Matrix rotation(std::mt19937& random) {
    std::normal_distribution<double> normal;
    double w = normal(random), x = normal(random), y = normal(random), z = normal(random);
    const double s = 1 / std::sqrt(w * w + x * x + y * y + z * z);
    w *= s, x *= s, y *= s, z *= s;
    return {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z),    1 - 2 * (x * x + z * z),
            2 * (y * z - w * x),     2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)};
}

constexpr Matrix kUpright = {1, 0, 0, 0, 1, 0, 0, 0, 1};

// Traces about `aims` rays from points in the middle of the room to edges and corners, and random ones.
void expect_tight(const std::string& name, Faces faces, const Matrix& turn, double scale, const std::array<double, 3>& offset,
                  size_t aims, size_t nth = 0) {
    ASSERT_TRUE(faces.is_closed()) << name << ": not a closed surface, it proves nothing";
    faces.transform(turn, scale, offset);
    const ScenePtr scene = scene_of(faces, nth);
    const std::vector<Edge> edges = faces.edges();
    std::mt19937 random(31);
    std::uniform_real_distribution<double> around(-0.2 * scale, 0.2 * scale);
    const Point inside = {static_cast<float>(offset[0]), static_cast<float>(offset[1]), static_cast<float>(offset[2])};
    std::vector<Point> eyes = {inside};
    while (eyes.size() * edges.size() * 3 < aims) {
        Point eye;
        for (int k = 0; k < 3; ++k) eye[k] = static_cast<float>(offset[k] + around(random));
        eyes.push_back(eye);
    }
    const std::vector<rt_ray> rays = aimed_at(edges, eyes);
    unsigned count = 0;
    for (const std::string& accel : Workbench::get().accels()) {
        // Each structure runs with one lane count, but bvh8 with both, because it traverses packets in a different way.
        const int usual = count++ % 2 ? 1 : 16;
        for (const int lanes : {16, 1}) {
            if ((lanes != usual && accel != "bvh8") || (accel == "linear" && edges.size() > 200)) continue;
            Settings settings;
            settings.accel = accel;
            settings.lanes = lanes;
            const Leaks aimed = leaks_among(scene, settings, rays),
                        loose = random_leaks(scene, inside, static_cast<float>(0.2 * scale), settings, aims / 4);
            const std::string what = name + ", " + accel + ", " + std::to_string(lanes) + " lanes: ";
            EXPECT_EQ(aimed.count, 0u) << what << "aimed at edges and corners: " << aimed.first;
            EXPECT_EQ(loose.count, 0u) << what << loose.first;
        }
    }
}

TEST(WatertightPolygons, Room) {
    expect_tight("room", room(), kUpright, 1, {0, 0, 0}, 300000);
}

TEST(WatertightPolygons, RoomsTurnedAnyWay) {
    std::mt19937 random(32);
    for (int i = 0; i < 4; ++i) expect_tight("turned room", room(), rotation(random), 1, {0, 0, 0}, 100000);
}

TEST(WatertightPolygons, FarFromTheOriginAndSmall) {
    std::mt19937 random(33);
    expect_tight("room at 1e4", room(), rotation(random), 1, {1e4, -1e4, 1e4}, 100000);
    expect_tight("room of 1e-3", room(), rotation(random), 1e-3, {3, 2, -1}, 100000);
    expect_tight("room of 1e6", room(), rotation(random), 1e6, {0, 0, 0}, 100000);
}

TEST(WatertightPolygons, Star) {
    std::mt19937 random(34);
    expect_tight("star", star(9), kUpright, 1, {0, 0, 0}, 100000);
    expect_tight("turned star", star(40), rotation(random), 1, {0, 0, 0}, 100000);
}

TEST(WatertightPolygons, GlobeWithCaps) {
    std::mt19937 random(35);
    expect_tight("globe", globe(48, 24), rotation(random), 1, {0, 0, 0}, 200000);
}

TEST(WatertightPolygons, TrianglesAmongThem) {
    std::mt19937 random(36);
    expect_tight("room with triangles", room(), rotation(random), 1, {0, 0, 0}, 100000, 2);
    expect_tight("globe with triangles", globe(48, 24), rotation(random), 1, {0, 0, 0}, 200000, 3);
}

// Near an edge between two walls, rounding moves hit points to either side of the other wall. None of them may be in the shadow
// of that wall.
TEST(WatertightPolygons, EdgesAreNotInShadow) {
    // The room is as high as wide, so that the diagonals of the picture lie on its edges from front to back.
    const ScenePtr scene = scene_of(prism({{-0.75, -1}, {-0.75, 1}, {0.75, 1}, {0.75, -1}}), 0);
    size_t dark = 0;
    for (const float z : {0.95f, 0.7f, 0.3f}) {
        View view = view_from({0, 0, z}, {0, 0, -1}, 75);
        view.ambient = {0.1f, 0.1f, 0.1f};
        view.lights = {whitted_light(RT_LIGHT_POINT, {0.1f, 0.65f, 0.1f}, {1, 1, 1})};
        const FloatImage image =
            Workbench::get().values(scene, make_settings({{"accel", "bvh8"}, {"size", "600x600"}, {"depth", "1"}}), view);
        for (unsigned y = 0; y < image.height; ++y)
            for (unsigned x = 1; x + 1 < image.width; ++x) {
                const float *at = &image.pixels[image.channels * (size_t(y) * image.width + x)], *left = at - image.channels,
                            *right = at + image.channels;
                ASSERT_GT(*at, 0.0f) << "black at " << x << ", " << y;
                dark += *at < 0.6f * std::min(*left, *right) ? 1 : 0;
            }
    }
    EXPECT_EQ(dark, 0u);
}

}  // namespace
