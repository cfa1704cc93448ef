// trial_job.hpp -- what a trial of kernels in a worker takes. It returns why there was no trial, through no fault of the
// kernels; an empty text says that they have passed.
#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/files/parcel.hpp"
#include "render/kernels/scene_features.hpp"
#include "render/settings/settings.hpp"
#include "render/trial/trial_shapes.hpp"

namespace clarity {

inline constexpr const char* kFilmKernels = "film";

struct TrialJob {
    std::string kernels;                           // the id of their tracer, or kFilmKernels
    std::map<std::string, std::string> libraries;  // from each as loaded to the file that it stands for
    std::string device, device_name;               // id as `--device` takes it; the worker skips another device
    std::vector<std::string> surfaces;             // ids of models that plugins bring, by their numbers
    SceneFeatures features;
    std::vector<TrialShape> shapes;
    Settings settings;

    template <class Parcel, class Self>
    static void visit(Parcel& parcel, Self& self) {
        std::vector<std::pair<std::string, std::string>> texts;  // of the settings
        if constexpr (Parcel::kWrites)
            for (const Setting& setting : settings_table()) texts.emplace_back(setting.key, setting.get(self.settings));
        parcel(self.kernels, self.libraries, self.device, self.device_name, self.surfaces, self.features, self.shapes,
               self.settings.accel, self.settings.accel_params, texts);
        if constexpr (!Parcel::kWrites)
            for (const auto& [key, value] : texts) set_setting(self.settings, key, value);
    }
};

// The work of the job.
void trial_job(ParcelReader& arguments);

}  // namespace clarity
