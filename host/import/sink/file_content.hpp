// file_content.hpp -- the objects that one file places in its own space.
#pragma once
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace clarity::import {

// Meshes, materials, textures, keys, morphs and vertex frames are in the Scene already, and only once, however often the file
// is placed.
struct FileContent {
    struct PolygonCorners {
        std::vector<float> corners;  // 3 each
        rt_u32 material = 0;
    };
    std::vector<Instance> instances;
    std::vector<Sphere> spheres;
    std::vector<Plane> planes;
    std::vector<PolygonCorners> polygons;
    std::vector<Shape> shapes;
    // included: those of files that this file loads. They are kept apart so that the first camera is the file's own.
    std::vector<Light> lights, included_lights;
    std::vector<Camera> cameras, included_cameras;

    // Numbers count this file's instances, its lights before included ones, and materials from first_material on (0 is the
    // default one).
    std::vector<SceneEdit> edits;
    rt_u32 first_material = 1;

    std::vector<Node> nodes;  // a node without parent has RT_NONE there
    std::vector<Clip> clips;
    std::vector<rt_layer> layers;
    std::vector<Channel> channels;  // targets are nodes of this file, morphs of the scene, or `source` of cameras and lights
    std::vector<Skin> skins;        // root RT_NONE: this file
    std::vector<Bone> bones;
    bool has_mesh_origins = false;  // rt_mesh::origin of one of its meshes is not 0
    rt_u32 rig_count = 0;
    bool deforms = false;  // one of its meshes has morphs or vertex frames
    bool moves() const { return !clips.empty() || !skins.empty() || deforms; }
};

// What the key of an edit changes, and the number in it: "instance.3.scale", "light.0".
enum class EditOf { nothing, instance, material, light, sky };
EditOf edit_number(const std::string& key, rt_u32& number);
// The key with another number.
std::string with_number(const std::string& key, rt_u32 number);

// How a file is placed in another file.
struct Placement {
    std::string name;                      // name of the instance; if the file has several, the first part of their names
    Affine world_from_object = kIdentity;  // at rest
    rt_u32 material = RT_NONE;             // scene material for all of it; RT_NONE: the file's own materials
    rt_u32 node = RT_NONE;                 // node of the other file that moves it
    Affine node_from_object = kIdentity;
};

// Places all that moves in `content` into `into`, under a node of its own, and returns the index of that node; RT_NONE if
// nothing moves. The rest of `content` follows in SceneBuilder::place().
rt_u32 place_motion(const FileContent& content, const Placement& placement, FileContent& into);

}  // namespace clarity::import
