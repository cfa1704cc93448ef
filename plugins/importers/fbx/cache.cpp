// cache.cpp -- geometry caches that move a mesh.
#include <algorithm>
#include <cmath>

#include "../common/geometry_cache.hpp"
#include "scene.hpp"

namespace fbx_import {

// The cache hangs from the deformer. Its channel `<name>_normals` is left out: the host computes how normals turn.
void add_cache(const Context& context, const SceneMesh& mesh, uint32_t deformer) {
    const Properties p = context.properties(deformer);
    const std::string channel(p.text("ChannelName"));
    const std::vector<uint32_t> caches = context.objects.below(deformer, "Cache");
    if (caches.empty() || p.whole("Active", 1) == 0 || channel.find("_normals") != channel.npos) return;
    const Properties cache = context.properties(caches[0]);
    const std::string name = importers::with_slashes(std::string(cache.text("CacheFileName")));
    importers::CacheFrames frames;
    try {
        frames = importers::read_geometry_cache(context.place.folder + name, channel, mesh.points,
                                                context.fps > 0 ? context.fps : 30);
    } catch (const std::runtime_error& why) {
        context.warn("the geometry cache " + quoted(name) + " is left out: " + why.what());
        return;
    }
    if (frames.times.empty()) return context.warn("the geometry cache " + quoted(name) + " has no channel " + quoted(channel));
    // The copies of vertices follow the vertices of each frame.
    const size_t count = mesh.points + mesh.copy_of.size();
    std::vector<float> all;
    all.reserve(3 * count * frames.times.size());
    for (size_t f = 0; f < frames.times.size(); ++f) {
        const float* from = &frames.positions[3 * mesh.points * f];
        all.insert(all.end(), from, from + 3 * mesh.points);
        for (const uint32_t v : mesh.copy_of) all.insert(all.end(), from + 3 * size_t(v), from + 3 * size_t(v) + 3);
    }
    if (!std::all_of(all.begin(), all.end(), [](float x) { return std::isfinite(x); })) {
        return context.warn("the geometry cache " + quoted(name) + " is left out: it has values that are no finite numbers");
    }
    rt_vertex_frames out{};
    out.struct_bytes = sizeof out;
    out.mesh = mesh.id;
    out.frame_count = frames.times.size();
    out.times_s = frames.times.data();
    out.positions = all.data();
    if (context.sink.vertex_frames(context.sink.ctx, &out) != RT_OK) throw rt::Stopped();
}

}  // namespace fbx_import
