#include "structures/build_scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <mutex>

#include "base/error.hpp"
#include "base/parallel_for.hpp"
#include "clarity_bvh/base/rounding.hpp"
#include "scene/motion/matrix.hpp"
#include "structures/memory_plan.hpp"
#include "structures/rows.hpp"

namespace clarity {
namespace {

constexpr uint32_t kChunk = 1u << 10;  // triangles that one task copies
constexpr uint32_t kAhead = 32;        // how many elements ahead memory is prefetched for writing

rt_prim empty_prim(rt_u32 ref, rt_u32 mesh) {
    rt_prim prim;
    for (int k = 0; k < 3; ++k) {
        prim.lo[k] = INFINITY;
        prim.hi[k] = -INFINITY;
    }
    prim.ref = ref;
    prim.mesh = mesh;
    return prim;
}

void grow(Bounds& bounds, const rt_prim& prim) {
    bounds.add(prim.lo);
    bounds.add(prim.hi);
}

void add(const Bounds& box, Bounds& to) {
    if (box.empty) return;
    to.add(box.min.data());
    to.add(box.max.data());
}

void grow(rt_prim& prim, const float* p) {
    for (int k = 0; k < 3; ++k) {
        prim.lo[k] = std::min(prim.lo[k], p[k]);
        prim.hi[k] = std::max(prim.hi[k], p[k]);
    }
}

// Enlarges a box by a relative margin for rounding, since kernels compute with its contents in another order.
void widen(rt_prim& prim, float relative) {
    for (int k = 0; k < 3; ++k) {
        const float room = relative * std::max(std::fabs(prim.lo[k]), std::fabs(prim.hi[k]));
        prim.lo[k] -= room;
        prim.hi[k] += room;
    }
}

// Writes the triangles of one mesh as refs from first_ref on, transformed unless `world` is nullptr. Returns their bounds.
Bounds add_triangles(const Scene& scene, const Mesh& mesh, const Affine* world, rt_u32 material, rt_u32 first_prim,
                     rt_u32 first_ref, rt_u32 run, uint64_t prim_at, BuildScene& out) {
    const uint32_t chunks = (mesh.triangle_count + kChunk - 1) / kChunk;
    Bounds bounds;
    std::mutex bounds_mutex;
    parallel_for(chunks, [&](uint32_t chunk) {
        const rt_u32 begin = chunk * kChunk, end = std::min(mesh.triangle_count, begin + kChunk);
        const float* const positions = scene.positions.data();
        const rt_u32* const vertices = scene.triangles.data() + 3 * (size_t(mesh.first_triangle) + begin);
        const rt_u32* const materials = scene.triangle_materials.data() + mesh.first_triangle + begin;
        rt_packed_prim* const leaves = out.triangles.data() + first_ref + begin;
        rt_prim* const prims = out.prims.data() + prim_at + begin;
        rt_u32* const sources = out.attribute_triangle.data() + first_ref + begin;
        Row all_lo = {INFINITY, INFINITY, INFINITY, INFINITY}, all_hi = -all_lo;
        for (rt_u32 i = 0; i < end - begin; ++i) {
            __builtin_prefetch(leaves + i + kAhead, 1);
            __builtin_prefetch(prims + i + kAhead, 1);
            // Made in registers and stored as a whole. The compiler cannot know that stores do not change the input.
            const rt_u32 meta[3] = {RT_REF_TRIANGLE | (first_ref + begin + i), material != RT_NONE ? material : materials[i],
                                    first_prim + begin + i};
            Row corner[3];
            for (int c = 0; c < 3; ++c) {
                const float* const position = positions + 3 * size_t(vertices[3 * size_t(i) + c]);
                if (world) {
                    const auto p = transform_point(*world, position);
                    corner[c] = Row{p[0], p[1], p[2], 0};
                } else {
                    corner[c] = Row{position[0], position[1], position[2], 0};
                }
            }
            Row lo = corner[1] < corner[0] ? corner[1] : corner[0], hi = corner[0] < corner[1] ? corner[1] : corner[0];
            lo = corner[2] < lo ? corner[2] : lo;
            hi = hi < corner[2] ? corner[2] : hi;
            all_lo = lo < all_lo ? lo : all_lo;
            all_hi = all_hi < hi ? hi : all_hi;
            const Row leaf[3] = {named(corner[0], meta[0]), named(corner[1], meta[1]), named(corner[2], meta[2])},
                      prim[2] = {named(lo, meta[0]), named(hi, run)};
            std::memcpy(&leaves[i], leaf, sizeof leaf);
            std::memcpy(&prims[i], prim, sizeof prim);
            sources[i] = mesh.first_triangle + begin + i;
        }
        const std::lock_guard<std::mutex> lock(bounds_mutex);
        bounds.add(reinterpret_cast<const float*>(&all_lo));
        bounds.add(reinterpret_cast<const float*>(&all_hi));
    });
    return bounds;
}

void add_spheres(const Scene& scene, rt_u32 run, rt_u32 first_prim, uint64_t& at, BuildScene& out) {
    for (size_t i = 0; i < scene.spheres.size(); ++i) {
        const Sphere& sphere = scene.spheres[i];
        rt_packed_prim leaf{};
        leaf.ref = RT_REF_SPHERE | static_cast<rt_u32>(i);
        std::memcpy(leaf.a, sphere.center.data(), sizeof leaf.a);
        leaf.b[0] = sphere.radius;
        leaf.material = sphere.material;
        leaf.prim = first_prim + static_cast<rt_u32>(i);
        rt_prim prim = box_of(out, leaf);
        prim.mesh = run;
        grow(out.bounds, prim);
        out.spheres.push_back(leaf);
        out.prims[at++] = prim;
    }
}

void add_polygons(const Scene& scene, rt_u32 run, rt_u32 first_prim, uint64_t& at, BuildScene& out) {
    for (size_t i = 0; i < scene.polygons.size(); ++i) {
        const Polygon& polygon = scene.polygons[i];
        const float* corners = &scene.polygon_corners[3 * size_t(polygon.first_corner)];
        // Newell's normal and the centroid give the plane that fits best if the corners are not exactly in a plane.
        double normal[3] = {}, centroid[3] = {};
        for (rt_u32 c = 0; c < polygon.corner_count; ++c) {
            const float *p = corners + 3 * c, *q = corners + 3 * ((c + 1) % polygon.corner_count);
            for (int k = 0; k < 3; ++k) {
                const int a = (k + 1) % 3, b = (k + 2) % 3;
                normal[k] += (double(p[a]) - q[a]) * (double(p[b]) + q[b]);
                centroid[k] += p[k];
            }
        }
        const double length = std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
        rt_packed_prim leaf{};
        for (int k = 0; k < 3; ++k) {
            leaf.a[k] = static_cast<float>(length > 0 ? normal[k] / length : (k == 1));
            leaf.b[k] = static_cast<float>(centroid[k] / polygon.corner_count);
        }
        leaf.ref = RT_REF_POLYGON | static_cast<rt_u32>(i);
        leaf.material = polygon.material;
        leaf.prim = first_prim + static_cast<rt_u32>(i);
        out.polygon_table.push_back({static_cast<rt_u32>(out.polygon_corners.size() / 3), polygon.corner_count});
        out.polygon_corners.insert(out.polygon_corners.end(), corners, corners + 3 * size_t(polygon.corner_count));
        rt_prim prim = box_of(out, leaf);
        prim.mesh = run;
        grow(out.bounds, prim);
        out.polygons.push_back(leaf);
        out.prims[at++] = prim;
    }
}

// Returns the world-space box of what lies in `box`, in its own space, as kernels see it.
//
// Kernels transform each ray with object_from_world, in float. Where large coordinates cancel, this rounding seems to move the
// surface. So the box grows by a bound on the rounding (Pharr, Jakob, Humphreys 2016, Physically Based Rendering, section
// 3.9): gamma(n) = n u / (1 - n u) times the sum of the absolute terms, with u = 2^-24 and n = 8. There is one rounding in the
// inverse, three in the origin, three in the direction, and one in the difference of corner and origin. The terms are those of
// a ray that starts no farther from the world's origin than the box reaches. A ray that starts at a larger distance d has an
// error of a few u d, which is no more than the rounding of its direction.
rt_prim placed_box(const rt_prim& box, const Affine& world, const Affine& object_from_world) {
    constexpr double kRounding = 8 * 0x1p-24, kGamma = kRounding / (1 - kRounding);
    rt_prim prim = empty_prim(box.ref, box.mesh);
    double lo[3], hi[3], farthest[3];
    for (int k = 0; k < 3; ++k) {
        lo[k] = hi[k] = world[4 * k + 3];
        for (int j = 0; j < 3; ++j) {
            const double a = double(world[4 * k + j]) * box.lo[j], b = double(world[4 * k + j]) * box.hi[j];
            lo[k] += std::min(a, b);
            hi[k] += std::max(a, b);
        }
        farthest[k] = std::max(std::fabs(lo[k]), std::fabs(hi[k]));
    }
    double error[3];  // in object space
    for (int j = 0; j < 3; ++j) {
        const float* row = &object_from_world[4 * j];
        double terms = std::fabs(row[3]);
        for (int k = 0; k < 3; ++k) terms += std::fabs(row[k]) * farthest[k];
        error[j] = kGamma * terms;
    }
    for (int k = 0; k < 3; ++k) {
        double room = 0;
        for (int j = 0; j < 3; ++j) room += std::fabs(world[4 * k + j]) * error[j];
        prim.lo[k] = bvh::rounded_down(lo[k] - room);
        prim.hi[k] = bvh::rounded_up(hi[k] + room);
    }
    widen(prim, 1e-6f);
    return prim;
}

// The box of a group's primitives.
Bounds bounds_of(const BuildScene& scene, rt_u32 group) {
    Bounds box;
    for (rt_u32 i = 0; i < scene.groups[group].count; ++i) grow(box, scene.prims[scene.groups[group].first + i]);
    return box;
}

// Kernels of shapes compute a point's height above the surface with about this many roundings of numbers of the shape's size.
constexpr float kShapeRoundings = 16;

void add_shapes(const Scene& scene, rt_u32 run, rt_u32 first_prim, uint64_t& at, BuildScene& out) {
    for (size_t s = 0; s < scene.shapes.size(); ++s) {
        const Shape& placed = scene.shapes[s];
        Affine inverse;
        if (!invert(placed.world_from_object, inverse)) throw Error(Exit::failed, "a shape is placed without volume");
        for (rt_u32 i = 0; i < placed.part_count; ++i) {
            const ShapePart& part = scene.shape_parts[size_t(placed.first_part) + i];
            rt_prim box = empty_prim(RT_REF_SHAPE | static_cast<rt_u32>(out.shapes.size()), run);
            grow(box, part.min.data());
            grow(box, part.max.data());
            rt_shape shape{};
            std::copy(inverse.begin(), inverse.end(), shape.object_from_world);
            std::copy(part.numbers.begin(), part.numbers.end(), shape.numbers);
            shape.kind = placed.kind;
            shape.first_more = part.first_more;
            const float size = std::hypot(part.max[0] - part.min[0], part.max[1] - part.min[1], part.max[2] - part.min[2]);
            shape.error = kShapeRoundings * 0x1p-24f * size;
            for (int k = 0; k < 3; ++k) {  // plugins compute boxes in float, too
                box.lo[k] -= 4 * shape.error;
                box.hi[k] += 4 * shape.error;
            }
            const rt_prim prim = placed_box(box, placed.world_from_object, inverse);
            rt_packed_prim leaf{};
            std::copy_n(prim.lo, 3, leaf.a);
            std::copy_n(prim.hi, 3, leaf.b);
            leaf.ref = prim.ref;
            leaf.material = placed.material;
            leaf.prim = first_prim + static_cast<rt_u32>(s);
            grow(out.bounds, prim);
            out.shape_leaves.push_back(leaf);
            out.shapes.push_back(shape);
            out.prims[at++] = prim;
        }
    }
}

// Which meshes get a tree of their own. A mesh with one instance is flattened: its triangles join the world's tree, because one
// more tree would only make rays slower. A mirrored mesh is not flattened, because its triangles would turn inside out, and a
// mesh that moves is not, so that the world's tree stays as it is. Nor is one that some rays pass: only instances have masks.
struct Grouping {
    std::vector<Affine> inverse;  // of each instance
    std::vector<bool> built;      // for each instance: it is in the structure. One that is apart may be hidden there
    std::vector<bool> flat;       // for each instance: it is flattened
    std::vector<rt_u32> group_of_mesh;
    rt_u32 group_count = 1;
    uint64_t world_prims = 0, refs = 0;
};

// Triangles of a still mesh that is kept apart, too, in a scene that moves. A refit of the world then reads one box instead of
// all of them: one object that moves beside millions of still triangles costs what the object costs.
constexpr rt_u32 kLargeMesh = 1u << 14;

Grouping group_meshes(const Scene& scene) {
    Grouping out;
    std::vector<rt_u32> uses(scene.meshes.size(), 0);
    for (const Instance& instance : scene.instances) ++uses[instance.mesh];
    const bool moves = std::any_of(scene.instances.begin(), scene.instances.end(), [](const Instance& i) { return i.apart; });
    out.inverse.resize(scene.instances.size());
    out.built.resize(scene.instances.size());
    out.flat.resize(scene.instances.size());
    out.group_of_mesh.assign(scene.meshes.size(), 0);
    out.world_prims = scene.spheres.size() + scene.polygons.size();
    for (const Shape& shape : scene.shapes) out.world_prims += shape.part_count;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const rt_u32 count = scene.meshes[instance.mesh].triangle_count;
        const bool singular = !invert(instance.world_from_object, out.inverse[i]);
        out.built[i] = instance.visible || (instance.apart && !singular && count > 0);
        if (!out.built[i]) continue;
        const bool alone = instance.apart || instance.mask != RT_SEEN_BY_ALL || (moves && count >= kLargeMesh);
        const bool together = uses[instance.mesh] == 1 && !mirrors(instance.world_from_object) && !alone;
        out.flat[i] = together || singular || count == 0;
        if (out.flat[i]) {
            out.world_prims += count;
            out.refs += count;
        } else {
            ++out.world_prims;
            if (out.group_of_mesh[instance.mesh] == 0) {
                out.group_of_mesh[instance.mesh] = out.group_count++;
                out.refs += count;
            }
        }
    }
    return out;
}

}  // namespace

rt_u32 hidden_from(const Instance& instance, bool visible) {
    return visible ? RT_SEEN_BY_ALL & ~instance.mask : RT_NONE;
}

bool mirrors(const Affine& m) {
    return determinant(to_matrix(m)) < 0;
}

rt_prim box_of(const BuildScene& scene, const rt_packed_prim& packed) {
    rt_prim prim = empty_prim(packed.ref, 0);
    switch (RT_REF_KIND(packed.ref)) {
        case RT_REF_SPHERE:
            for (int k = 0; k < 3; ++k) {
                prim.lo[k] = packed.a[k] - packed.b[0];
                prim.hi[k] = packed.a[k] + packed.b[0];
            }
            widen(prim, 1e-6f);
            return prim;
        case RT_REF_POLYGON: {
            const rt_polygon& polygon = scene.polygon_table[RT_REF_INDEX(packed.ref)];
            const float* const corners = &scene.polygon_corners[3 * size_t(polygon.first)];
            for (rt_u32 c = 0; c < polygon.count; ++c) grow(prim, corners + 3 * size_t(c));
            widen(prim, 1e-6f);
            return prim;
        }
        case RT_REF_TRIANGLE:
            grow(prim, packed.c);
            break;
        default:
            break;  // instances and shapes hold their boxes
    }
    grow(prim, packed.a);
    grow(prim, packed.b);
    return prim;
}

rt_prim box_of_instance(const Bounds& box, const Affine& world, const Affine& object_from_world, rt_u32 number) {
    rt_prim prim = empty_prim(RT_REF_INSTANCE | number, number);
    if (!box.empty) {
        grow(prim, box.min.data());
        grow(prim, box.max.data());
    }
    return placed_box(prim, world, object_from_world);
}

SceneCounts count_scene(const Scene& scene) {
    const Grouping grouping = group_meshes(scene);
    SceneCounts counts;
    counts.triangles = grouping.refs;
    counts.references = grouping.world_prims;
    for (size_t m = 0; m < scene.meshes.size(); ++m)
        if (grouping.group_of_mesh[m]) counts.references += scene.meshes[m].triangle_count;
    return counts;
}

namespace {

// Throws Error if the scene has more than their numbers can name. placed: triangles of all instances.
void check_numbers(uint64_t refs, uint64_t prims, uint64_t placed) {
    if (refs > RT_REF_INDEX_MAX || prims > 0xFFFFFFF0u)
        throw Error(Exit::failed, "the scene has " + std::to_string(refs) + " triangles; this build can hold " +
                                      std::to_string(RT_REF_INDEX_MAX) +
                                      ": take fewer, or place one mesh several times instead of copies of it");
    if (placed > INT32_MAX)
        throw Error(Exit::failed, "the scene's instances have " + std::to_string(placed) +
                                      " triangles together; they are numbered up to " + std::to_string(INT32_MAX) +
                                      ": place fewer");
}

void add_planes(const Scene& scene, rt_u32 first_prim, BuildScene& out) {
    for (const Plane& plane : scene.planes) {
        rt_plane p{};
        std::memcpy(p.normal, plane.normal.data(), sizeof p.normal);
        p.offset = plane.offset;
        p.material = plane.material;
        p.prim = first_prim++;
        out.planes.push_back(p);
    }
}

}  // namespace

BuildScene make_build_scene(const Scene& scene, Progress& progress) {
    BuildScene out;
    const Grouping grouping = group_meshes(scene);
    const std::vector<Affine>& inverse = grouping.inverse;
    const std::vector<bool>& flat = grouping.flat;
    const std::vector<rt_u32>& group_of_mesh = grouping.group_of_mesh;
    const uint64_t refs = grouping.refs;
    uint64_t prim_total = grouping.world_prims;
    out.groups.assign(grouping.group_count, rt_group{0, 0});
    out.groups[0] = {0, static_cast<rt_u32>(grouping.world_prims)};
    for (size_t m = 0; m < scene.meshes.size(); ++m)
        if (group_of_mesh[m]) {
            out.groups[group_of_mesh[m]] = {static_cast<rt_u32>(prim_total), scene.meshes[m].triangle_count};
            prim_total += scene.meshes[m].triangle_count;
        }
    check_numbers(refs, prim_total, scene.placed_triangle_count());
    out.prims.resize(prim_total);
    out.triangles.resize(refs);
    out.attribute_triangle.resize(refs);

    out.group_of_mesh = group_of_mesh;
    out.first_ref_of_group.assign(grouping.group_count, 0);
    out.number_of_instance.assign(scene.instances.size(), RT_NONE);

    // Instanced meshes come first, because instances need their boxes.
    rt_u32 next_ref = 0;
    for (size_t m = 0; m < scene.meshes.size(); ++m)
        if (group_of_mesh[m]) {
            add_triangles(scene, scene.meshes[m], nullptr, RT_NONE, 0, next_ref, static_cast<rt_u32>(m),
                          out.groups[group_of_mesh[m]].first, out);
            out.first_ref_of_group[group_of_mesh[m]] = next_ref;
            next_ref += scene.meshes[m].triangle_count;
        }
    out.first_ref_of_group[0] = next_ref;
    uint64_t at = 0;
    const PrimNumbers numbers(scene);
    std::vector<rt_prim> instance_prims;
    std::vector<Bounds> group_boxes(grouping.group_count);
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const Mesh& mesh = scene.meshes[instance.mesh];
        const auto first_prim = static_cast<rt_u32>(numbers.first_of_instance(i));
        if (!grouping.built[i]) {
            // It only keeps its range of primitive numbers.
        } else if (flat[i]) {
            const bool identity = instance.world_from_object == kIdentity;
            if (!identity) out.flattened.push_back(static_cast<rt_u32>(i));
            add(add_triangles(scene, mesh, identity ? nullptr : &instance.world_from_object, instance.material, first_prim,
                              next_ref, static_cast<rt_u32>(i), at, out),
                out.bounds);
            next_ref += mesh.triangle_count;
            at += mesh.triangle_count;
        } else {
            rt_instance placed{};
            std::memcpy(placed.object_from_world, inverse[i].data(), sizeof placed.object_from_world);
            placed.first_prim = first_prim;
            placed.material = instance.material;
            placed.hidden = hidden_from(instance, instance.visible);
            const rt_u32 group = group_of_mesh[instance.mesh], index = static_cast<rt_u32>(out.instances.size());
            if (group_boxes[group].empty) {
                group_boxes[group] = bounds_of(out, group);
                add(group_boxes[group], out.object_bounds);
            }
            rt_prim prim = box_of_instance(group_boxes[group], instance.world_from_object, inverse[i], index);
            prim.mesh = static_cast<rt_u32>(i);
            grow(out.bounds, prim);
            instance_prims.push_back(prim);
            rt_packed_prim leaf{};
            std::copy_n(prim.lo, 3, leaf.a);
            std::copy_n(prim.hi, 3, leaf.b);
            leaf.ref = prim.ref;
            out.instance_leaves.push_back(leaf);
            out.number_of_instance[i] = index;
            out.instances.push_back(placed);
            out.group_of_instance.push_back(group);
            out.world_from_object.push_back(instance.world_from_object);
        }
        if (!progress.report(-1)) throw Cancelled();
    }
    for (const rt_prim& prim : instance_prims) out.prims[at++] = prim;
    const rt_u32 runs = static_cast<rt_u32>(scene.instances.size());
    const auto first = [&](PrimPlace::Kind kind) { return static_cast<rt_u32>(numbers.first(kind)); };
    add_spheres(scene, runs, first(PrimPlace::Kind::sphere), at, out);
    add_polygons(scene, runs + 1, first(PrimPlace::Kind::polygon), at, out);
    add_planes(scene, first(PrimPlace::Kind::plane), out);
    add_shapes(scene, runs + 2, first(PrimPlace::Kind::shape), at, out);
    return out;
}

}  // namespace clarity
