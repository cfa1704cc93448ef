// scene.hpp -- the steps that pass a file's scene to the host, and the data that they share.
#pragma once
#include <map>

#include "../common/mapped_file.hpp"
#include "../common/texture_path.hpp"
#include "properties.hpp"
#include "rt_plugin.hpp"

namespace fbx_import {

struct Context {
    const rt_host* host;
    const rt_scene_sink& sink;
    const importers::MappedFile& file;
    const Document& document;
    const Objects& objects;
    const Templates& templates;
    importers::FilePlace place;
    double fps;  // frames a second; 0: the file does not say
    double metres_per_unit;
    bool by_blender;  // whether Blender wrote the file

    void warn(const std::string& text) const { sink.warn(sink.ctx, text.c_str()); }
    Properties properties(uint32_t object) const { return templates.of(objects[object]); }
};

// ---- nodes

// A model of the file below one of its parents; a model with several parents becomes several nodes.
struct SceneNode {
    uint32_t object = kNoObject;
    rt_u32 id = 0;       // the host's
    Transform geometry;  // from the node's own meshes to the node
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
    std::vector<uint32_t> copy_of;  // of each further vertex of the host: the file's vertex
    Vec3 origin{};                  // what was subtracted from the file's vertices
};
std::vector<SceneMesh> add_meshes(const Context& context, const std::vector<SceneNode>& nodes);

// ---- materials

// The names of the sets of texture coordinates that a material uses; the empty name is the first set of a mesh.
using UvSets = std::vector<std::string_view>;
inline constexpr size_t kMostUvSets = 2;
struct UsedTexture {
    uint32_t texture;
    rt_u32 use, space;  // RT_MAP_..., RT_SPACE_...
};

class Materials {
 public:
    explicit Materials(const Context& context) : context_(context) {}
    // The materials of a model in the order of their slots, and the sets of each of them.
    std::vector<uint32_t> of(uint32_t model) const { return context_.objects.below(model, "Material"); }
    std::vector<UvSets> uv_sets(uint32_t model) const;
    rt_u32 id(uint32_t material, uint32_t model);
    void report() const;  // warns about what was left out

 private:
    uint32_t texture(uint32_t material, uint32_t model) const;  // kNoObject: there is none
    uint32_t transparency(uint32_t material) const;             // its texture, likewise
    std::string_view file_of(uint32_t texture) const;
    std::vector<UsedTexture> used(uint32_t material, uint32_t model) const;
    bool takes(uint32_t material, rt_u32 use) const;  // whether the material may have a map of the use
    std::string_view uv_set(uint32_t texture) const;
    UvSets sets_of(const std::vector<UsedTexture>& used) const;
    std::vector<rt_map_desc> maps_of(uint32_t material, const std::vector<UsedTexture>& used,
                                     std::vector<std::string>& left_out);
    std::vector<std::string> pictures_left_out(uint32_t material) const;
    rt_u32 picture(uint32_t texture, rt_u32 space);
    const Context& context_;
    std::map<uint32_t, rt_u32> ids_;
    std::map<std::pair<uint32_t, rt_u32>, rt_u32> pictures_;  // by texture and space
    size_t transparencies_ = 0;                               // materials with a picture of it that is not read
};

// ---- lights and cameras

// A light that the host has. Its colour there is color * intensity * scale.
struct LightView {
    rt_u32 id = 0;
    Vec3 color{};
    double intensity = 1, scale = 1;
};
// The host's lights and cameras, by the object that has their properties.
struct Views {
    std::map<uint32_t, std::vector<LightView>> lights;
    std::map<uint32_t, std::vector<rt_u32>> cameras;
};
Views add_views(const Context& context, const std::vector<SceneNode>& nodes);
// The vertical angle of view in radians, where the property `moved` has another value than at rest.
double angle_of_view(const Properties& camera, std::string_view moved = "", double value = 0);

// ---- motion

// Ids of the host's morphs, by the object that has their weight. Before version 7, that is the model, and the shape's name
// tells its morphs apart.
using Morphs = std::map<std::pair<uint32_t, std::string>, std::vector<rt_u32>>;
void add_deformers(const Context& context, const std::vector<SceneNode>& nodes, const std::vector<SceneMesh>& meshes,
                   Morphs& morphs);
// Reads the geometry cache that a deformer names. Missing or damaged files give a warning.
void add_cache(const Context& context, const SceneMesh& mesh, uint32_t deformer);
// Up to version 5.8, this stands behind a shape's name in that of its channel (measured from max7_blend_cube_5000_binary of
// ufbx).
inline constexpr char kShapeSuffix[] = " (Shape)";
// The channels of a model in the file's current take, or its first one; nullptr: there are none. Before version 7.
const Node* in_current_take(const Document& document, const Node& model);
// Frames a second; 0: the file does not say.
double frames_of_second(const Document& document, const Objects& objects);
void add_clips(const Context& context, const std::vector<SceneNode>& nodes, const Views& views, const Morphs& morphs);

}  // namespace fbx_import
