// settings.hpp -- everything a user can tune, as one table that serves panel, command line, presets and tests.
#pragma once
#include <functional>
#include <string>
#include <vector>

namespace clarity {

// What a change makes the host redo.
enum class Effect { frame, recompile, rebuild };

struct Settings {
    // How the scene is held.
    std::string accel;                 // id of an accel plugin; empty: the best for the device, see accel_choice.hpp
    std::vector<double> accel_params;  // in the order its plugin declares; empty: defaults
    // How it is traced.
    std::string tracer = "auto";
    int depth = 5;                   // generations of rays, 1 = camera rays only
    int packet_w = 0, packet_h = 0;  // pixels of one work-item; 0: 1x1 on a GPU, on a CPU lanes x lanes, 4x4 at least
    int lanes = 0;                   // 1, 4, 8, 16; 0: what suits the device
    int ray_slots = 8;               // rays a pixel may have in one generation
    bool fast_math = false;          // -cl-fast-relaxed-math
    bool portable = false;           // the kernels' fallbacks instead of CPU instructions, for tests
    bool debug = false;              // stack bounds checked in the kernels
    // What is traced.
    int width = 1024, height = 768;
    int spp = 1;  // samples a pixel
    bool shadows = true;
    double min_weight = 1.0 / 512.0;  // rays that would add less are not followed
    std::string aov = "color";        // a name of aov_table()
    // How it is shown.
    double exposure = 1.0;
    std::string tone = "linear";  // linear|reinhard|aces|agx
    double scale_max = 0;         // value at the upper end of false colours; 0: the largest of the picture
};

// One row: how to show, read and write a setting.
struct Setting {
    enum class Kind { integer, real, boolean, choice, size };  // size: "WxH"
    std::string key, label, help;                              // help states the unit
    Kind kind;
    double min = 0, max = 0;
    std::vector<std::string> choices;
    Effect effect;
    std::function<std::string(const Settings&)> get;
    std::function<void(Settings&, const std::string&)> set;  // throws Error(usage): what was read, what is allowed
};

// accel and its parameters are not in it: they come from the plugins (see parameters.hpp).
const std::vector<Setting>& settings_table();
// nullptr if there is none.
const Setting* find_setting(const std::string& key);
// Throws Error(usage); an unknown key lists the known ones.
void set_setting(Settings& settings, const std::string& key, const std::string& value);

}  // namespace clarity
