#include "plugin/capabilities.hpp"

#include <cstring>

#include "plugin/abi_struct.hpp"

namespace clarity {

const std::vector<Capability>& capabilities() {
    static const std::vector<Capability> all = {{RT_TRAVERSES_STREAMS, "streams", "RT_TRAVERSES_STREAMS"},
                                                {RT_TRAVERSES_STEPS, "steps", "RT_TRAVERSES_STEPS"},
                                                {RT_TRAVERSES_WARPS, "warps", "RT_TRAVERSES_WARPS"},
                                                {RT_REQUEUES_LONG_RAYS, "requeues_long_rays", "RT_REQUEUES_LONG_RAYS"},
                                                {RT_SPLITS_INCOHERENT, "splits_incoherent", "RT_SPLITS_INCOHERENT"},
                                                {RT_BUILDS_GROUPS, "builds_groups", "RT_BUILDS_GROUPS"},
                                                {RT_TRAVERSES_SINGLE_RAYS, "single_rays", "RT_TRAVERSES_SINGLE_RAYS"}};
    return all;
}

std::vector<std::string> capability_names(const rt_accel& accel) {
    std::vector<std::string> names;
    for (const Capability& capability : capabilities())
        if (accel.capabilities & capability.bit) names.push_back(capability.name);
    return names;
}

rt_refit refit_of(const rt_plugin& plugin) {
    for (const rt_extension* e = plugin.extensions; e && e->name; ++e)
        if (std::strcmp(e->name, RT_REFIT) == 0 && e->version == RT_REFIT_VERSION && plugin.accel)
            return copied<rt_refit>(e->data, e->data_bytes);
    return {};
}

rt_device_build device_build_of(const rt_plugin& plugin) {
    for (const rt_extension* e = plugin.extensions; e && e->name; ++e)
        if (std::strcmp(e->name, RT_DEVICE_BUILD) == 0 && e->version == RT_DEVICE_BUILD_VERSION && plugin.accel)
            return copied<rt_device_build>(e->data, e->data_bytes);
    return {};
}

}  // namespace clarity
