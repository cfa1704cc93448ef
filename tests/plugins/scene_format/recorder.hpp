// recorder.hpp -- a host and a sink that record everything that the scene importer reports and passes on.
#pragma once
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "rt_plugin.h"
#include "rt_types.h"

struct RecordedMaterial {
    std::string name;
    rt_material values;  // its texture is an id of the sink
    std::vector<rt_map_desc> maps;
};
struct RecordedMesh {
    std::vector<float> positions;
    std::vector<rt_u32> indices, face_materials;
};
struct RecordedSphere {
    std::array<float, 3> center;
    float radius;
    rt_u32 material;
};
struct RecordedPlane {
    std::array<float, 3> normal;
    float offset;
    rt_u32 material;
};
struct RecordedPolygon {
    std::vector<float> corners;
    rt_u32 material;
};
struct RecordedLight {
    std::string name;
    rt_light_desc values;  // its pointers are not valid any more
    rt_light light;        // what the host makes of it
};
struct RecordedCamera {
    std::string name;
    rt_camera values;  // its name pointer is not valid any more
};
struct RecordedLoad {
    std::string path, name;
    std::array<float, 12> world_from_object;
    rt_u32 material;
    rt_u32 node;
};
struct RecordedChannel {
    rt_u32 moves, target, component;
    std::vector<double> times, values;
};

struct Recording {
    int32_t status = RT_OK;
    std::string why;  // the first failure
    std::vector<std::string> log, warnings;
    std::vector<std::string> textures;
    std::vector<std::pair<rt_u32, rt_u32>> wraps;  // of the textures
    std::vector<rt_texture_desc> looks;            // likewise; their pointers are not valid any more
    std::vector<RecordedMaterial> materials;
    std::vector<RecordedMesh> meshes;
    std::vector<rt_u32> instanced_meshes;
    std::vector<RecordedSphere> spheres;
    std::vector<RecordedPlane> planes;
    std::vector<RecordedPolygon> polygons;
    std::vector<RecordedLight> lights;
    std::vector<RecordedCamera> cameras;
    std::vector<RecordedLoad> loads;
    std::vector<rt_node_desc> nodes;  // their name pointers are not valid any more
    std::vector<rt_clip_desc> clips;  // likewise
    std::vector<std::string> edits;   // "instance.3.scale=1,1,2"
    std::vector<RecordedChannel> channels;
    std::vector<std::string> order;  // "sphere", "mesh", "load", ... in the order of the calls
    bool has_background = false, has_ambient = false;
    std::vector<rt_sky_desc> skies;  // without paths
    std::string sky_path;            // of the last
    std::array<float, 3> background{}, ambient{};

    // The answers of the sink and the host.
    bool refuse_textures = false, refuse_loads = false, refuse_spheres = false;
    int32_t reports_before_cancel = -1;  // negative: never

    // Returns the first fault in the recording, or an empty string: numbers must be finite, ids known, and texts free of
    // control characters.
    std::string unsound() const;
};

// Imports a file with this content into `recording`. All messages call the file test.scene.
void import_text(const std::string& text, Recording& recording);
Recording import_text(const std::string& text);
