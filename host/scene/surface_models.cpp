#include "scene/surface_models.hpp"

#include <cstring>
#include <deque>
#include <mutex>
#include <stdexcept>

#include "scene/material_keys.hpp"

namespace clarity {
namespace {

struct Known {
    std::mutex mutex;
    std::deque<SurfaceModel> models;  // which never move: their ids are words of a key
};
Known& known() {
    static auto& all = *new Known;
    return all;
}

// The model of that id, made if there is room. With the mutex.
SurfaceModel* numbered(const std::string& id) {
    std::deque<SurfaceModel>& models = known().models;
    for (SurfaceModel& model : models)
        if (model.id == id) return &model;
    if (models.size() == kMostSurfaceModels) return nullptr;
    SurfaceModel model;
    model.id = id;
    model.number = RT_MODEL_KINDS + static_cast<rt_u32>(models.size());
    models.push_back(std::move(model));
    add_model_word(models.back().number, models.back().id.c_str());
    return &models.back();
}

bool same_keys(const rt_surface& a, const rt_surface& b) {
    if (a.key_count != b.key_count) return false;
    for (rt_u32 i = 0; i < a.key_count; ++i)
        if (std::strcmp(a.keys[i].name, b.keys[i].name) != 0 || a.keys[i].kind != b.keys[i].kind) return false;
    return true;
}

std::vector<Key> keys_of(const SurfaceModel& model) {
    std::vector<Key> keys;
    size_t at = 0;  // in floats
    for (rt_u32 i = 0; i < model.surface.key_count; ++i) {
        const rt_surface_key& from = model.surface.keys[i];
        Key key;
        key.name = from.name;
        key.label = from.label;
        key.help = from.unit && *from.unit ? from.unit : from.help;
        key.more = from.unit && *from.unit ? from.help : "";
        key.kind = from.kind;
        key.min = from.min;
        key.max = from.max;
        for (size_t k = 0; k < 3; ++k) key.def[k] = static_cast<float>(from.def[k]);
        key.offset = sizeof(rt_material) + at * sizeof(float);
        key.models = 1u << model.number;
        at += count_of(key);
        keys.push_back(key);
    }
    return keys;
}

}  // namespace

Problem add_surface_model(const rt_plugin& plugin, const rt_surface& surface) {
    const std::lock_guard<std::mutex> lock(known().mutex);
    for (rt_u32 i = 0; i < surface.key_count; ++i)
        if (const Key* taken = find_key(material_keys(), surface.keys[i].name); taken && !is_key_of_surface(*taken))
            return std::string("its key '") + surface.keys[i].name + "' is one of all materials: take another name";
    SurfaceModel* const model = numbered(plugin.id);
    if (!model)
        return "there are " + std::to_string(kMostSurfaceModels) +
               " models of surfaces already, which are all that this host takes";
    const bool is_first = !model->plugin;
    if (!is_first && !same_keys(model->surface, surface))
        return "its keys are not those that it had when the program started: start it again";
    model->plugin = &plugin;
    model->surface = surface;
    if (is_first) add_material_keys(keys_of(*model));
    return {};
}

void number_surface_models(const std::vector<std::string>& ids) {
    const std::lock_guard<std::mutex> lock(known().mutex);
    for (size_t i = 0; i < ids.size(); ++i)
        if (const SurfaceModel* model = numbered(ids[i]); !model || model->number != RT_MODEL_KINDS + i)
            throw std::logic_error("models of surfaces get numbers of another process before any is added");
}

std::vector<std::string> surface_model_ids() {
    const std::lock_guard<std::mutex> lock(known().mutex);
    std::vector<std::string> ids;
    for (const SurfaceModel& model : known().models) ids.push_back(model.id);
    return ids;
}

std::vector<SurfaceModel> surface_models() {
    const std::lock_guard<std::mutex> lock(known().mutex);
    std::vector<SurfaceModel> models;
    for (const SurfaceModel& model : known().models)
        if (model.plugin) models.push_back(model);
    return models;
}

}  // namespace clarity
