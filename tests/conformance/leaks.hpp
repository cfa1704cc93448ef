// leaks.hpp -- finds rays which start inside a closed surface and hit nothing.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "support/generated.hpp"

namespace clarity::test {

// Number of rays that hit nothing, and a description of the first.
struct Leaks {
    size_t count = 0;
    std::string first;
};
Leaks leaks_among(const ScenePtr& scene, const Settings& settings, const std::vector<rt_ray>& rays);

// Traces `count` rays in directions all over the sphere, from points at most `spread` from `inside`.
Leaks random_leaks(const ScenePtr& scene, const Point& inside, float spread, const Settings& settings, size_t count);

using Edge = std::pair<Point, Point>;
std::vector<Edge> edges_of(const TriangleMesh& mesh);
// Rays from each point to the beginning, the middle and a random point of every edge.
std::vector<rt_ray> aimed_at(const std::vector<Edge>& edges, const std::vector<Point>& from);

}  // namespace clarity::test
