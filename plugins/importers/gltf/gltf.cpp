// gltf.cpp -- the importer plugin for glTF 2.0.
//
// Facts about the format are from the Khronos Group's glTF 2.0 specification (2021) and its register of extensions. JSON
// is parsed by nlohmann-json, after its syntax was checked.
#include <new>
#include <string_view>

#include "load.hpp"
#include "rt_plugin.hpp"

namespace gltf_import {
namespace {

int32_t load(const rt_host* host, const char* path, const double*, const rt_scene_sink* sink) {
    try {
        load_document(Document(host, path), host, *sink);
    } catch (const std::bad_alloc&) {
        throw rt::fail(host, "needs more memory than an import may take: split it into several files");
    }
    return RT_OK;
}

int32_t probe(const uint8_t* head, uint64_t bytes) {
    const std::string_view text(reinterpret_cast<const char*>(head), bytes);
    if (text.substr(0, 4) == "glTF") return 100;
    const size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
    return first != text.npos && text[first] == '{' && text.find("\"asset\"") != text.npos ? 60 : 0;
}

constexpr const char* kExtensions[] = {"gltf", "glb", "vrm", nullptr};
constexpr rt_importer kImporter = {sizeof(rt_importer), kExtensions, probe, rt::guarded<load>, RT_IMPORTER_TAKES_CONTENT, 0};

}  // namespace
}  // namespace gltf_import

extern "C" RT_EXPORT const rt_plugin rt_plugin_v1 =
    rt::importer_plugin("gltf", "glTF 2.0 (.gltf, .glb)", "1.0.0", nullptr, gltf_import::kImporter);
