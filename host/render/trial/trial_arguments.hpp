// trial_arguments.hpp -- what the worker that tries kernels is told on its command line.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "render/kernels/scene_features.hpp"
#include "render/settings/settings.hpp"
#include "render/trial/trial_shapes.hpp"

namespace clarity {

inline constexpr const char* kFilmKernels = "film";

struct TrialArguments {
    std::string kernels;                           // the id of their tracer, or kFilmKernels
    std::map<std::string, std::string> libraries;  // from each as loaded to the file that it stands for
    std::string device, device_name;               // id as `--device` takes it; the worker skips another device
    SceneFeatures features;
    std::vector<TrialShape> shapes;
    Settings settings;
    long parent = 0;  // read only
};

std::vector<std::string> words_of(const TrialArguments& arguments);
// argv[2] is the first word. Throws Error(usage).
TrialArguments read_trial_arguments(int argc, char** argv);

}  // namespace clarity
