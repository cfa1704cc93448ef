// ray_text.hpp -- describes the rays of a pixel in words and numbers.
#pragma once
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "render/tracers/inspect/inspect.hpp"
#include "scene/scene.hpp"

namespace clarity::ui {

class Session;

// Sums over all rays of a pixel. steps counts visited nodes.
struct RayTotals {
    size_t traced = 0, shadow = 0, dropped = 0;
    size_t steps = 0, leaf_tests = 0;
};
RayTotals totals_of(const RayTree& tree);

// For each ray, the indices of the rays that it spawned, in order.
using RayChildren = std::vector<std::vector<int>>;
RayChildren children_of(const RayTree& tree);

// The names of the lights that are on, in the order in which frames number them.
std::vector<std::string> names_of_lights(const Session& session);

// "mirror \u2192 teapot", "light 1: in shadow", "refracted: too deep".
std::string ray_title(const RayRecord& ray, const Scene& scene, const std::vector<std::string>& lights);
// "12.3"; empty if there is no distance.
std::string ray_distance(const RayRecord& ray);
std::vector<std::pair<std::string, std::string>> ray_facts(const RayRecord& ray, const Scene& scene,
                                                           const std::vector<std::string>& lights);
// The facts as lines of text, for a tooltip.
std::vector<std::string> ray_lines_of(const RayRecord& ray, const Scene& scene, const std::vector<std::string>& lights);
std::string triple_text(const std::array<float, 3>& v);

}  // namespace clarity::ui
