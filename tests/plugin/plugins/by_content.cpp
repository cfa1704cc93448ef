// An importer that recognises its files by their first bytes.
#include <algorithm>
#include <cstring>

#include "rt_plugin.hpp"

static int32_t probe(const uint8_t* head, uint64_t bytes) {
    const auto begins = [&](const char* word) {
        return bytes >= std::strlen(word) && std::equal(word, word + std::strlen(word), head);
    };
    if (begins("THROW")) throw 1;  // plugins must not throw; the host must cope with one that does
    return begins("MAGIC") ? 100 : begins("MAYBE") ? 20 : 0;
}
static int32_t load(const rt_host*, const char*, const double*, const rt_scene_sink*) {
    return RT_OK;
}

static const char* const kExtensions[] = {"magic", nullptr};
static const rt_importer kImporter = {sizeof(rt_importer), kExtensions, probe, rt::guarded<load>, 0, 0};

const rt_plugin rt_plugin_v1 = rt::importer_plugin("by_content", "By content", "1.0", nullptr, kImporter);
