// leaks.hpp -- rays from within a closed surface that meet nothing.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "support/generated.hpp"

namespace clarity::test {

struct Leaks {
    size_t count = 0;
    std::string first;
};
Leaks leaks_among(const ScenePtr& scene, const Settings& settings, const std::vector<rt_ray>& rays);

// Directions all over the sphere from points near `inside`.
Leaks random_leaks(const ScenePtr& scene, const Point& inside, float spread, const Settings& settings, size_t count);

using Edge = std::pair<Point, Point>;
std::vector<Edge> edges_of(const TriangleMesh& mesh);
// From each of some points straight at the begin of every edge, and at its middle and a random point of it.
std::vector<rt_ray> aimed_at(const std::vector<Edge>& edges, const std::vector<Point>& from);

}  // namespace clarity::test
