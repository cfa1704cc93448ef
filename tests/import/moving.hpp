// moving.hpp -- a triangle that moves, for the importer of tests.
#pragma once
#include <string>

#include "rt_plugin.h"

namespace test_importer {

// Delivers a triangle on two nodes, with a clip of channels, a morph, a skin and vertex frames. fault: what of it is wrong; ""
// for nothing.
int32_t moving(const rt_host& host, const rt_scene_sink& sink, const std::string& fault);

}  // namespace test_importer
