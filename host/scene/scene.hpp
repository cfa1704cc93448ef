// scene.hpp -- the host's scene: flat arrays in the file's own units and axes. Cameras take +Y as up by convention.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/members.hpp"
#include "base/problem.hpp"
#include "rt_plugin.h"
#include "rt_types.h"
#include "scene/motion/motion.hpp"
#include "scene/shared_array.hpp"
#include "scene/sky.hpp"

namespace clarity {

// Row-major 3x4 matrix: x' = m[0] x + m[1] y + m[2] z + m[3].
using Affine = std::array<float, 12>;
inline constexpr Affine kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

// Axis-aligned box; min and max are valid unless `empty`.
struct Bounds {
    std::array<float, 3> min{}, max{};
    bool empty = true;
    void add(const float* p);
    float diagonal() const;
};

struct Mesh {
    std::string name;
    rt_u32 first_vertex = 0, vertex_count = 0;
    rt_u32 first_triangle = 0, triangle_count = 0;
    rt_u32 polygon_count = 0;  // faces in the file, before triangulation
    CLARITY_MEMBERS(name, first_vertex, vertex_count, first_triangle, triangle_count, polygon_count);
};

// What a user does to an instance, on top of where its file or its pose has it. It is scaled along the world's axes, then
// turned about x, about y and about z, all about `pivot`, and then moved.
struct InstanceShift {
    std::array<float, 3> translate{}, degrees{}, scale{1, 1, 1};
    bool operator==(const InstanceShift& b) const {
        return translate == b.translate && degrees == b.degrees && scale == b.scale;
    }
    bool operator!=(const InstanceShift& b) const { return !(*this == b); }
};

struct Instance {
    std::string name;
    rt_u32 mesh = 0;
    rt_u32 material = RT_NONE;  // replaces the materials of the whole mesh; RT_NONE: the mesh keeps its own
    Affine world_from_object = kIdentity;
    bool visible = true;  // false: in no acceleration structure, but its primitives keep their numbers
    // For an instance that a node moves. `node` moves it; `root` is the node that places its file. node_from_object places the
    // object in the node's space. If the transform at rest is flat, `mesh` is a flat copy; moving_mesh is the mesh itself.
    rt_u32 node = RT_NONE, root = RT_NONE, moving_mesh = 0;
    Affine node_from_object = kIdentity;
    bool apart = false;   // moves, so that its mesh is kept apart from the flattened world and can move alone
    bool hidden = false;  // by the user, in all poses
    // By the user: see instance_edit.hpp. world_from_object has it already, poses get it. pivot: in the object's space.
    InstanceShift shift{};
    std::array<float, 3> pivot{};
    std::array<double, 3> rounded_off{};  // for the import only: what rounding took from world_from_object's translation
    rt_u32 mask = RT_SEEN_BY_ALL;         // kinds of rays that hit it
    CLARITY_MEMBERS(name, mesh, material, world_from_object, visible, node, root, moving_mesh, node_from_object, apart, hidden,
                    shift, pivot, rounded_off, mask);
};

struct Sphere {
    std::array<float, 3> center{};
    float radius = 0;
    rt_u32 material = 0;
};
struct Plane {
    std::array<float, 3> normal{};  // unit length
    float offset = 0;               // dot(normal, x) = offset on the plane
    rt_u32 material = 0;
};
struct Polygon {
    rt_u32 first_corner = 0, corner_count = 0;  // range in Scene::polygon_corners, counted in corners
    rt_u32 material = 0;
};
// A kind of shapes that the scene has, made by a plugin.
struct ShapeKind {
    std::string id;
    const rt_plugin* plugin = nullptr;  // has `primitive`; set in a scene that import_scene() returned
    // Each process has a plugin of its own.
    template <class Parcel, class Self>
    static void visit(Parcel& parcel, Self& self) {
        parcel(self.id);
    }
};
static_assert(has_member_count<ShapeKind, 2>, "visit() has all that processes share");
// A placed shape. Its parts may belong to several placements.
struct Shape {
    rt_u32 kind = 0;  // index in Scene::shape_kinds
    rt_u32 first_part = 0, part_count = 0;
    rt_u32 material = 0;
    Affine world_from_object = kIdentity;
};
// What acceleration structures and kernels know of a shape, in its own space.
struct ShapePart {
    std::array<float, 3> min{}, max{};
    std::array<float, RT_SHAPE_NUMBERS> numbers{};
    rt_u32 first_more = 0, more_count = 0;  // range in Scene::shape_numbers
};
// For each use of a texture (RT_MAP_...) an index in Scene::maps, or RT_NONE. A colour that needs no map is
// rt_material::texture.
using MaterialMaps = std::array<rt_u32, RT_MAP_USES>;
constexpr MaterialMaps no_maps() {
    MaterialMaps maps{};
    for (rt_u32 use = 0; use < RT_MAP_USES; ++use) maps[use] = RT_NONE;
    return maps;
}
// All numbers of a material. Keys reach both structs by their offsets from the first one.
struct MaterialValues : rt_material {
    MaterialValues() : MaterialValues(rt_material{}) {}
    MaterialValues(const rt_material& plain);  // with the defaults of layers
    rt_layers layers;
};
static_assert(sizeof(MaterialValues) == sizeof(rt_material) + sizeof(rt_layers), "layers follow at once");
struct Material {
    std::string name;
    MaterialValues values{};
    MaterialMaps maps = no_maps();
    bool used = true;  // false: no primitive of the scene has it, so that kernels need not know it; by note_used_materials()
    CLARITY_MEMBERS(name, values, maps, used);
};
struct Light {
    std::string name;
    rt_light values{};
    rt_u32 node = RT_NONE;  // that moves it
    rt_light at_node{};     // in the node's space
    rt_u32 source = 0;      // for the import only: by which channels name it
    CLARITY_MEMBERS(name, values, node, at_node, source);
};
struct Camera {
    std::string name;
    std::array<float, 3> eye{}, target{}, up{0, 1, 0};
    float fov_y_rad = 0.7853982f;
    float aperture = 0;     // diameter of the lens; 0: a pinhole
    float focus = 0;        // distance along the view at which the lens is sharp; 0: that of the target
    rt_u32 node = RT_NONE;  // that moves it
    std::array<float, 3> node_eye{}, node_target{}, node_up{};  // in the node's space
    rt_u32 source = 0;                                          // for the import only: by which channels name it
    CLARITY_MEMBERS(name, eye, target, up, fov_y_rad, aperture, focus, node, node_eye, node_target, node_up, source);
};

// A change that a file makes to what it and the files that it loads hold: words of host/view/edit/edit.hpp.
struct SceneEdit {
    std::string key, value;
    std::string where;  // "FILE:LINE:COLUMN"
    CLARITY_MEMBERS(key, value, where);
};

// A scene is valid once validate() has accepted it: every index is in range, every number is finite, and materials[0] is the
// default material.
struct Scene {
    SharedArray<float> positions;            // 3 per vertex
    SharedArray<float> normals;              // 3 per vertex, (0,0,0) for meshes without normals; or empty
    SharedArray<float> uvs;                  // 2 per vertex; or empty
    SharedArray<float> uvs2;                 // as uvs: a second set, for maps that name it
    SharedArray<float> colors;               // linear r, g, b and alpha per vertex, 1 for meshes without colours; or empty
    SharedArray<rt_u32> tangents;            // 3 per triangle, for normal maps: see tangents.hpp; or empty
    SharedArray<rt_u32> triangles;           // 3 per triangle, indices into the vertices of the whole scene
    SharedArray<rt_u32> triangle_materials;  // 1 per triangle
    std::vector<Mesh> meshes;
    std::vector<Instance> instances;  // a mesh without an instance is not in the world
    std::vector<Sphere> spheres;
    std::vector<Plane> planes;
    std::vector<Polygon> polygons;
    std::vector<float> polygon_corners;  // 3 per corner
    std::vector<ShapeKind> shape_kinds;
    std::vector<Shape> shapes;
    std::vector<ShapePart> shape_parts;
    std::vector<float> shape_numbers;
    std::vector<Material> materials;
    std::vector<rt_map> maps;
    std::vector<rt_texture> textures;
    std::vector<std::string> texture_names;  // one for each texture, or none
    SharedArray<uint32_t> texels;            // RGBA8, R in the low byte
    std::vector<Light> lights;
    std::vector<Camera> cameras;
    Sky sky;
    std::array<float, 3> background{0.12f, 0.16f, 0.22f}, ambient{0.08f, 0.08f, 0.08f};
    rt_u32 up_axis = 1;
    double unit_scale = 0;  // metres per unit; 0: the file does not say
    // Coordinates of the scene are those of the files less this: see import/sink/world_origin.cpp. Users read and write those
    // of the files.
    std::array<double, 3> origin{};
    std::vector<std::string> warnings;
    std::vector<SceneEdit> edits;      // not yet in force in the arrays above
    std::vector<std::string> sources;  // files that were read: absolute paths, without those of sequences
    Motion motion;                     // what the arrays above look like at other times

    rt_u32 vertex_count() const { return static_cast<rt_u32>(positions.size() / 3); }
    rt_u32 triangle_count() const { return static_cast<rt_u32>(triangles.size() / 3); }
    // Number of triangles in the world: the sum over all instances.
    uint64_t placed_triangle_count() const;
    // Whether vertices have more than positions, so that kernels have to know the corners of triangles.
    bool has_attributes() const {
        return !normals.empty() || !uvs.empty() || !uvs2.empty() || !tangents.empty() || !colors.empty();
    }
    // World-space box of everything finite; planes are left out.
    Bounds bounds() const;
    // World-space area of the triangles of all instances, the polygons and the spheres. That of shapes is not known.
    double surface_area() const;
    CLARITY_MEMBERS(positions, normals, uvs, uvs2, colors, tangents, triangles, triangle_materials, meshes, instances, spheres,
                    planes, polygons, polygon_corners, shape_kinds, shapes, shape_parts, shape_numbers, materials, maps,
                    textures, texture_names, texels, lights, cameras, sky, background, ambient, up_axis, unit_scale, origin,
                    warnings, edits, sources, motion);
};

// Notes which materials primitives have, those of hidden objects included. Files name many that none has: those of a model that
// was loaded with another material, for example.
void note_used_materials(Scene& scene);

// The next smaller picture of a texture's picture or of one of its smaller ones, which follows it in the texels.
rt_texture smaller_picture(const rt_texture& picture);

// The object to which a number of `prim` belongs.
struct PrimPlace {
    enum class Kind { none, triangle, sphere, polygon, plane, shape } kind = Kind::none;
    rt_u32 index = 0;           // within its kind; a triangle's index counts in Scene::triangles
    rt_u32 instance = RT_NONE;  // of a triangle; RT_NONE for other kinds
    rt_u32 material = RT_NONE;
};
// The numbers of a scene's primitives: those of the triangles of all instances in order, then of the other kinds in the order
// of PrimPlace::Kind. All others ask here, so that the order stands nowhere else.
class PrimNumbers {
 public:
    PrimNumbers() = default;
    explicit PrimNumbers(const Scene& scene);
    // That of the first triangle of an instance, and of the first primitive of another kind.
    uint64_t first_of_instance(size_t instance) const { return first_[instance]; }
    uint64_t first(PrimPlace::Kind kind) const { return first_[instance_count() + slot(kind)]; }
    uint64_t count() const { return first_.back(); }
    // Kind and index, and the instance of a triangle, whose index counts within the instance.
    PrimPlace place(rt_i32 prim) const;

 private:
    static constexpr size_t kKinds = 4;  // with numbers behind those of the triangles
    static constexpr size_t slot(PrimPlace::Kind kind) { return size_t(kind) - size_t(PrimPlace::Kind::sphere); }
    size_t instance_count() const { return first_.size() - kKinds - 1; }
    std::vector<uint64_t> first_;  // of instances, of kinds, and the number of all
};
PrimPlace place_of_prim(const Scene& scene, rt_i32 prim);

// World-space box of one instance's vertices.
Bounds instance_bounds(const Scene& scene, rt_u32 instance);
// Box of a shape's parts in its own space.
Bounds shape_bounds(const Scene& scene, const Shape& shape);

// "wood.png", or "texture 3" if it has no name.
std::string texture_name(const Scene& scene, rt_u32 texture);
// Texels of a picture and of the smaller ones behind it; 0 if it is empty or has more levels than its size allows.
uint64_t texel_count(const rt_texture& texture);
MaterialValues default_material();  // in material_keys.cpp
// A light without falloff. kind: RT_LIGHT_POINT at a position, or RT_LIGHT_DIRECTIONAL from a unit vector towards it.
rt_light whitted_light(rt_u32 kind, const std::array<float, 3>& position, const std::array<float, 3>& color);

// Returns nothing if the scene is sound, otherwise what is wrong ("triangle 12: vertex 99 of 80"). Linear in the scene's
// size.
Problem validate(const Scene& scene);
Problem validate_motion(const Scene& scene);  // of its motion alone; validate() calls it

// ---- transforms
std::array<float, 3> transform_point(const Affine& m, const float* p);
Affine multiply(const Affine& a, const Affine& b);  // applies b first, then a
bool invert(const Affine& m, Affine& inverse);      // false if m is singular

}  // namespace clarity
