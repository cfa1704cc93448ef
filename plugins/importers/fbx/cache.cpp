#include "scene.hpp"
namespace fbx_import {
void add_cache(const Context&, const SceneMesh&, uint32_t) {}
}
