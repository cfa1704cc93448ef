// scene.hpp -- what the parts of the importer share while they pass a file's scene to the host.
#pragma once
#include <map>

#include "../common/mapped_file.hpp"
#include "rt_plugin.hpp"
#include "transform.hpp"

namespace fbx_import {

struct Context {
    const rt_host* host;
    const rt_scene_sink& sink;
    const importers::MappedFile& file;
    const Document& document;
    const Objects& objects;
    const Templates& templates;
    std::string folder, stem;  // of the file: "/models/", "car"
    double fps;                // frames a second, 0: the file does not say

    void warn(const std::string& text) const { sink.warn(sink.ctx, text.c_str()); }
    Properties properties(uint32_t object) const { return templates.of(objects[object]); }
};

// ---- nodes

// A model of the file below one of its parents.
struct SceneNode {
    uint32_t object = kNoObject;
    uint32_t parent = kNoObject;  // number of a node
    NodeTransform transform;
    rt_u32 id = 0;  // the host's
    bool hidden = false;
};
// Parents before their children. Passes them to the host. Throws Broken if they form a circle.
std::vector<SceneNode> read_nodes(const Context& context);

// ---- meshes

// A mesh that the host has.
struct SceneMesh {
    rt_u32 id = RT_NONE;
    uint32_t object = kNoObject;    // its geometry; before version 7 its model
    uint32_t node = kNoObject;      // number of the first node that shows it
    uint32_t points = 0;            // vertices of the file; the host's vertex i is the file's for i < points
    std::vector<uint32_t> copy_of;  // the file's vertex, of each further vertex of the host
};
std::vector<SceneMesh> add_meshes(const Context& context, const std::vector<SceneNode>& nodes);

// ---- materials

class Materials {
 public:
    explicit Materials(const Context& context) : context_(context) {}
    // The materials of a model in the order of their slots.
    std::vector<const Node*> of(uint32_t model) const;
    rt_u32 id(const Node* material, uint32_t model);  // RT_NONE: the default material

 private:
    rt_u32 texture(uint32_t material, uint32_t model);
    rt_u32 file_texture(uint32_t texture);
    std::string existing_path(std::string_view relative, std::string_view absolute) const;
    const Context& context_;
    std::map<const Node*, rt_u32> ids_;
    std::map<uint32_t, rt_u32> textures_;
};

// ---- lights and cameras

void add_views(const Context& context, const std::vector<SceneNode>& nodes);

// ---- motion

// Ids of the host's morphs, by the object that has their weight and, before version 7, the name of the shape.
using Morphs = std::map<std::pair<uint32_t, std::string>, std::vector<rt_u32>>;
void add_deformers(const Context& context, const std::vector<SceneNode>& nodes, const std::vector<SceneMesh>& meshes,
                   Morphs& morphs);
// Reads the geometry cache that a deformer names. Files that are missing or damaged are a warning.
void add_cache(const Context& context, const SceneMesh& mesh, uint32_t deformer);
// Frames a second; 0: the file does not say.
double frames_of_second(const Document& document, const Objects& objects);
void add_clips(const Context& context, const std::vector<SceneNode>& nodes, const Morphs& morphs);

}  // namespace fbx_import
