#include "scene.hpp"
namespace fbx_import {
void add_skins_and_morphs(const Context&, const std::vector<SceneNode>&, const std::vector<SceneMesh>&,
                          std::map<uint32_t, std::vector<rt_u32>>&) {}
void add_clips(const Context&, const std::vector<SceneNode>&, const Views&, const std::map<uint32_t, std::vector<rt_u32>>&) {}
}  // namespace fbx_import
