// motion_sink.hpp -- the part of a file's sink that receives motion: checks and copies what an importer delivers.
#pragma once
#include <string>
#include <vector>

#include "import/sink/file_content.hpp"
#include "rt_plugin.h"
#include "scene/motion/node_transform.hpp"

namespace clarity::import {

// Ids that it gives count from 1. All functions throw Error(import_failed) for a bug of the plugin (an unknown id). Damage in
// the file itself (numbers that are not finite, keys out of order) is left out and counted.
class MotionSink {
 public:
    MotionSink(Scene& scene, FileContent& content) : scene_(scene), content_(content) {}

    // meshes: the scene's mesh of each id that the sink gave; views likewise: `source` of cameras and lights.
    rt_u32 node(const rt_node_desc& desc, std::string name);
    rt_u32 clip(const rt_clip_desc& desc, std::string name);
    rt_u32 morph(const rt_morph_desc& desc, std::string name, const std::vector<rt_u32>& meshes);
    void channel(const rt_channel_desc& desc, const std::vector<rt_u32>& cameras, const std::vector<rt_u32>& lights);
    void skin(const rt_skin_desc& desc, const std::vector<rt_u32>& meshes);
    void vertex_frames(const rt_vertex_frames& desc, const std::vector<rt_u32>& meshes);

    // The node of an id that something hangs on; RT_NONE for id 0.
    rt_u32 node_of(rt_u32 id, const char* what) const;
    const PlacedNode& at_rest(rt_u32 node) const { return at_rest_[node]; }
    // What was left out, as warnings.
    std::vector<std::string> losses() const;

 private:
    Scene& scene_;
    FileContent& content_;
    std::vector<PlacedNode> at_rest_;  // one for each node of the file
    std::vector<rt_u32> morphs_;       // of the scene, by id - 1
    uint64_t lost_channels_ = 0, lost_nodes_ = 0, lost_weights_ = 0, lost_frames_ = 0, lost_morphs_ = 0;
};

}  // namespace clarity::import
