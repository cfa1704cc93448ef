// An importer that recognises its files only by their extension.
#include "rt_plugin.hpp"

static int32_t load(const rt_host*, const char*, const double*, const rt_scene_sink*) {
    return RT_OK;
}

static const char* const kExtensions[] = {"shape", nullptr};
static const rt_importer kImporter = {sizeof(rt_importer), kExtensions, nullptr, rt::guarded<load>, 0, 0};

const rt_plugin rt_plugin_v1 = rt::importer_plugin("by_name", "By extension", "1.0", nullptr, kImporter);
