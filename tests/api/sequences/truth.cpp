#include "truth.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace sequences {
namespace {

Point operator-(const Point& a, const Point& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Point& a, const Point& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
double length(const Point& a) {
    return std::sqrt(dot(a, a));
}

// Barycentric coordinates this close to an edge, and rays this flat, are decided by rounding.
constexpr double kEdge = 1e-3, kFlat = 2e-3;
// Of distances. Kernels compute in floats, also the transforms of instances.
constexpr double kSlack = 2e-4;

double slack_at(const World& world, const Ray& ray, double t) {
    return kSlack * (std::abs(t) + (world.size + length(ray.origin) * 1e-3) / length(ray.direction));
}

void add(const World& world, const Ray& ray, double t, bool sure, int32_t prim, double more_slack, std::vector<Candidate>& to) {
    const double slack = slack_at(world, ray, t) + more_slack;
    if (!(t + slack >= ray.t_min && t - slack <= ray.t_max)) return;
    to.push_back({t, slack, prim, sure && t - slack > ray.t_min && t + slack < ray.t_max});
}

// Moeller, Trumbore 1997, Fast, Minimum Storage Ray/Triangle Intersection.
void add_triangle(const World& world, const Ray& ray, const Triangle& triangle, std::vector<Candidate>& to) {
    const Point &a = triangle.corners[0], e1 = triangle.corners[1] - a, e2 = triangle.corners[2] - a, from = ray.origin - a;
    const Point across = cross(ray.direction, e2), q = cross(from, e1);
    const double det = dot(e1, across);
    const double longest = std::max({length(e1), length(e2), length(e2 - e1)}), speed = length(ray.direction);
    // Slivers and rays in the plane of the triangle: near it, anything is possible.
    if (std::abs(det) <= kFlat * speed * longest * longest) {
        if (longest == 0) return;
        const Point middle = {a[0] + (e1[0] + e2[0]) / 3, a[1] + (e1[1] + e2[1]) / 3, a[2] + (e1[2] + e2[2]) / 3};
        const Point to_middle = middle - ray.origin;
        const double t = dot(to_middle, ray.direction) / (speed * speed);
        if (length(cross(to_middle, ray.direction)) / speed <= 1.01 * longest)
            add(world, ray, t, false, triangle.prim, 1.1 * longest / speed, to);
        return;
    }
    const double u = dot(from, across) / det, v = dot(ray.direction, q) / det, inside = std::min({u, v, 1 - u - v});
    if (inside >= -kEdge) add(world, ray, dot(e2, q) / det, inside >= kEdge, triangle.prim, 0, to);
}

void add_sphere(const World& world, const Ray& ray, const Sphere& sphere, std::vector<Candidate>& to) {
    const Point from = ray.origin - sphere.center;
    const double a = dot(ray.direction, ray.direction), b = dot(from, ray.direction);
    const double c = dot(from, from) - sphere.radius * sphere.radius, d = b * b - a * c;
    const double near_edge = kFlat * a * sphere.radius * sphere.radius;
    if (d < -near_edge) return;
    const double root = std::sqrt(std::max(d, 0.0));
    const double more = d < near_edge ? 2 * std::sqrt(near_edge) / a : 0;
    for (const double side : {-root, root}) add(world, ray, (-b + side) / a, d > near_edge, sphere.prim, more, to);
}

// `what`, the ray, and what it may hit.
std::string told(const World& world, const Ray& ray, const std::string& what) {
    std::ostringstream text;
    text.precision(9);
    text << what << "; the ray from";
    for (const double x : ray.origin) text << ' ' << x;
    text << " along";
    for (const double x : ray.direction) text << ' ' << x;
    text << " from " << ray.t_min << " to " << ray.t_max << " hits:";
    for (const Candidate& c : candidates(world, ray))
        text << (c.sure ? " " : " perhaps ") << c.prim << " at " << c.t << " +- " << c.slack << ',';
    text << " of " << world.triangles.size() << " triangles, " << world.spheres.size() << " spheres";
    return text.str();
}

bool is_that(const World& world, const Candidate& candidate, float t, const int32_t* prim) {
    return std::abs(t - candidate.t) <= candidate.slack && (!prim || !world.numbers_known || *prim == candidate.prim);
}

}  // namespace

std::vector<Candidate> candidates(const World& world, const Ray& ray) {
    std::vector<Candidate> found;
    for (const Triangle& triangle : world.triangles) add_triangle(world, ray, triangle, found);
    for (const Sphere& sphere : world.spheres) add_sphere(world, ray, sphere, found);
    return found;
}

std::string fault_of_closest(const World& world, const Ray& ray, const Found& found) {
    const bool hit = found.t < INFINITY;
    const auto number = [](const int32_t* n) { return n ? std::to_string(*n) : "-"; };
    const std::string what =
        "t is " + std::to_string(found.t) + ", prim " + number(found.prim) + ", instance " + number(found.instance);
    // What holds for all rays, also those of which nothing is known.
    if (found.prim && (*found.prim < -1 || *found.prim >= world.prim_count)) return told(world, ray, what + ": no such prim");
    if (found.instance && (*found.instance < -1 || *found.instance >= world.instance_count))
        return told(world, ray, what + ": no such instance");
    if (!ray.known) return "";
    if (std::isnan(found.t)) return told(world, ray, what);
    if (found.prim && hit != (*found.prim >= 0)) return told(world, ray, what + ": neither hit nor miss");
    if (found.instance && !hit && *found.instance != -1) return told(world, ray, what + ": a miss with an instance");
    bool explained = !hit;
    for (const Candidate& c : candidates(world, ray)) {
        explained |= is_that(world, c, found.t, found.prim);
        if (c.sure && c.t + c.slack < found.t) return told(world, ray, what + ": a nearer hit is missed");
    }
    if (!explained) return told(world, ray, what + ": nothing is there");
    if (found.uv && hit && world.spheres.empty()) {
        const float u = found.uv[0], v = found.uv[1];
        if (!(u >= -0.01f && v >= -0.01f && u + v <= 1.01f))
            return told(world, ray, what + ": uv " + std::to_string(u) + " " + std::to_string(v) + " is outside");
    }
    return "";
}

std::string fault_of_any(const World& world, const Ray& ray, bool occluded) {
    if (!ray.known) return "";
    const std::vector<Candidate> all = candidates(world, ray);
    const bool sure = std::any_of(all.begin(), all.end(), [](const Candidate& c) { return c.sure; });
    if (occluded ? !all.empty() : !sure) return "";
    return told(world, ray, occluded ? "occluded by nothing" : "not occluded");
}

std::string fault_of_count(const World& world, const Ray& ray, int64_t count) {
    if (count < 0 || count > 2 * int64_t{world.prim_count}) return told(world, ray, std::to_string(count) + " hits");
    if (!ray.known) return "";
    const std::vector<Candidate> all = candidates(world, ray);
    const auto sure = std::count_if(all.begin(), all.end(), [](const Candidate& c) { return c.sure; });
    if (count >= sure && count <= static_cast<int64_t>(all.size())) return "";
    return told(world, ray, std::to_string(count) + " hits");
}

std::string fault_of_all(const World& world, const Ray& ray, const float* t, const int32_t* prim, size_t count) {
    if (std::string why = fault_of_count(world, ray, static_cast<int64_t>(count)); !why.empty()) return why;
    for (size_t i = 0; i < count; ++i) {
        if (prim[i] < 0 || prim[i] >= world.prim_count) return told(world, ray, "hit of prim " + std::to_string(prim[i]));
        if (!ray.known) continue;
        if (i > 0 && !(t[i - 1] < t[i] || (t[i - 1] == t[i] && prim[i - 1] <= prim[i])))
            return told(world, ray, "hits are not in order");
    }
    if (!ray.known) return "";
    const std::vector<Candidate> all = candidates(world, ray);
    for (size_t i = 0; i < count; ++i)
        if (std::none_of(all.begin(), all.end(), [&](const Candidate& c) { return is_that(world, c, t[i], prim + i); }))
            return told(world, ray, "nothing is at " + std::to_string(t[i]) + ", prim " + std::to_string(prim[i]));
    for (const Candidate& c : all) {
        bool listed = !c.sure;
        for (size_t i = 0; i < count && !listed; ++i) listed = is_that(world, c, t[i], prim + i);
        if (!listed) return told(world, ray, "the hit at " + std::to_string(c.t) + " is missing");
    }
    return "";
}

}  // namespace sequences
