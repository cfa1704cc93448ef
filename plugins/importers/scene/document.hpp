// document.hpp -- the contents of a scene file before its names are resolved.
#pragma once
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "diagnostics.hpp"
#include "rt_plugin.h"
#include "stated_transform.hpp"

namespace scene_format {

// A name where it is defined, or where it is used (possibly on an earlier line). Empty: no name was given.
struct Name {
    std::string text;
    Position position;
};

struct Camera {
    Name name;
    Vec3 eye{0, 0, 5}, target{0, 0, 0}, up{0, 1, 0};
    float fov_deg = 45;             // vertical, degrees
    float aperture = 0, focus = 0;  // as in rt_camera
};
// Values of keys that come from the host. The names are those of its tables.
using Looks = std::vector<rt_key_value>;
struct Light {
    Name name;
    rt_light_desc values{};  // without name
    Looks looks;
};
// A picture, and how it lies on surfaces.
struct Texture {
    Name name;
    std::string path;        // as in the file
    rt_u32 space = RT_NONE;  // RT_SPACE_; RT_NONE: that of its use
    rt_u32 wrap_u = RT_WRAP_REPEAT, wrap_v = RT_WRAP_REPEAT, filter = RT_FILTER_SMOOTH;
    rt_u32 set = 0;  // of the surface's coordinates
    std::array<float, 2> offset{}, scale{1, 1};
    float degrees = 0, strength = 1;
};
struct Material {
    Name name;
    Looks looks;
    std::vector<std::pair<rt_u32, Name>> maps;  // RT_MAP_, and the name of a texture
    std::string texture;                        // path as in the file; empty: no texture
    rt_u32 wrap_u = RT_WRAP_REPEAT, wrap_v = RT_WRAP_REPEAT;
};
struct Sphere {
    Vec3 center{0, 0, 0};
    float radius = 1;
    Name material;
};
struct Plane {
    Vec3 normal{0, 1, 0};  // unit length
    float offset = 0;      // distance from the origin along the normal
    Name material;
};
struct Polygon {
    std::vector<float> corners;  // three numbers (x, y, z) per corner
    Name material;
};
struct Triangle {
    std::array<float, 9> corners{};
    Name material;
};
struct Load {
    std::string path;
    Position position;  // of the path in the file
    Name name;
    StatedTransform placement;
    Name material;
};

// Keys of one motion of a loaded object, a camera or a light.
struct Animation {
    enum class Motion { translate, rotate, scale, fov };
    Name target;
    Motion motion = Motion::translate;
    std::vector<float> numbers;  // of each key: time, then x y z, or a unit axis and degrees, or degrees
    size_t numbers_per_key() const { return motion == Motion::rotate ? 5 : motion == Motion::fov ? 2 : 4; }
    size_t key_count() const { return numbers.size() / numbers_per_key(); }
};

struct Sky {
    Position position;     // line 0: the file does not set it
    std::string path;      // of the picture, as in the file
    rt_sky_desc values{};  // without path
};

// A change of what this file and the files that it loads hold: "instance.3.translate", "1,0,0".
struct Edit {
    std::string key, value;
    Position position;
    rt_u32 use = RT_NONE;  // RT_MAP_: `value` is the name of a texture
};

// A shape that a plugin makes.
struct Shape {
    struct Values {
        std::vector<float> numbers;
        bool given = false;
    };
    std::string kind;
    std::vector<Values> values;  // one for each key of the kind
    Name material;
};

enum class ItemKind : uint8_t { sphere, plane, polygon, triangle, shape, load };
struct Item {
    ItemKind kind;
    uint32_t index;  // index in the array of its kind
    Position position;
};

// What the sink takes, whose keys are tables of the host.
struct Kinds {
    std::vector<const rt_primitive_kind*> shapes, lights, skies;
    const rt_primitive_kind *material = nullptr, *maps = nullptr;
};

struct Document {
    Kinds kinds;
    std::vector<Camera> cameras;
    std::vector<Light> lights;
    std::vector<Texture> textures;
    std::vector<Material> materials;
    std::vector<Sphere> spheres;
    std::vector<Plane> planes;
    std::vector<Polygon> polygons;
    std::vector<Triangle> triangles;
    std::vector<Shape> shapes;
    std::vector<Load> loads;
    std::vector<Item> items;  // all geometry in the order of the file; this order numbers the primitives
    std::vector<Animation> animations;
    std::vector<Edit> edits;
    Vec3 background{}, ambient{};
    Sky sky;
    Position background_position, ambient_position;  // line 0: the file does not set it
    uint32_t statement_count = 0;
    bool has_degenerate_triangle = false;
};

}  // namespace scene_format
