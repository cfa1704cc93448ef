#include "reference/world.hpp"

#include <algorithm>

namespace clarity::reference {

struct World::Triangle {
    Vec normal, middle;
    Vec n[3];  // normals of the corners, if `smooth`
    Vec along_u, along_v;
    bool smooth;  // the corners have normals
    unsigned material;
};

struct World::Node {
    Vec lo{INFINITY, INFINITY, INFINITY}, hi{-INFINITY, -INFINITY, -INFINITY};
    unsigned first = 0, end = 0;   // leaf: range of order_
    unsigned left = 0, right = 0;  // inner node: its children
};

namespace {

// Normals are transformed with the cofactors of the matrix, which are its transposed inverse times its determinant.
Vec apply_to_normal(const Affine& m, const Vec& n) {
    const Vec x{m[0], m[4], m[8]}, y{m[1], m[5], m[9]}, z{m[2], m[6], m[10]};
    const Vec turned = n[0] * cross(y, z) + n[1] * cross(z, x) + n[2] * cross(x, y);
    return dot(x, cross(y, z)) < 0 ? -1 * turned : turned;
}

}  // namespace

World::World(const Scene& scene) : scene_(scene), primitives_(scene) {
    for (const Instance& instance : scene.instances) add_instance(instance);
    if (!order_.empty()) build(0, static_cast<unsigned>(order_.size()));
}
World::~World() = default;

void World::add_instance(const Instance& instance) {
    const Mesh& mesh = scene_.meshes[instance.mesh];
    for (unsigned i = mesh.first_triangle; i < mesh.first_triangle + mesh.triangle_count; ++i) {
        const int prim = static_cast<int>(triangles_.size());
        Triangle t{};
        Vec corner[3];
        t.smooth = !scene_.normals.empty();
        for (int k = 0; k < 3; ++k) {
            const unsigned v = scene_.triangles[3 * i + k];
            corner[k] = to_vec(&scene_.positions[3 * v]);
            if (t.smooth) t.n[k] = apply_to_normal(instance.world_from_object, to_vec(&scene_.normals[3 * v]));
            t.middle = t.middle + (1.0 / 3) * to_vec(primitives_.corners(prim) + 3 * k);
        }
        t.smooth = t.smooth && length(t.n[0]) > 0;
        if (!scene_.uvs.empty()) {
            const auto from_first = [&](int k) {
                return to_vec(primitives_.corners(prim) + 3 * k) - to_vec(primitives_.corners(prim));
            };
            const auto uv = [&](int k, int axis) {
                const auto at = [&](int corner_k) { return double(scene_.uvs[2 * scene_.triangles[3 * i + corner_k] + axis]); };
                return at(k) - at(0);
            };
            const double area = uv(1, 0) * uv(2, 1) - uv(2, 0) * uv(1, 1);
            if (area != 0) {
                t.along_u = 1 / area * (uv(2, 1) * from_first(1) - uv(1, 1) * from_first(2));
                t.along_v = 1 / area * (uv(1, 0) * from_first(2) - uv(2, 0) * from_first(1));
            }
        }
        t.normal = apply_to_normal(instance.world_from_object, cross(corner[1] - corner[0], corner[2] - corner[0]));
        t.material = instance.material != RT_NONE ? instance.material : scene_.triangle_materials[i];
        if (length(t.normal) > 0) order_.push_back(prim);
        triangles_.push_back(t);
    }
}

unsigned World::build(unsigned first, unsigned end) {
    const unsigned at = static_cast<unsigned>(nodes_.size());
    nodes_.emplace_back();
    Node node;
    for (unsigned i = first; i < end; ++i)
        for (int c = 0; c < 9; ++c) {
            const double p = primitives_.corners(order_[i])[c];
            node.lo[c % 3] = std::fmin(node.lo[c % 3], p);
            node.hi[c % 3] = std::fmax(node.hi[c % 3], p);
        }
    const Vec size = node.hi - node.lo;
    const auto axis = static_cast<size_t>(std::max_element(size.begin(), size.end()) - size.begin());
    node.first = first;
    node.end = end;
    if (end - first > 4) {
        const unsigned middle = (first + end) / 2;
        std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + end,
                         [&](int a, int b) { return triangles_[a].middle[axis] < triangles_[b].middle[axis]; });
        node.left = build(first, middle);
        node.right = build(middle, end);
    }
    nodes_[at] = node;
    return at;
}

test::Truth World::nearest(const Ray& ray) const {
    test::Truth best = primitives_.nearest(ray, primitives_.triangle_count());
    unsigned stack[64], top = 0;
    if (!nodes_.empty()) stack[top++] = 0;
    while (top > 0) {
        const Node& node = nodes_[stack[--top]];
        double enter = 0, leave = std::fmin(best.t, ray.t_max);
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
            const double t = primitives_.distance(order_[i], ray, 1e-12);
            if (t > 0 && t < best.t) best = {t, order_[i]};
        }
    }
    return best;
}

bool World::nearest(const Ray& ray, Hit& hit) const {
    const test::Truth best = nearest(ray);
    if (!best.hit()) return false;
    hit.t = best.t;
    auto i = static_cast<size_t>(best.prim);
    if (i < triangles_.size()) {
        const Triangle& triangle = triangles_[i];
        hit.geometric = hit.shading = normalized(triangle.normal);
        hit.material = triangle.material;
        hit.along_u = triangle.along_u;
        hit.along_v = triangle.along_v;
        if (!triangle.smooth) return true;
        double weight[2];
        test::hit_triangle(primitives_.corners(best.prim), ray, 1e-12, weight);
        hit.shading =
            normalized((1 - weight[0] - weight[1]) * triangle.n[0] + weight[0] * triangle.n[1] + weight[1] * triangle.n[2]);
        if (dot(hit.shading, hit.geometric) < 0) hit.shading = -1 * hit.shading;
        return true;
    }
    const auto flat = [&](const Vec& normal, unsigned material) {
        hit.geometric = hit.shading = normalized(normal);
        hit.material = material;
        return true;
    };
    if ((i -= triangles_.size()) < scene_.spheres.size())
        return flat(ray.at(hit.t) - to_vec(scene_.spheres[i].center), scene_.spheres[i].material);
    if ((i -= scene_.spheres.size()) < scene_.polygons.size())
        return flat(primitives_.polygon_normal(scene_.polygons[i]), scene_.polygons[i].material);
    i -= scene_.polygons.size();
    return flat(to_vec(scene_.planes[i].normal), scene_.planes[i].material);
}

double World::offset(const Vec& at) const {
    return 1e-7 * (1 + std::fmax(std::fabs(at[0]), std::fmax(std::fabs(at[1]), std::fabs(at[2]))));
}

}  // namespace clarity::reference
