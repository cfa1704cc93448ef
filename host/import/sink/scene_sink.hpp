// scene_sink.hpp -- the rt_scene_sink of one file: checks and copies what an importer delivers.
#pragma once
#include <exception>
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "import/sink/mesh_copy.hpp"
#include "import/sink/motion_sink.hpp"
#include "import/sink/scene_builder.hpp"
#include "plugin/host_services.hpp"
#include "rt_plugin.h"

namespace clarity::import {

// Names are shown to people: control characters of hostile files are removed, and the length is limited.
std::string clean_name(const char* name);

// Exists for one call of rt_importer.load. The ids that it gives to the plugin count within this file. A bug of the plugin (an
// unknown id, no positions) fails the import. Damage in the file itself (bad indices, numbers that are not finite) is left out
// with a warning; the import fails only if nothing remains.
class SceneSink {
 public:
    SceneSink(SceneBuilder& builder, HostServices& services, std::string path, FileContent& content);
    SceneSink(const SceneSink&) = delete;
    SceneSink& operator=(const SceneSink&) = delete;

    const rt_scene_sink* sink() const { return &sink_; }
    bool cancelled() const { return cancelled_; }
    // Call after the plugin has succeeded. Warns about everything that was left out. Returns nothing, or why the import
    // fails nevertheless.
    Problem finish();

 private:
    static constexpr rt_u32 kFailed = RT_NONE;
    rt_u32 texture(const rt_texture_desc& desc);
    rt_u32 material(const rt_material_desc& desc);
    rt_u32 mesh(const rt_mesh& desc);
    rt_u32 instance(const rt_instance_desc& desc);
    rt_u32 sphere(const float* center, float radius, rt_u32 material);
    rt_u32 plane(const float* normal, float offset, rt_u32 material);
    rt_u32 polygon(const float* corners, rt_u32 corner_count, rt_u32 material);
    rt_u32 light(const rt_light_desc& desc);
    rt_u32 camera(const rt_camera& desc);
    void info(const rt_scene_info& info);
    int32_t load(const rt_load& load);
    rt_u32 primitive(const rt_primitive_desc& desc);
    int32_t edit(const char* key, const char* value, const char* where);
    int32_t sky(const rt_sky_desc& sky);

    rt_u32 fail(const std::string& why, Failure failure = Failure::other);
    // Finds the scene material, or a material's texture, of an id. If the plugin never received this id, records an error and
    // returns false.
    bool scene_texture(rt_u32 id, const Material& material, rt_u32& texture);
    // The first name that a file gives it counts.
    void name_texture(rt_u32 texture, const rt_texture_desc& d);
    std::string lost_light(const Material& material);
    bool take_maps(const rt_material_desc& desc, Material& material, std::string& problem);
    bool scene_material(rt_u32 id, const char* of, rt_u32 if_none, rt_u32& material);
    void offer_motion();
    template <class Result, class Body>
    static Result guarded(void* ctx, Result failed, const Body& body);

    SceneBuilder& builder_;
    HostServices& services_;
    std::string path_;
    FileContent& content_;
    rt_scene_sink sink_{};
    MotionSink motion_;
    std::vector<rt_u32> materials_, meshes_, textures_;   // scene indices by id
    std::vector<Vec> origins_;                            // rt_mesh::origin by id
    std::vector<rt_u32> camera_sources_, light_sources_;  // `source` by id; RT_NONE: it was left out
    std::vector<rt_primitive_kind> kinds_;
    FaceCount faces_;
    uint64_t kept_faces_before_ = 0, lost_instances_ = 0, lost_views_ = 0;
    bool cancelled_ = false;
};

}  // namespace clarity::import
