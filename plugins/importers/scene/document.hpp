// document.hpp -- what a scene file says, before names are resolved.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "diagnostics.hpp"
#include "rt_plugin.h"

namespace scene_format {

using Vec3 = std::array<float, 3>;

// Use of a name that another line defines, maybe further down. Empty: none was given.
struct NameUse {
    std::string name;
    Position position;
};

struct Camera {
    std::string name;
    Position position;
    Vec3 eye{0, 0, 5}, target{0, 0, 0}, up{0, 1, 0};
    float fov_deg = 45;  // vertical
};
struct Light {
    std::string name;
    rt_light values{};
};
struct Material {
    std::string name;
    Position position;
    rt_material values{};
    std::string texture;  // path, or empty
};
struct Sphere {
    Vec3 center{0, 0, 0};
    float radius = 1;
    NameUse material;
};
struct Plane {
    Vec3 normal{0, 1, 0};  // unit
    float offset = 0;      // distance from the origin along the normal
    NameUse material;
};
struct Polygon {
    std::vector<float> corners;  // 3 per corner
    NameUse material;
};
struct Triangle {
    std::array<float, 9> corners{};
    NameUse material;
};
struct Load {
    std::string path, name;
    Position position;
    std::array<float, 12> world_from_object{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};  // row-major 3x4
    NameUse material;
};

enum class ItemKind : uint8_t { sphere, plane, polygon, triangle, load };
struct Item {
    ItemKind kind;
    uint32_t index;  // in the array of its kind
    Position position;
};

struct Document {
    std::vector<Camera> cameras;
    std::vector<Light> lights;
    std::vector<Material> materials;
    std::vector<Sphere> spheres;
    std::vector<Plane> planes;
    std::vector<Polygon> polygons;
    std::vector<Triangle> triangles;
    std::vector<Load> loads;
    std::vector<Item> items;  // all of the geometry in the order of the file, which numbers the primitives
    std::vector<NameUse> animated;
    Vec3 background{}, ambient{};
    Position background_position, ambient_position;  // line 0: not said
    uint32_t statement_count = 0;
    bool has_degenerate_triangle = false;
};

}  // namespace scene_format
