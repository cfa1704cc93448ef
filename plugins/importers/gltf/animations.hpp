// animations.hpp -- passes the file's animations to the host as clips.
#pragma once
#include <set>

#include "accessors.hpp"
#include "meshes.hpp"
#include "nodes.hpp"
#include "rt_plugin.h"

namespace gltf_import {

// The nodes that have weights of morphs which an animation changes.
std::set<size_t> nodes_with_animated_weights(const Document& document);

// A channel that is wrong is left out, with a warning; so is an animation that moves nothing then.
void add_animations(const Document& document, Accessors& accessors, const NodeTree& tree, const Meshes& meshes,
                    const rt_scene_sink& sink);

}  // namespace gltf_import
