#include "tools/check/hits/brute_force.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/parallel_for.hpp"

namespace clarity::check {
namespace {

// Relative error of a coordinate that went through a few operations in single precision.
constexpr double kRounding = 1.5e-6;
constexpr double kInf = INFINITY;

double largest(const Vec& a) {
    return std::max({std::fabs(a[0]), std::fabs(a[1]), std::fabs(a[2])});
}

struct Ray {
    Vec o, d;
    double t_min, t_max;
    double length_d;  // of d
    double blur;      // distance by which rounding moves the ray, besides what the primitive's own coordinates add
};

// Where a ray passes a primitive: whether it is inside, and the distance to the nearest edge across the ray.
struct Passing {
    bool inside = false;
    double from_edge = 0;
    double t = 0, cosine = 0;  // of the angle between ray and normal
    double size = 0;           // largest coordinate
};

// A triangle that the ray meets or passes at its edge, where rounding decides. Together with its neighbours it may be sure to
// be hit.
struct AtEdge {
    size_t contact;  // its number
    Vec corners[3];
    double x[3], y[3];  // in the plane across the ray, which is at 0
};

// The plane across the ray, in two axes.
struct Across {
    Vec u, v;
    explicit Across(const Ray& ray) {
        const Vec w = (1 / ray.length_d) * ray.d;
        const Vec a = std::fabs(w[0]) < 0.6 ? Vec{1, 0, 0} : Vec{0, 1, 0};
        u = cross(w, a);
        u = (1 / length(u)) * u;
        v = cross(w, u);
    }
};

double segment_distance(double ax, double ay, double bx, double by) {  // from the origin
    const double dx = bx - ax, dy = by - ay, dd = dx * dx + dy * dy;
    const double s = dd > 0 ? std::clamp(-(ax * dx + ay * dy) / dd, 0.0, 1.0) : 0;
    return std::hypot(ax + s * dx, ay + s * dy);
}

// A flat face of any number of corners, by the even-odd rule in the plane across the ray.
Passing pass_face(const Ray& ray, const Across& across, const Vec* corners, size_t count, const Vec& normal, const Vec& point) {
    Passing p;
    p.from_edge = kInf;
    const auto flat = [&](const Vec& c) {
        return std::pair<double, double>{dot(c - ray.o, across.u), dot(c - ray.o, across.v)};
    };
    auto [ax, ay] = flat(corners[count - 1]);
    for (size_t i = 0; i < count; ++i) {
        const auto [bx, by] = flat(corners[i]);
        if ((ay > 0) != (by > 0) && ax + (bx - ax) * (0 - ay) / (by - ay) > 0) p.inside = !p.inside;
        p.from_edge = std::min(p.from_edge, segment_distance(ax, ay, bx, by));
        p.size = std::max(p.size, largest(corners[i]));
        ax = bx;
        ay = by;
    }
    const double facing = dot(normal, ray.d), n = length(normal);
    p.cosine = n > 0 ? std::fabs(facing) / (n * ray.length_d) : 0;
    p.t = facing != 0 ? dot(normal, point - ray.o) / facing : kInf;
    return p;
}

// How far rounding moves the ray at a face.
double blur_at(const Ray& ray, const Passing& p) {
    return ray.blur + kRounding * (p.size + std::min(std::fabs(p.t) * ray.length_d, 1e9));
}

bool is_within_limits(const Ray& ray, const Contact& contact) {
    return contact.t - contact.t_error > ray.t_min && contact.t + contact.t_error < ray.t_max &&
           contact.t - contact.t_error > 0;
}

// Judges the contact with a flat face. Returns whether only its edges leave in doubt that it is hit.
bool add_face(const Ray& ray, const Passing& p, Contact contact, std::vector<Contact>& contacts) {
    const double blur = blur_at(ray, p);
    if (!p.inside && p.from_edge > blur) return false;
    contact.t = p.t;
    contact.t_error = (p.cosine > 0 ? blur / p.cosine : kInf) / ray.length_d + kRelativeError * std::fabs(p.t);
    if (!(std::fabs(contact.t) < kInf)) contact.t = 0, contact.t_error = kInf;
    if (contact.t + contact.t_error < ray.t_min || contact.t - contact.t_error > ray.t_max) return false;
    const bool steep = p.cosine > 1e-3 && is_within_limits(ray, contact);
    contact.certain = steep && p.inside && p.from_edge > blur;
    contact.latest = contact.t + contact.t_error;
    contacts.push_back(contact);
    return steep && !contact.certain;
}

// Triangles at whose shared edge or corner a ray arrives are in doubt one by one. It is certain that one of them is hit if they
// surround the ray: each of their edges within `blur` has a triangle on either side. Traversals must keep all of them, and the
// test of triangles is watertight.
void close_sheets(std::vector<AtEdge>& at, double blur, std::vector<Contact>& contacts) {
    std::vector<size_t> sheet(at.size());
    std::vector<bool> open(at.size());
    for (size_t i = 0; i < at.size(); ++i) sheet[i] = i;
    const auto root = [&](size_t i) {
        while (sheet[i] != i) i = sheet[i];
        return i;
    };
    const auto side = [](const AtEdge& of, int a, int b, int c) {
        return (of.x[b] - of.x[a]) * (of.y[c] - of.y[a]) - (of.y[b] - of.y[a]) * (of.x[c] - of.x[a]);
    };
    for (size_t i = 0; i < at.size(); ++i)
        for (int e = 0; e < 3; ++e) {
            const AtEdge& own = at[i];
            const int a = e, b = (e + 1) % 3;
            if (segment_distance(own.x[a], own.y[a], own.x[b], own.y[b]) > blur) continue;
            const double own_side = side(own, a, b, (e + 2) % 3);
            bool shared = false;
            for (size_t j = 0; j < at.size(); ++j)
                for (int f = 0; f < 3; ++f)
                    for (const bool turned : {false, true}) {
                        const AtEdge& other = at[j];
                        const int p = turned ? (f + 1) % 3 : f, q = turned ? f : (f + 1) % 3;
                        if (j == i || other.corners[p] != own.corners[a] || other.corners[q] != own.corners[b]) continue;
                        if (side(other, p, q, (f + 2) % 3) * own_side >= 0) continue;
                        shared = true;
                        sheet[root(i)] = root(j);
                    }
            if (!shared) open[i] = true;
        }
    std::vector<bool> open_sheet(at.size());
    for (size_t i = 0; i < at.size(); ++i)
        if (open[i]) open_sheet[root(i)] = true;
    // Between two of them the ray may go through a third one that it only grazes: any of them may be the one that is hit.
    std::vector<double> latest(at.size());
    for (size_t i = 0; i < at.size(); ++i) latest[root(i)] = std::max(latest[root(i)], contacts[at[i].contact].latest);
    for (size_t i = 0; i < at.size(); ++i) {
        if (open_sheet[root(i)]) continue;
        contacts[at[i].contact].certain = true;
        contacts[at[i].contact].latest = latest[root(i)];
    }
}

// Whether a ray passes a triangle so closely that add_triangle() has to look.
bool may_meet(const Ray& ray, const Across& across, const Ball& ball) {
    const Vec from = ball.middle - ray.o;
    const double x = dot(from, across.u), y = dot(from, across.v);
    const double room = ball.reach + 4 * (ray.blur + kRounding * (ball.largest + ball.reach + length(from)));
    return x * x + y * y <= room * room;
}

// at_edge, blur: receive what close_sheets() needs.
void add_triangle(const Ray& ray, const Across& across, const rt_packed_prim& prim, Contact contact,
                  std::vector<Contact>& contacts, std::vector<AtEdge>& at_edge, double& blur) {
    const Vec corners[3] = {to_vec(prim.a), to_vec(prim.b), to_vec(prim.c)};
    const Vec normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    Passing p = pass_face(ray, across, corners, 3, normal, corners[0]);
    // A triangle without area, as far as rounding can tell, may be hit or not.
    const double edge =
        std::max({length(corners[1] - corners[0]), length(corners[2] - corners[1]), length(corners[0] - corners[2])});
    const bool slim = length(normal) <= 1e-5 * edge * edge || length(normal) <= 4 * edge * kRounding * p.size;
    if (slim) {
        p.inside = false;
        if (!(std::fabs(p.t) < kInf) || p.cosine < 1e-3) {
            const Vec middle = (1.0 / 3) * (corners[0] + corners[1] + corners[2]);
            p.t = dot(middle - ray.o, ray.d) / (ray.length_d * ray.length_d);
            p.cosine = 1;
            p.size += edge * 1e6;  // its distance may be anything along its edges
        }
    }
    if (!add_face(ray, p, contact, contacts) || slim) return;
    AtEdge at{contacts.size() - 1, {corners[0], corners[1], corners[2]}, {}, {}};
    for (int c = 0; c < 3; ++c) {
        at.x[c] = dot(corners[c] - ray.o, across.u);
        at.y[c] = dot(corners[c] - ray.o, across.v);
    }
    at_edge.push_back(at);
    blur = std::max(blur, blur_at(ray, p));
}

void add_polygon(const Ray& ray, const Across& across, const BuildScene& scene, const rt_packed_prim& prim, Contact contact,
                 std::vector<Contact>& contacts) {
    const rt_polygon& polygon = scene.polygon_table[RT_REF_INDEX(prim.ref)];
    std::vector<Vec> corners;
    for (rt_u32 i = 0; i < polygon.count; ++i) corners.push_back(to_vec(&scene.polygon_corners[3 * size_t(polygon.first + i)]));
    add_face(ray, pass_face(ray, across, corners.data(), corners.size(), to_vec(prim.a), to_vec(prim.b)), contact, contacts);
}

void add_sphere(const Ray& ray, const rt_packed_prim& prim, Contact contact, std::vector<Contact>& contacts) {
    const Vec center = to_vec(prim.a), from = center - ray.o;
    const double radius = prim.b[0], dd = ray.length_d * ray.length_d, middle = dot(from, ray.d) / dd;
    const double away = length(from - middle * ray.d);
    const double blur = ray.blur + kRounding * (largest(center) + radius + length(from));
    if (away > radius + blur) return;
    const double half = std::sqrt(std::max(radius * radius - away * away, 0.0)) / ray.length_d;
    const double cosine = std::max(half * ray.length_d / radius, 1e-9);
    contact.t_error = blur / cosine / ray.length_d + kRelativeError * std::fabs(middle);
    if (away > radius - blur)
        contact.t_error = std::max(contact.t_error, half + std::sqrt(2 * radius * blur + blur * blur) / ray.length_d * 2);
    const double least = std::max(ray.t_min, 0.0), near = middle - half, far = middle + half;
    // The near side counts from t_min on, else the far side. Close to that limit either may be the answer.
    const bool surely_near = near - contact.t_error > least, surely_far = near + contact.t_error < least;
    for (const bool is_far : {false, true}) {
        if (is_far ? surely_near : surely_far) continue;
        contact.t = is_far ? far : near;
        if (contact.t + contact.t_error < least || contact.t - contact.t_error > ray.t_max) continue;
        contact.certain = away < radius - blur && (is_far ? surely_far : surely_near) && contact.t - contact.t_error > least &&
                          contact.t + contact.t_error < ray.t_max;
        contact.latest = contact.t + contact.t_error;
        contacts.push_back(contact);
    }
}

// Whether a ray passes a box closely enough to meet what is in it. Most instances are far from the ray.
bool may_enter(const Ray& ray, const rt_prim& box) {
    Vec middle;
    double reach = 0;
    for (int k = 0; k < 3; ++k) {
        middle[k] = 0.5 * (double(box.lo[k]) + box.hi[k]);
        reach += 0.25 * (double(box.hi[k]) - box.lo[k]) * (double(box.hi[k]) - box.lo[k]);
    }
    const Vec from = middle - ray.o;
    const double along = dot(from, ray.d) / (ray.length_d * ray.length_d), away = length(from - along * ray.d);
    return away <= std::sqrt(reach) * 1.001 + 8 * (ray.blur + kRounding * (largest(middle) + length(from)));
}

}  // namespace

const Contact* Truth::nearest_certain() const {
    for (const Contact& contact : contacts)
        if (contact.certain) return &contact;
    return nullptr;
}

double Truth::latest() const {
    double least = kInf;
    for (const Contact& contact : contacts)
        if (contact.certain) least = std::min(least, contact.latest);
    return least;
}

BruteForce::BruteForce(const BuildScene& scene) : scene_(scene) {
    balls_.reserve(scene.triangles.size());
    for (const rt_packed_prim& t : scene.triangles) {
        const Vec a = to_vec(t.a), b = to_vec(t.b), c = to_vec(t.c), middle = (1.0 / 3) * (a + b + c);
        balls_.push_back({middle, std::max({length(a - middle), length(b - middle), length(c - middle)}), largest(middle)});
    }
}

Truth BruteForce::trace(const rt_ray& given) const {
    Truth truth;
    Ray ray{to_vec(given.origin), to_vec(given.direction), given.t_min, given.t_max, 0, 0};
    ray.length_d = length(ray.d);
    ray.blur = kRounding * largest(ray.o);
    const Across across(ray);
    std::vector<AtEdge> at_edge;
    double blur = 0;
    // first: what is added to the primitive's number.
    const auto add = [&](const Ray& r, const Across& a, rt_u32 ref, rt_u32 first, rt_i32 instance) {
        const rt_u32 kind = RT_REF_KIND(ref), index = RT_REF_INDEX(ref);
        if (kind == RT_REF_TRIANGLE && !may_meet(r, a, balls_[index])) return;
        const rt_packed_prim& prim = kind == RT_REF_TRIANGLE ? scene_.triangles[index]
                                     : kind == RT_REF_SPHERE ? scene_.spheres[index]
                                                             : scene_.polygons[index];
        Contact contact;
        contact.prim = static_cast<rt_i32>(first + prim.prim);
        contact.instance = instance;
        contact.ref = prim.ref;
        if (kind == RT_REF_TRIANGLE)
            add_triangle(r, a, prim, contact, truth.contacts, at_edge, blur);
        else if (kind == RT_REF_SPHERE)
            add_sphere(r, prim, contact, truth.contacts);
        else
            add_polygon(r, a, scene_, prim, contact, truth.contacts);
    };
    const auto close = [&] {
        close_sheets(at_edge, blur, truth.contacts);
        at_edge.clear();
        blur = 0;
    };
    const rt_group& world = scene_.groups[0];
    for (rt_u32 i = world.first; i < world.first + world.count; ++i) {
        const rt_u32 ref = scene_.prims[i].ref;
        if (RT_REF_KIND(ref) != RT_REF_INSTANCE) add(ray, across, ref, 0, -1);
    }
    close();
    for (rt_u32 i = world.first; i < world.first + world.count; ++i) {
        const rt_u32 ref = scene_.prims[i].ref;
        if (RT_REF_KIND(ref) != RT_REF_INSTANCE || !may_enter(ray, scene_.prims[i])) continue;
        const rt_u32 index = RT_REF_INDEX(ref);
        const rt_instance& instance = scene_.instances[index];
        if (instance.hidden == RT_NONE) continue;
        const float* m = instance.object_from_world;
        const auto turned = [&](const Vec& v) {
            return Vec{m[0] * v[0] + m[1] * v[1] + m[2] * v[2], m[4] * v[0] + m[5] * v[1] + m[6] * v[2],
                       m[8] * v[0] + m[9] * v[1] + m[10] * v[2]};
        };
        Ray inner = ray;
        const Vec moved = turned(ray.o);
        inner.o = moved + Vec{m[3], m[7], m[11]};
        inner.d = turned(ray.d);
        inner.length_d = length(inner.d);
        double norm = 0;
        for (int r = 0; r < 3; ++r)
            norm = std::max(norm, double(std::fabs(m[4 * r]) + std::fabs(m[4 * r + 1]) + std::fabs(m[4 * r + 2])));
        inner.blur = kRounding * (norm * largest(ray.o) +
                                  double(std::max({std::fabs(m[3]), std::fabs(m[7]), std::fabs(m[11])})) + largest(inner.o));
        // Directions are rounded, too, which counts over the whole way to the object.
        inner.blur += kRounding * length(inner.o);
        const Across inner_across(inner);
        const rt_group& group = scene_.groups[scene_.group_of_instance[index]];
        for (rt_u32 k = group.first; k < group.first + group.count; ++k)
            add(inner, inner_across, scene_.prims[k].ref, instance.first_prim, static_cast<rt_i32>(index));
        close();
    }
    std::sort(truth.contacts.begin(), truth.contacts.end(), [](const Contact& a, const Contact& b) { return a.t < b.t; });
    return truth;
}

std::vector<Truth> BruteForce::trace(const std::vector<rt_ray>& rays) const {
    std::vector<Truth> truths(rays.size());
    constexpr size_t kChunk = 16;
    parallel_for(static_cast<uint32_t>((rays.size() + kChunk - 1) / kChunk), [&](uint32_t c) {
        for (size_t i = c * kChunk; i < std::min(rays.size(), (c + 1) * kChunk); ++i) truths[i] = trace(rays[i]);
    });
    return truths;
}

}  // namespace clarity::check
