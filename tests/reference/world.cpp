#include "world.hpp"

#include <algorithm>

namespace clarity::reference {

struct World::Triangle {
    Vec a, b, c;
    Vec normal;   // not unit length
    Vec n[3];     // normals of the corners, if `smooth`
    bool smooth;  // the corners have normals
    unsigned material;
    Vec middle() const { return (1.0 / 3) * (a + b + c); }
};

struct World::Node {
    Vec lo{INFINITY, INFINITY, INFINITY}, hi{-INFINITY, -INFINITY, -INFINITY};
    unsigned first = 0, end = 0;   // leaf: range of triangles
    unsigned left = 0, right = 0;  // inner node: its children
};

namespace {

void grow(Vec& lo, Vec& hi, Vec p) {
    lo = {std::fmin(lo.x, p.x), std::fmin(lo.y, p.y), std::fmin(lo.z, p.z)};
    hi = {std::fmax(hi.x, p.x), std::fmax(hi.y, p.y), std::fmax(hi.z, p.z)};
}

Vec apply(const Affine& m, Vec p, double w) {
    return {m[0] * p.x + m[1] * p.y + m[2] * p.z + w * m[3], m[4] * p.x + m[5] * p.y + m[6] * p.z + w * m[7],
            m[8] * p.x + m[9] * p.y + m[10] * p.z + w * m[11]};
}

// Normals are transformed with the cofactors of the matrix, which are its transposed inverse times its determinant.
Vec apply_to_normal(const Affine& m, Vec n) {
    const Vec x{m[0], m[4], m[8]}, y{m[1], m[5], m[9]}, z{m[2], m[6], m[10]};
    const Vec turned = n.x * cross(y, z) + n.y * cross(z, x) + n.z * cross(x, y);
    return dot(x, cross(y, z)) < 0 ? -turned : turned;
}

// Solves the quadratic equation, as in Glassner (ed.) 1989, An Introduction to Ray Tracing, chapter 2.
void try_sphere(const Sphere& sphere, const Ray& ray, Hit& hit) {
    const Vec center = vec_of(sphere.center), from = ray.origin - center;
    const double b = dot(from, ray.direction), c = dot(from, from) - double(sphere.radius) * sphere.radius;
    const double discriminant = b * b - c;
    if (discriminant < 0) return;
    const double root = std::sqrt(discriminant);
    const double t = -b - root > 0 ? -b - root : -b + root;
    if (t <= 0 || t >= hit.t) return;
    hit.t = t;
    hit.geometric = hit.shading = normalize(from + t * ray.direction);
    hit.material = sphere.material;
}

void try_plane(const Plane& plane, const Ray& ray, Hit& hit) {
    const Vec normal = vec_of(plane.normal);
    const double t = (plane.offset - dot(normal, ray.origin)) / dot(normal, ray.direction);
    if (!(t > 0 && t < hit.t)) return;
    hit.t = t;
    hit.geometric = hit.shading = normalize(normal);
    hit.material = plane.material;
}

// Intersects the polygon's plane, then counts crossings in the projection along the normal's largest axis.
void try_polygon(const Scene& scene, const Polygon& polygon, const Ray& ray, Hit& hit) {
    const auto corner = [&](unsigned i) {
        return vec_of(&scene.polygon_corners[3 * (polygon.first_corner + i % polygon.corner_count)]);
    };
    Vec normal;
    for (unsigned i = 1; i + 1 < polygon.corner_count; ++i)
        normal = normal + cross(corner(i) - corner(0), corner(i + 1) - corner(0));
    const double t = dot(normal, corner(0) - ray.origin) / dot(normal, ray.direction);
    if (!(t > 0 && t < hit.t)) return;
    const Vec p = ray.origin + t * ray.direction;
    int drop = 0;
    for (int axis = 1; axis < 3; ++axis)
        if (std::fabs(normal[axis]) > std::fabs(normal[drop])) drop = axis;
    const int u = (drop + 1) % 3, v = (drop + 2) % 3;
    bool inside = false;
    for (unsigned i = 0; i < polygon.corner_count; ++i) {
        const Vec a = corner(i), b = corner(i + 1);
        if ((a[v] > p[v]) != (b[v] > p[v]) && p[u] < a[u] + (p[v] - a[v]) / (b[v] - a[v]) * (b[u] - a[u])) inside = !inside;
    }
    if (!inside) return;
    hit.t = t;
    hit.geometric = hit.shading = normalize(normal);
    hit.material = polygon.material;
}

}  // namespace

World::World(const Scene& scene) : scene_(scene) {
    for (const Instance& instance : scene.instances) add_instance(scene, instance);
    if (!triangles_.empty()) build(0, static_cast<unsigned>(triangles_.size()));
}
World::~World() = default;

void World::add_instance(const Scene& scene, const Instance& instance) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    for (unsigned i = mesh.first_triangle; i < mesh.first_triangle + mesh.triangle_count; ++i) {
        Triangle t{};
        Vec corner[3];
        t.smooth = !scene.normals.empty();
        for (int k = 0; k < 3; ++k) {
            const unsigned v = scene.triangles[3 * i + k];
            corner[k] = vec_of(&scene.positions[3 * v]);
            if (t.smooth) t.n[k] = apply_to_normal(instance.world_from_object, vec_of(&scene.normals[3 * v]));
        }
        t.smooth = t.smooth && length(t.n[0]) > 0;
        t.normal = apply_to_normal(instance.world_from_object, cross(corner[1] - corner[0], corner[2] - corner[0]));
        t.a = apply(instance.world_from_object, corner[0], 1);
        t.b = apply(instance.world_from_object, corner[1], 1);
        t.c = apply(instance.world_from_object, corner[2], 1);
        t.material = instance.material != RT_NONE ? instance.material : scene.triangle_materials[i];
        if (length(t.normal) > 0) triangles_.push_back(t);
    }
}

unsigned World::build(unsigned first, unsigned end) {
    const unsigned at = static_cast<unsigned>(nodes_.size());
    nodes_.emplace_back();
    Node node;
    for (unsigned i = first; i < end; ++i)
        for (const Vec& p : {triangles_[i].a, triangles_[i].b, triangles_[i].c}) grow(node.lo, node.hi, p);
    const Vec size = node.hi - node.lo;
    const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    node.first = first;
    node.end = end;
    if (end - first > 4) {
        const unsigned middle = (first + end) / 2;
        std::nth_element(triangles_.begin() + first, triangles_.begin() + middle, triangles_.begin() + end,
                         [axis](const Triangle& a, const Triangle& b) { return a.middle()[axis] < b.middle()[axis]; });
        node.left = build(first, middle);
        node.right = build(middle, end);
    }
    nodes_[at] = node;
    return at;
}

void World::try_triangles(const Ray& ray, Hit& hit) const {
    unsigned stack[64], top = 0;
    if (!nodes_.empty()) stack[top++] = 0;
    while (top > 0) {
        const Node& node = nodes_[stack[--top]];
        double enter = 0, leave = hit.t;
        for (int axis = 0; axis < 3; ++axis) {
            const double inverse = 1 / ray.direction[axis];
            const double a = (node.lo[axis] - 1e-9 - ray.origin[axis]) * inverse,
                         b = (node.hi[axis] + 1e-9 - ray.origin[axis]) * inverse;
            enter = std::fmax(enter, std::fmin(a, b));  // fmin and fmax ignore NaN
            leave = std::fmin(leave, std::fmax(a, b));
        }
        if (enter > leave) continue;
        if (node.right != 0) {
            stack[top++] = node.left;
            stack[top++] = node.right;
            continue;
        }
        for (unsigned i = node.first; i < node.end; ++i) {
            const Triangle& tri = triangles_[i];
            const double t = dot(tri.normal, tri.a - ray.origin) / dot(tri.normal, ray.direction);
            if (!(t > 0 && t < hit.t)) continue;
            // Barycentric coordinates: the areas of the three parts, with the sign that the normal gives.
            const Vec p = ray.origin + t * ray.direction, plain = cross(tri.b - tri.a, tri.c - tri.a);
            const double whole = dot(plain, plain);
            const double u = dot(cross(tri.c - tri.b, p - tri.b), plain) / whole,
                         v = dot(cross(tri.a - tri.c, p - tri.c), plain) / whole;
            const double w = 1 - u - v;
            if (u < -1e-12 || v < -1e-12 || w < -1e-12) continue;
            hit.t = t;
            hit.geometric = hit.shading = normalize(tri.normal);
            if (tri.smooth) {
                hit.shading = normalize(u * tri.n[0] + v * tri.n[1] + w * tri.n[2]);
                if (dot(hit.shading, hit.geometric) < 0) hit.shading = -hit.shading;
            }
            hit.material = tri.material;
        }
    }
}

bool World::nearest(const Ray& ray, double limit, Hit& hit) const {
    hit.t = limit;
    for (const Plane& plane : scene_.planes) try_plane(plane, ray, hit);
    for (const Sphere& sphere : scene_.spheres) try_sphere(sphere, ray, hit);
    for (const Polygon& polygon : scene_.polygons) try_polygon(scene_, polygon, ray, hit);
    try_triangles(ray, hit);
    return hit.t < limit;
}

bool World::blocked(const Ray& ray, double limit) const {
    Hit hit;
    return nearest(ray, limit, hit);
}

double World::offset(Vec at) const {
    return 1e-7 * (1 + std::fmax(std::fabs(at.x), std::fmax(std::fabs(at.y), std::fabs(at.z))));
}

}  // namespace clarity::reference
