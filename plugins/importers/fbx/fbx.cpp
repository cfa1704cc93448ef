// fbx.cpp -- the importer plugin for FBX files of the versions 3000 to 7700, binary and ASCII.
//
// The scene is imported as the file stores it: in its own pose, units and axes, with whole polygons. Motion is passed on as
// the file has it; the host computes poses.
#include <algorithm>

#include "../common/mapped_file.hpp"
#include "../common/text_lines.hpp"
#include "binary.hpp"
#include "scene.hpp"

namespace fbx_import {
namespace {

constexpr int kNewestVersion = 7700, kOldestVersion = 3000;

// UnitScaleFactor: centimetres per unit, 1 if the file does not say. Source: FBX SDK help, "FbxSystemUnit".
double metres_per_unit(const Document& document, const Objects& objects) {
    const double centimetres = Properties(document, objects.settings()).number("UnitScaleFactor", 1);
    return 0.01 * (centimetres > 1e-6 && centimetres < 1e30 ? centimetres : 1);
}

rt_scene_info info_of(const Context& context) {
    const Properties settings(context.document, context.objects.settings());
    rt_scene_info info{};
    info.struct_bytes = sizeof info;
    info.up_axis = static_cast<rt_u32>(std::clamp<int64_t>(settings.whole("UpAxis", 1), 0, 2));
    info.unit_scale = context.metres_per_unit;
    return info;
}

int32_t load_file(const rt_host* host, const char* given_path, const double*, const rt_scene_sink* sink) {
    const std::string path = given_path;
    const importers::MappedFile file(host, path);
    const Document document(file.bytes());
    const int version = document.version();
    if (version > 0 && version < kOldestVersion)
        throw Broken("the file says that it has FBX version " + std::to_string(version) + "; expected 3000 to 7700");
    const Objects objects(document);
    const Templates templates(document);
    const double fps = frames_of_second(document, objects);
    const Context context = {host,
                             *sink,
                             file,
                             document,
                             objects,
                             templates,
                             importers::FilePlace(path),
                             fps,
                             metres_per_unit(document, objects),
                             document.text(&document.root(), "Creator").rfind("Blender", 0) == 0};
    if (!RT_HAS(sink, rt_scene_sink, vertex_frames)) throw Broken("this importer needs a newer version of the program");
    if (version >= kNewestVersion + 300) context.warn("the file's FBX version is newer than 7.7, the newest known");
    const rt_scene_info info = info_of(context);
    sink->info(sink->ctx, &info);
    const std::vector<SceneNode> nodes = read_nodes(context);
    if (nodes.empty()) throw Broken("contains no nodes: the list of its objects is empty or was never written");
    rt::progress(host, 0.1f);
    const std::vector<SceneMesh> meshes = add_meshes(context, nodes);
    if (meshes.empty()) context.warn("contains no polygons (points, lines, NURBS and the like were skipped)");
    const Views views = add_views(context, nodes);
    Morphs morphs;
    add_deformers(context, nodes, meshes, morphs);
    add_clips(context, nodes, views, morphs);
    return RT_OK;
}

// How certainly a file with these first bytes is an FBX file: 0 to 100.
int32_t probe(const uint8_t* head, uint64_t bytes) {
    std::string_view text(reinterpret_cast<const char*>(head), bytes);
    if (text.substr(0, kMagic.size()) == kMagic) return 100;
    text = importers::without_mark(text);
    text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
    const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
    if (line.substr(0, 1) == ";" && line.find("FBX") != line.npos) return 95;
    return line.substr(0, 18) == "FBXHeaderExtension" ? 95 : 0;
}

constexpr const char* extensions[] = {"fbx", nullptr};
constexpr rt_importer importer = {sizeof(rt_importer), extensions, probe, rt::guarded<load_file>, RT_IMPORTER_TAKES_CONTENT, 0};

}  // namespace
}  // namespace fbx_import

extern "C" RT_EXPORT const rt_plugin rt_plugin_v1 =
    rt::importer_plugin("fbx", "FBX, versions 3000 to 7700", "1.0.0", nullptr, fbx_import::importer);
