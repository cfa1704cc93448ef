// emit_motion.hpp -- passes `animate` to the sink: a node for everything that moves, one clip, and its channels.
#pragma once
#include <array>
#include <map>
#include <string>
#include <vector>

#include "document.hpp"

namespace scene_format {

class MotionEmitter {
 public:
    MotionEmitter(const Document& document, const rt_scene_sink& sink) : document_(document), sink_(sink) {}
    // Emits all nodes, the clip and its channels. Returns false if the sink refused something.
    bool emit();
    // To be called for each camera, after emit(), with the id that the sink gave it.
    bool emit_fov(const Camera& camera, rt_u32 id) const;
    // Ids of nodes; 0 for what does not move. The node of a load has its whole placement, that of a camera or point light its
    // position.
    rt_u32 node_of_load(const Load& load) const { return node_of(load.name); }
    rt_u32 node_of_camera(const Camera& camera) const { return node_of(camera.name); }
    rt_u32 node_of_light(const Light& light) const { return node_of(light.name); }

 private:
    rt_u32 node_of(const Name& name) const;
    rt_u32 add_node(const std::string& name) const;
    bool add_channels(const Animation& animation, rt_u32 node, rt_u32 clip) const;

    const Document& document_;
    const rt_scene_sink& sink_;
    std::map<std::string, rt_u32> nodes_;
    rt_u32 clip_ = RT_NONE;
};

}  // namespace scene_format
