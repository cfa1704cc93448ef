// device_hits.hpp -- whether rays hit what they should in trees that the device has built or refitted.
#pragma once
#include "check/hits/hits_checks.hpp"

namespace clarity::check {

// The check `hits.device`. Arguments as those of hits_checks(); plugin and layout must outlive it.
Check device_hits_check(const rt_plugin& plugin, const rt_plugin* layout, const std::function<std::shared_ptr<Device>()>& open);

}  // namespace clarity::check
