// built_checks.hpp -- what is built in other ways than usual is traced, too: with other parameters, packed from another
// builder's tree, refitted, empty, and large.
#pragma once
#include "tools/check/hits/hit_stand.hpp"
#include "tools/check/hits/hits_checks.hpp"

namespace clarity::check {

// The checks, in the order in which they run.
std::vector<Check> built_checks(const StandInput& input);

// Whether rays hit what they should in trees that the device has built or refitted.

// The check `hits.device`. Arguments as those of hits_checks(); plugin and layout must outlive it.
Check device_hits_check(const rt_plugin& plugin, const rt_plugin* layout, const std::function<std::shared_ptr<Device>()>& open);

// Whether rays that run exactly along planes of boxes and cells hit what they should.

// The check `hits.planes`.
Check planes_check(const StandInput& input);

// Whether a traversal asks the host where it must: before its stack grows, and about each primitive.

// No stack is full, over the mixed scene, over meshes that are far deeper than their world, and over rows, which fill it.
Outcome stack_check(const StandInput& input, HitStand& mixed, HitStand& regular, const Step& step);
// What asks RT_STACK_OK before each push finds next to nothing once that is always refused.
Outcome pushes_check(const StandInput& input, const Step& step);
// Rays that meet the boxes of all primitives go on to the end.
Outcome crowd_check(const StandInput& input, const Step& step);
// Every hit was tested by the host's function.
Outcome counts_check(const StandInput& input, const Step& step);

// Whether a structure's hits are right in a scene and for rays of the user's own. The scene has no shapes: only their plugins
// know where rays meet them.
Check own_scene_check(const StandInput& input, Scene scene, const std::vector<rt_ray>& rays);

}  // namespace clarity::check
