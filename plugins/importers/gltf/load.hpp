// load.hpp -- passes a whole document to the sink.
#pragma once
#include "document.hpp"
#include "rt_plugin.h"

namespace gltf_import {

void load_document(const Document& document, const rt_host* host, const rt_scene_sink& sink);

}  // namespace gltf_import
