// truth.hpp -- what rays hit, by each primitive for itself in double precision, and which answers of the library are possible.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace sequences {

using Point = std::array<double, 3>;
using Transform = std::array<double, 12>;  // world from object, three rows

// A ray as the library sees it: its numbers are rounded to floats where the library rounds them.
struct Ray {
    Point origin{}, direction{};
    double t_min = 0, t_max = 0;
    bool known = true;  // what it hits. Nothing is said of rays with numbers that are not finite, or a tiny direction
};

struct Triangle {
    std::array<Point, 3> corners;
    int32_t prim;
};
struct Sphere {
    Point center;
    double radius;
    int32_t prim;
};
struct World {
    std::vector<Triangle> triangles;
    std::vector<Sphere> spheres;
    double size = 1;  // a length of the scene, for tolerances
    int32_t prim_count = 0;
    int32_t instance_count = 0;  // hits name instances below it
    bool numbers_known = true;   // whether `prim` above is the library's
};

// A hit that a ray has, or may have where rounding decides.
struct Candidate {
    double t, slack;
    int32_t prim;
    bool sure;
};
std::vector<Candidate> candidates(const World& world, const Ray& ray);

// One hit of the library's.
struct Found {
    float t;
    const int32_t *prim, *instance;  // null: not asked for
    const float* uv;
};
// Why an answer is impossible; "" if it is possible.
std::string fault_of_closest(const World& world, const Ray& ray, const Found& found);
std::string fault_of_any(const World& world, const Ray& ray, bool occluded);
std::string fault_of_count(const World& world, const Ray& ray, int64_t count);
// t, prim: all hits of the ray in the library's order.
std::string fault_of_all(const World& world, const Ray& ray, const float* t, const int32_t* prim, size_t count);

}  // namespace sequences
