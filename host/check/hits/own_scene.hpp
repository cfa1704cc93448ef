// own_scene.hpp -- whether a structure's hits are right in a scene and for rays of the user's own.
#pragma once
#include <memory>
#include <vector>

#include "check/hits/hits_checks.hpp"
#include "scene/scene.hpp"

namespace clarity::check {

// layout and open: as for hits_checks(). The scene has no shapes: only their plugins know where rays meet them.
Check own_scene_check(const rt_plugin& plugin, const rt_plugin* layout, const std::function<std::shared_ptr<Device>()>& open,
                      const HitsOptions& options, Scene scene, std::vector<rt_ray> rays);

}  // namespace clarity::check
