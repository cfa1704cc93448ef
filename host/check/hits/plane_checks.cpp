#include "check/hits/plane_checks.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "base/numbers.hpp"
#include "check/hits/checked_scene.hpp"
#include "check/scenes.hpp"
#include "render/tracers/rays/ray_text.hpp"

namespace clarity::check {
namespace {

constexpr double kPlanesCompile_s = 120, kPlanesTrace_s = 10;
constexpr float kReach = 1e6f;  // t_max: beyond all faces, and before what only makes the programs those of the mixed scene

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

class PlaneScene {
 public:
    PlaneScene() {
        scene.materials.push_back({"default", default_material()});
        const Lattice* placed = nullptr;
        for (const Lattice& lattice : kLattices) {
            if (!lattice.is_instance || !placed) add_squares(lattice);
            if (lattice.is_instance) placed = &lattice;
            place(lattice);
            add_faces(lattice);
        }
        // Out of reach: a sphere and a polygon, so that kernels are compiled for the same kinds as for the mixed scene.
        scene.spheres.push_back({{3e6f, 3e6f, 3e6f}, 1, 0});
        scene.polygons.push_back({0, 3, 0});
        for (const float c : {3e6f, 3e6f, -3e6f, 3e6f, 3.1e6f, -3e6f, 3.1e6f, 3e6f, -3e6f}) scene.polygon_corners.push_back(c);
    }
    Scene scene;
    std::vector<Face> faces;

 private:
    static double edge(const Lattice& lattice, int axis, int i) {
        return double(lattice.corner[axis]) + double(lattice.mirror[axis]) * lattice.step * i;
    }
    void add_squares(const Lattice& lattice) {
        Mesh mesh;
        mesh.first_vertex = scene.vertex_count();
        mesh.first_triangle = scene.triangle_count();
        for (const char* plane = lattice.planes; *plane; ++plane) {
            const int a = *plane - 'x', u = (a + 1) % 3, v = (a + 2) % 3, layers = lattice.planes[1] ? lattice.count + 1 : 1;
            for (int layer = 0; layer < layers; ++layer)
                for (int i = 0; i < lattice.count; ++i)
                    for (int j = 0; j < lattice.count; ++j)
                        for (const int corner : {0, 1, 3, 0, 3, 2}) {
                            float p[3];
                            p[a] = float(layer), p[u] = float(i + (corner & 1)), p[v] = float(j + (corner >> 1));
                            for (int k = 0; k < 3; ++k)
                                p[k] = (lattice.is_instance ? 0 : lattice.corner[k]) + lattice.step * p[k];
                            scene.triangles.push_back(scene.vertex_count());
                            scene.positions.append(p, p + 3);
                        }
        }
        mesh.vertex_count = scene.vertex_count() - mesh.first_vertex;
        mesh.triangle_count = mesh.polygon_count = scene.triangle_count() - mesh.first_triangle;
        while (scene.triangle_materials.size() < scene.triangle_count()) scene.triangle_materials.push_back(0);
        scene.meshes.push_back(mesh);
    }
    void place(const Lattice& lattice) {
        Instance instance;
        instance.mesh = static_cast<rt_u32>(scene.meshes.size() - 1);
        for (int k = 0; lattice.is_instance && k < 3; ++k) {
            instance.world_from_object[5 * k] = lattice.mirror[k];
            instance.world_from_object[4 * k + 3] = lattice.corner[k];
        }
        scene.instances.push_back(instance);
    }
    void add_faces(const Lattice& lattice) {
        for (const char* plane = lattice.planes; *plane; ++plane) {
            const int a = *plane - 'x', layers = lattice.planes[1] ? lattice.count + 1 : 1;
            for (int layer = 0; layer < layers; ++layer) {
                Face face{a, {}, {}};
                for (int k = 0; k < 3; ++k) {
                    const double begin = edge(lattice, k, k == a ? layer : 0),
                                 end = edge(lattice, k, k == a ? layer : lattice.count);
                    face.lo[k] = std::min(begin, end), face.hi[k] = std::max(begin, end);
                }
                faces.push_back(face);
            }
        }
    }
};

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

Outcome trace_planes(const rt_plugin& plugin, const rt_plugin* layout, const std::function<std::shared_ptr<Device>()>& open,
                     HitsOptions options, const Step& step) {
    step("opening the device", kPlanesCompile_s);
    const std::shared_ptr<Device> device = open();
    fit_lanes(options, device->info());
    // Quick checks compile few programs: this scene's trees are less deep than the mixed one's, so its programs may differ.
    if (options.quick && !options.lanes_are_named && options.lanes.size() > 2)
        options.lanes = {options.lanes.front(), options.lanes.back()};
    step("building a scene of floors and lattices", kPlanesCompile_s);
    PlaneScene planes;
    CheckedScene scene(plugin, layout, std::move(planes.scene), device);
    const std::vector<rt_ray> rays = plane_rays();
    std::vector<PlaneTruth> truths;
    for (const rt_ray& ray : rays) truths.push_back(truth_of(planes.faces, ray));
    for (const int lanes : options.lanes)
        for (const bool any_hit : {false, true}) {
            const Variant variant{lanes, true, false};  // programs that other checks have too
            const std::string what = std::string(any_hit ? "any-hit queries" : "nearest hits") + " with " + variant.text();
            step("compiling for " + variant.text(), kPlanesCompile_s);
            scene.compile(variant);
            step("tracing rays along planes, " + what, kPlanesTrace_s);
            const std::vector<rt_hit> hits = scene.trace(variant, rays, any_hit).hits;
            size_t wrong = 0, first = 0;
            for (size_t i = rays.size(); i-- > 0;)
                if (!is_right(truths[i], hits[i], any_hit)) ++wrong, first = i;
            if (wrong == 0) continue;
            const std::string found = any_hit                ? (hits[first].t == 0 ? "occluded" : "free")
                                      : hits[first].prim < 0 ? "nothing"
                                                             : "t " + exact_text(hits[first].t);
            return Outcome::failed(
                what + ": " + std::to_string(wrong) + " of " + std::to_string(rays.size()) +
                " rays with a zero in their direction, which lie in planes of boxes, are wrong: the box test "
                "loses them (the helpers of cl/lanes/rays.h do not). The first: ray " +
                ray_text(rays[first]) + " -- found " + found + ", expected " +
                (std::isfinite(truths[first].t) ? "t " + exact_text(float(truths[first].t)) : "nothing"));
        }
    return Outcome::passed(std::to_string(rays.size()) + " rays, nearest and any, are right with " +
                           std::to_string(options.lanes.size()) + " programs");
}

}  // namespace

Check planes_check(const rt_plugin& plugin, const rt_plugin* layout, const std::function<std::shared_ptr<Device>()>& open,
                   const HitsOptions& options) {
    return {"hits.planes", "rays exactly in planes of boxes, with directions that have zeros of either sign",
            [=, &plugin](const Step& step) { return trace_planes(plugin, layout, open, options, step); }};
}

}  // namespace clarity::check
