// trial_arguments.hpp -- what the worker that tries kernels is told on its command line.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "render/kernels/scene_features.hpp"
#include "render/settings/settings.hpp"

namespace clarity {

struct TrialArguments {
    std::vector<std::pair<std::string, std::string>> libraries;  // as loaded, and the file that each stands for
    std::string device, device_name;                             // id as `--device` takes it; the worker skips another device
    SceneFeatures features;
    Settings settings;
    long parent = 0;  // read only
};

std::vector<std::string> words_of(const TrialArguments& arguments);
// argv[2] is the first word. Throws Error(usage).
TrialArguments read_trial_arguments(int argc, char** argv);

}  // namespace clarity
