#include "cli/render/aov_layers.hpp"

#include <algorithm>
#include <utility>

#include "render/settings/aov.hpp"

namespace clarity {

RenderOptions with_all_aovs(const RenderOptions& options) {
    RenderOptions result = options;
    auto& pairs = result.trace.settings;
    auto& sets = result.trace.sets;
    // The last one counts, and an option of its own overrides --set.
    const auto is_aov = [](const auto& pair) { return pair.first == "aov"; };
    const auto pair = std::find_if(pairs.rbegin(), pairs.rend(), is_aov);
    const auto set =
        std::find_if(sets.rbegin(), sets.rend(), [](const std::string& word) { return word.rfind("aov=", 0) == 0; });
    const bool all = pair != pairs.rend() ? pair->second == "all" : set != sets.rend() && *set == "aov=all";
    if (!all) return result;
    result.all_aovs = true;
    pairs.erase(std::remove_if(pairs.begin(), pairs.end(), is_aov), pairs.end());
    sets.erase(std::remove_if(sets.begin(), sets.end(), [](const std::string& word) { return word.rfind("aov=", 0) == 0; }),
               sets.end());
    pairs.emplace_back("aov", aov_table().front().name);  // of a preset, too
    return result;
}

std::vector<PictureLayer> trace_aov_layers(MultiFrameRenderer& frames, MultiPreparer& preparer,
                                           const std::shared_ptr<const Scene>& scene, const View& view, Settings settings,
                                           Progress& progress) {
    std::vector<PictureLayer> layers;
    settings.spp = 1;
    for (const Aov& aov : aov_table()) {
        if (aov.about != Aov::About::first_hit) continue;
        settings.aov = aov.name;
        frames.trace(preparer.prepare(scene, settings, progress), settings, view, 0, false, progress);
        layers.push_back({aov.name, frames.read_values()});
    }
    return layers;
}

}  // namespace clarity
