#include "plugin/extensions.hpp"

#include <cstring>

#include "plugin/abi_struct.hpp"

namespace clarity {

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
