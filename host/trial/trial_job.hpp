// trial_job.hpp -- what a trial of kernels in a worker takes. It returns why there was no trial, through no fault of the
// kernels; an empty text says that they have passed. And shapes of the user's scene.
#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/files/parcel.hpp"
#include "kernels/scene_features.hpp"
#include "scene/scene.hpp"
#include "view/settings/settings.hpp"
#include "worker/job.hpp"

namespace clarity {

// Some shapes of a user's scene, which the scene of a trial gets too: kernels of shapes run on numbers that
// their own plugin has made.

struct TrialShape {
    std::string id;  // of the plugin
    struct Part {
        ShapePart part;
        std::vector<float> more;  // its range of Scene::shape_numbers
        CLARITY_MEMBERS(part, more);
    };
    std::vector<Part> parts;
    CLARITY_MEMBERS(id, parts);
};

// Up to three shapes of each kind, with up to four parts each; fewer if they have very many numbers. A shape may lose parts.
std::vector<TrialShape> sample_shapes(const Scene& scene);
// Adds one of them to a scene, so that it fits into a ball of this centre and radius. kind: index in Scene::shape_kinds.
void add_shape(Scene& scene, const TrialShape& shape, rt_u32 kind, rt_u32 material, const std::array<float, 3>& center,
               float radius);

extern const worker::JobKind kTrialJob;

inline constexpr const char* kFilmKernels = "film";

// All that a user can say, by the table of settings.
struct SentSettings : Settings {
    template <class Parcel, class Self>
    static void visit(Parcel& parcel, Self& self) {
        std::vector<std::pair<std::string, std::string>> texts;
        if constexpr (Parcel::kWrites)
            for (const Setting& setting : settings_table()) texts.emplace_back(setting.key, setting.get(self));
        parcel(self.accel, self.accel_params, texts);
        if constexpr (!Parcel::kWrites)
            for (const auto& [key, value] : texts) set_setting(self, key, value);
    }
};

struct TrialJob {
    std::string kernels;                           // the id of their tracer, or kFilmKernels
    std::map<std::string, std::string> libraries;  // from each as loaded to the file that it stands for
    std::string device, device_name;               // id as `--device` takes it; the worker skips another device
    std::vector<std::string> surfaces;             // ids of models that plugins bring, by their numbers
    SceneFeatures features;
    std::vector<TrialShape> shapes;
    // Of the user's structure, where kernels' arrays are as large as its tree is deep. Those of the small scene count if they
    // are larger.
    std::map<std::string, rt_u32> defines;
    SentSettings settings;

    CLARITY_MEMBERS(kernels, libraries, device, device_name, surfaces, features, shapes, defines, settings);
};

}  // namespace clarity
