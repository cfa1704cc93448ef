// plane_checks.hpp -- whether rays that run exactly along planes of boxes and cells hit what they should.
#pragma once
#include "check/hits/hits_checks.hpp"

namespace clarity::check {

// The check `hits.planes`. Arguments as those of hits_checks(); plugin and layout must outlive it.
Check planes_check(const rt_plugin& plugin, const rt_plugin* layout, const std::function<std::shared_ptr<Device>()>& open,
                   const HitsOptions& options);

}  // namespace clarity::check
