// cache.cpp -- geometry caches that move a mesh.
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
    const double fps = context.fps > 0 ? context.fps : 30;
    try {
        importers::CacheFrames frames = importers::read_geometry_cache(context.place.folder + name, channel, mesh.points, fps);
        if (frames.positions.empty()) throw importers::BrokenCache("it has no channel " + quoted(channel));
        for (size_t i = 0; i < frames.positions.size(); ++i)
            frames.positions[i] = static_cast<float>(frames.positions[i] - mesh.origin[i % 3]);
        frames.pass(mesh.id, mesh.copy_of, context.sink);
    } catch (const std::runtime_error& why) {
        context.warn("the geometry cache " + quoted(name) + " is left out: " + why.what());
    }
}

}  // namespace fbx_import
