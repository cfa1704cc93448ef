#include "tools/check/hits/built_checks.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "base/numbers.hpp"
#include "stand/ray_text.hpp"
#include "tools/check/scenes.hpp"

namespace clarity::check {
namespace {

constexpr float kReach = 1e6f;  // t_max: beyond all faces

const RaySet kPlaneRays{"hits.planes", "rays exactly in planes of boxes, with directions that have zeros of either sign", {}};

// A square of squares across an axis. Its corners are multiples of `step` from `corner`, so it is exact in floats.
struct Face {
    int axis;
    std::array<double, 3> lo, hi;  // equal along the axis
};

// Faces across each axis of `axes`: a floor has one, a lattice of cubes count + 1 for each axis.
struct Lattice {
    Point corner;
    float step;
    int count;           // squares along a side
    const char* planes;  // "xyz": a lattice; "y": one floor across y
    Point mirror{1, 1, 1};
    bool is_instance = false;  // made around the origin and placed
};

// 0, 1, -3.5 and 1000 occur along each axis, alone and with others.
const Lattice kLattices[] = {
    {{0, 0, 0}, 1, 4, "xyz"},
    {{1, 1000, -3.5f}, 0.5f, 4, "xyz"},
    {{-3.5f, 20, 1000}, 0.5f, 4, "xyz"},
    {{1000, -3.5f, 1}, 1, 3, "xyz"},
    {{-20, 0, 0}, 0.0009765625f, 4, "xyz"},
    {{0, 50, 60}, 1, 8, "x"},
    {{60, 0, 50}, 1, 8, "y"},
    {{50, 60, 0}, 1, 8, "z"},
    {{-3.5f, 150, 160}, 0.25f, 8, "x"},
    {{160, 1000, 150}, 1, 8, "y"},
    {{150, 160, 1}, 1, 8, "z"},
    {{0, -50, 0}, 1, 2, "xyz", {1, 1, 1}, true},
    {{0, 0, -80}, 1, 2, "xyz", {-1, 1, -1}, true},
    {{1, -3.5f, -1000}, 1, 2, "xyz", {1, 1, 1}, true},
};

void add_squares(SceneMaker& make, const Lattice& lattice) {
    for (const char* plane = lattice.planes; *plane; ++plane) {
        const int a = *plane - 'x', u = (a + 1) % 3, v = (a + 2) % 3, layers = lattice.planes[1] ? lattice.count + 1 : 1;
        const auto at = [&](int layer, int i, int j) {
            Point p;
            p[a] = float(layer), p[u] = float(i), p[v] = float(j);
            for (int k = 0; k < 3; ++k) p[k] = (lattice.is_instance ? 0 : lattice.corner[k]) + lattice.step * p[k];
            return p;
        };
        for (int layer = 0; layer < layers; ++layer)
            for (int i = 0; i < lattice.count; ++i)
                for (int j = 0; j < lattice.count; ++j)
                    make.add_quad(at(layer, i, j), at(layer, i + 1, j), at(layer, i + 1, j + 1), at(layer, i, j + 1));
    }
}

Scene plane_scene(uint64_t) {
    SceneMaker make;
    const rt_u32 none = RT_NONE;
    rt_u32 placed_mesh = none;
    for (const Lattice& lattice : kLattices) {
        if (!lattice.is_instance || placed_mesh == none) add_squares(make, lattice);
        if (!lattice.is_instance) {
            make.place_mesh();
            continue;
        }
        if (placed_mesh == none) placed_mesh = make.end_mesh();
        Affine world = kIdentity;
        for (int k = 0; k < 3; ++k) world[5 * k] = lattice.mirror[k], world[4 * k + 3] = lattice.corner[k];
        make.place(placed_mesh, world);
    }
    add_common_part(make, {33.3f, 27.7f, 31.1f});
    return std::move(make.scene);
}

std::vector<Face> plane_faces() {
    std::vector<Face> faces;
    for (const Lattice& lattice : kLattices) {
        const auto edge = [&](int axis, int i) {
            return double(lattice.corner[axis]) + double(lattice.mirror[axis]) * lattice.step * i;
        };
        for (const char* plane = lattice.planes; *plane; ++plane) {
            const int a = *plane - 'x', layers = lattice.planes[1] ? lattice.count + 1 : 1;
            for (int layer = 0; layer < layers; ++layer) {
                Face face{a, {}, {}};
                for (int k = 0; k < 3; ++k) {
                    const double begin = edge(k, k == a ? layer : 0), end = edge(k, k == a ? layer : lattice.count);
                    face.lo[k] = std::min(begin, end), face.hi[k] = std::max(begin, end);
                }
                faces.push_back(face);
            }
        }
    }
    return faces;
}

// In each lattice, rays along each axis and within each plane of two, in either direction, with zeros of either sign. Sixteen
// neighbours are alike, so they make coherent packets; at the end rays of all kinds are side by side.
std::vector<rt_ray> plane_rays() {
    std::mt19937 random(34);
    const auto any = [&] { return std::uniform_real_distribution<float>(0, 1)(random); };
    std::vector<rt_ray> rays;
    for (const Lattice& lattice : kLattices)
        for (int kind = 0; kind < 48; ++kind) {
            const int main = kind % 3, slanted = (main + 1) % 3;
            const bool is_slanted = kind >= 24;
            for (int i = 0; i < 16; ++i) {
                rt_ray ray{{}, 0, {}, kReach};
                for (int k = 0; k < 3; ++k)
                    ray.direction[k] = kind / 3 >> (k == main ? 2 : k == slanted ? 1 : 0) & 1 ? -0.0f : 0.0f;
                ray.direction[main] = std::copysign(1.0f, ray.direction[main]);
                if (is_slanted) {
                    const float s = 0.2f + 0.6f * any();
                    ray.direction[slanted] = std::copysign(s, ray.direction[slanted]);
                    ray.direction[main] *= std::sqrt(1 - s * s);
                }
                // Through a corner, an edge or the middle of squares, from within, from near and from far away.
                const float away = i % 4 == 0 ? 0.0f : lattice.step * std::pow(10.0f, 1 + 4 * any());
                for (int k = 0; k < 3; ++k) {
                    float square = float(random() % unsigned(lattice.count + 1));
                    if (ray.direction[k] != 0 || random() % 5 == 0) square = float(lattice.count) * any();
                    ray.origin[k] = lattice.corner[k] + lattice.mirror[k] * lattice.step * square - away * ray.direction[k];
                }
                rays.push_back(ray);
            }
        }
    std::vector<rt_ray> mixed = rays;
    std::shuffle(mixed.begin(), mixed.end(), random);
    rays.insert(rays.end(), mixed.begin(), mixed.begin() + 2400);
    return rays;
}

// What a ray hits, by arithmetic in double precision: squares that share an edge leave no gap, so faces count as a whole.
struct PlaneTruth {
    double t = INFINITY;        // of the nearest face that is surely hit
    std::vector<double> maybe;  // of nearer ones whose border is within rounding
};
PlaneTruth truth_of(const std::vector<Face>& faces, const rt_ray& ray) {
    PlaneTruth truth;
    for (const Face& face : faces) {
        const int a = face.axis;
        if (ray.direction[a] == 0) continue;
        const double t = (face.lo[a] - ray.origin[a]) / ray.direction[a], error = 1e-6 * std::fabs(t);
        if (t < -1e-6 || t > ray.t_max) continue;
        bool certain = t > 1e-6, possible = true;
        for (const int k : {(a + 1) % 3, (a + 2) % 3}) {
            const double at = ray.origin[k] + t * ray.direction[k];
            const double slack = ray.direction[k] == 0 ? 0 : error + 1e-6 * std::fabs(ray.origin[k]);
            certain &= at >= face.lo[k] + slack && at <= face.hi[k] - slack;
            possible &= at >= face.lo[k] - slack && at <= face.hi[k] + slack;
        }
        if (certain) truth.t = std::min(truth.t, t);
        if (possible && !certain) truth.maybe.push_back(t);
    }
    return truth;
}

bool is_right(const PlaneTruth& truth, const rt_hit& hit, bool any_hit) {
    if (any_hit) return hit.t == 0 ? std::isfinite(truth.t) || !truth.maybe.empty() : !std::isfinite(truth.t);
    const double found = hit.prim < 0 ? INFINITY : double(hit.t);
    const auto is_at = [&](double t) { return found == t || std::fabs(found - t) <= 2e-6 * std::fabs(t) + 1e-6; };
    return is_at(truth.t) ||
           std::any_of(truth.maybe.begin(), truth.maybe.end(), [&](double t) { return t <= truth.t && is_at(t); });
}

Outcome trace_planes(HitStand& stand, const Step& step) {
    const std::vector<rt_ray>& rays = stand.set(kPlaneRays.name, step).rays;
    const std::vector<Face> faces = plane_faces();
    std::vector<PlaneTruth> truths;
    for (const rt_ray& ray : rays) truths.push_back(truth_of(faces, ray));
    return trace_passes(stand, rays, step, [&](const Pass& pass) {
        const std::vector<rt_hit>& hits = pass.traced.hits;
        size_t wrong = 0, first = 0;
        for (size_t i = rays.size(); i-- > 0;)
            if (!is_right(truths[i], hits[i], pass.any_hit)) ++wrong, first = i;
        if (wrong == 0) return Outcome::passed("");
        const std::string found = pass.any_hit           ? (hits[first].t == 0 ? "occluded" : "free")
                                  : hits[first].prim < 0 ? "nothing"
                                                         : "t " + exact_text(hits[first].t);
        return Outcome::failed(std::to_string(wrong) + " of " + std::to_string(rays.size()) +
                               " rays with a zero in their direction, which lie in planes of boxes, are wrong: the box test "
                               "loses them (the helpers of cl/lanes/rays.h do not). The first: ray " +
                               ray_text(rays[first]) + " -- found " + found + ", expected " +
                               (std::isfinite(truths[first].t) ? "t " + exact_text(float(truths[first].t)) : "nothing"));
    });
}

}  // namespace

Check planes_check(const StandInput& input) {
    static const TestScene scene{"a scene of floors and lattices", plane_scene, [](const BuildScene&, size_t, uint64_t) {
                                     RaySet set = kPlaneRays;
                                     set.rays = plane_rays();
                                     return std::vector<RaySet>{set};
                                 }};
    const auto stand = std::make_shared<HitStand>(input, scene);
    return {kPlaneRays.name, kPlaneRays.tried, [=](const Step& step) { return trace_planes(*stand, step); }};
}

}  // namespace clarity::check
