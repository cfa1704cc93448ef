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

}  // namespace clarity
