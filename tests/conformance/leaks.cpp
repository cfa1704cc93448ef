#include "leaks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

namespace clarity::test {
namespace {

constexpr size_t kBatch = 1000000;

void count_leaks(const ScenePtr& scene, const Settings& settings, const std::vector<rt_ray>& rays, Leaks& leaks) {
    const std::vector<rt_hit> hits = Workbench::get().rays(scene, settings, rays, false);
    for (size_t i = 0; i < rays.size(); ++i)
        if (!std::isfinite(hits[i].t) && leaks.count++ == 0) {
            char text[160];
            const rt_ray& r = rays[i];
            std::snprintf(text, sizeof text, "from %.9g %.9g %.9g along %.9g %.9g %.9g", r.origin[0], r.origin[1], r.origin[2],
                          r.direction[0], r.direction[1], r.direction[2]);
            leaks.first = text;
        }
}

}  // namespace

Leaks leaks_among(const ScenePtr& scene, const Settings& settings, const std::vector<rt_ray>& rays) {
    Leaks leaks;
    count_leaks(scene, settings, rays, leaks);
    return leaks;
}

Leaks random_leaks(const ScenePtr& scene, const Point& inside, float spread, const Settings& settings, size_t count) {
    std::mt19937 random(11);
    std::normal_distribution<float> normal;
    std::uniform_real_distribution<float> around(-spread, spread);
    Leaks leaks;
    std::vector<rt_ray> rays;
    for (size_t done = 0; done < count; done += rays.size()) {
        rays.resize(std::min(kBatch, count - done));
        for (rt_ray& ray : rays) {
            for (int k = 0; k < 3; ++k) {
                ray.origin[k] = inside[k] + around(random);
                ray.direction[k] = normal(random);
            }
            ray.t_min = 0;
            ray.t_max = INFINITY;
        }
        count_leaks(scene, settings, rays, leaks);
    }
    return leaks;
}

std::vector<Edge> edges_of(const TriangleMesh& mesh) {
    std::vector<Edge> edges;
    for (size_t i = 0; i < mesh.triangles.size(); ++i)
        edges.emplace_back(mesh.vertex(mesh.triangles[i]), mesh.vertex(mesh.triangles[i % 3 == 2 ? i - 2 : i + 1]));
    return edges;
}

std::vector<rt_ray> aimed_at(const std::vector<Edge>& edges, const std::vector<Point>& from) {
    std::mt19937 random(12);
    std::uniform_real_distribution<float> any(0, 1);
    std::vector<rt_ray> rays;
    for (const Point& eye : from)
        for (const auto& [a, b] : edges)
            for (const float s : {0.0f, 0.5f, any(random)}) {
                rt_ray ray{{eye[0], eye[1], eye[2]}, 0, {}, INFINITY};
                for (int k = 0; k < 3; ++k) ray.direction[k] = a[k] + s * (b[k] - a[k]) - eye[k];
                rays.push_back(ray);
            }
    return rays;
}

}  // namespace clarity::test
