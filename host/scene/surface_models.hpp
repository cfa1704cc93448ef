// surface_models.hpp -- the models of materials that plugins bring (rt_surface.h). A model's number holds for this process;
// files and other processes name models by their ids.
#pragma once
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "rt_surface.h"
#include "scene/key.hpp"

namespace clarity {

inline constexpr rt_u32 kMostSurfaceModels = 16;
// The bits of Optics::lobes of these models.
inline constexpr rt_u32 kSurfaceLobes = 0xffff0000u;
inline bool is_surface_model(rt_u32 model) {
    return model >= RT_MODEL_KINDS;
}
inline rt_u32 lobe_of_surface(rt_u32 model) {
    return 1u << (16 + model - RT_MODEL_KINDS);
}

struct SurfaceModel {
    std::string id;
    rt_u32 number = 0;                  // of the model
    const rt_plugin* plugin = nullptr;  // nullptr: only the number is known
    rt_surface surface{};
};

// Makes a plugin's model known, under the number that its id has already. Returns why it cannot be.
Problem add_surface_model(const rt_plugin& plugin, const rt_surface& surface);
// Gives these ids, which another process sent, the numbers that they have there: to be called before any model is added.
void number_surface_models(const std::vector<std::string>& ids);
std::vector<std::string> surface_model_ids();
// All that have a plugin, by their numbers.
std::vector<SurfaceModel> surface_models();

}  // namespace clarity
