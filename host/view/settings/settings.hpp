// settings.hpp -- everything that a user can tune, as one table for panel, command line, presets and tests.
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "rt_types.h"
#include "view/settings/crop.hpp"
#include "view/settings/optics.hpp"

namespace clarity {

// What the host must redo after a change of this setting, cheapest first. display: only how a traced film is shown. samples:
// nothing, more samples follow or fewer are asked for. frame: the next frame is traced anew.
enum class Effect { display, samples, frame, recompile, rebuild };

// Where the Render tab has the row. Both sides of a comparison share the rows of `picture`: their pictures must be comparable.
enum class SettingGroup { more, tracing, paths, picture };

// The greatest `depth`.
constexpr int kMostDepth = RT_MOST_DEPTH;

// The values of all settings.
struct Settings {
    // The structure.
    std::string accel;                 // id of an accel plugin; empty: the best for the device, see accel_choice.hpp
    std::vector<double> accel_params;  // in the order in which the plugin declares them; empty: defaults
    std::string poses = "auto";        // how the structure follows a scene that plays: auto|refit|build
    // How rays are traced.
    std::string tracer = "auto";
    int depth = 5;  // generations of rays, 1 = camera rays only; of `path` events of scattering
    // Pixels of one work-item. 0: automatic, 1x1 on a GPU; lanes x lanes on a CPU, but at least 4x4.
    int packet_w = 0, packet_h = 0;
    int lanes = 0;               // 1, 4, 8 or 16; 0: automatic
    int ray_slots = 8;           // rays that a pixel may have in one generation
    bool fast_math = false;      // -cl-fast-relaxed-math
    bool portable = false;       // the kernels' fallbacks instead of CPU instructions, for tests
    bool debug = false;          // kernels check the bounds of traversal stacks
    std::string trial = "auto";  // auto|on|off: whether edited kernels and strangers' run in a worker first
    // The picture.
    int width = 1024, height = 768;
    int spp = 1;         // samples per pixel
    double shutter = 0;  // share of a frame's time that the shutter is open; 0: no motion blur
    bool shadows = true;
    std::string mips = "auto";  // auto|off|nearest|smooth
    // Of the tracer `path`.
    std::string strategy = "mis";          // nee|bsdf|mis
    std::string mis = "power";             // balance|power
    std::string sampler = "sobol";         // independent|sobol
    std::string light_sampling = "table";  // table|tree
    std::string filter = "box";            // box|gaussian
    // The paths that count: found by nee|bsdf|any; whose first event is diffuse|glossy|transmission|any.
    std::string only_by = "any", only_first = "any";
    std::string aov = "color";  // a name of aov_table()
    // The display.
    double exposure = 1.0;
    std::string tone = "linear";     // linear|reinhard|aces|agx
    double scale_max = 0;            // value at the upper end of false colours; 0: the largest of the picture
    std::string denoise = "moving";  // off|moving|on
    // What only kernels read, by its key; without those that have their default. See number_of() and kernel_numbers().
    std::map<std::string, double> numbers = {};
    // Not for users: what views may have that the scene's own has not, so that kernels know it, too (optics_of()).
    Optics optics = {};
    // Not a row of the table: width and height are of a part of a picture (crop_picture()).
    Crop crop = {};
    int whole_width() const { return crop.whole_width > 0 ? crop.whole_width : width; }
    int whole_height() const { return crop.whole_height > 0 ? crop.whole_height : height; }
};

// Whether such a picture is shown and written without its noise. Not with `moving`: the window says `on` while something moves.
bool denoises(const Settings& settings);
// Throws Error(usage) for a pixel outside of the picture.
void check_pixel(const Settings& settings, unsigned x, unsigned y);
// Whether `path` picks lights by a light tree.
bool has_light_tree(const Settings& settings);
// Whether the samples of such a picture are spread in time, if the scene moves. Only colours are means of samples.
bool blurs(const Settings& settings);

// One row of the table: how to show, read and write a setting.
struct Setting {
    struct Button {
        std::string value, label;
    };
    enum class Kind { integer, real, boolean, choice, size };  // size: "WxH"
    std::string key, label, help;                              // help states the unit
    Kind kind = Kind::integer;
    double min = 0, max = 0;
    std::vector<std::string> choices;
    std::vector<Button> buttons;  // values for which the panel has a button; a choice is then no list
    Effect effect = Effect::rebuild;
    SettingGroup group = SettingGroup::more;
    // Whether another value gives another picture. Otherwise it says only how the picture is traced, so that a finished frame
    // stays valid. Pictures of costs always differ.
    bool changes_picture = true;
    std::function<std::string(const Settings&)> get;
    std::function<void(Settings&, const std::string&)>
        set;  // throws Error(usage), which says what was read and what is allowed
    std::function<bool(const Settings&, const Settings&)> equal;  // whether both have the same value
    std::function<void(Settings& to, const Settings& from)> copy;

    bool shared() const { return group == SettingGroup::picture; }
    bool at_once() const { return effect <= Effect::frame; }  // nothing must be prepared
    bool used(const Settings& settings) const;                // whether it is for the tracer that is chosen
    uint32_t bits(const Settings& settings) const;            // of a row of kernel_numbers(), as kernels get it
    // For the table.
    Setting in(SettingGroup of) const;
    Setting only_ways() const;  // changes_picture is false
    Setting only_of(const char* shown) const;
    Setting with_buttons(std::vector<Button> of) const;

    // TracerChoice::picture of the tracers that it is for; empty: for all.
    std::string picture = {};
    std::optional<double> number = {};  // of a row of kernel_numbers(): its default
};

// All settings but accel and its parameters, which come from the plugins (see parameters.hpp).
const std::vector<Setting>& settings_table();
// Returns nullptr if there is no such setting.
const Setting* find_setting(const std::string& key);
// Reads a value. Throws Error(usage); for an unknown key the message lists the known ones.
void set_setting(Settings& settings, const std::string& key, const std::string& value);

// The rows that have no member of Settings. Kernels read them by their keys: RT_SETTING(frame, min_weight).
const std::vector<const Setting*>& kernel_numbers();
// The value of such a row. Throws Error(usage) if there is none of that key.
double number_of(const Settings& settings, const std::string& key);

// Returns the names of the tone curves in the order of their numbers in cl/film.cl.
std::vector<std::string> tone_names();

// Throws Error(usage) "depth: `x` is not a whole number": key, value, what was expected.
[[noreturn]] void refuse_value(const std::string& key, const std::string& value, const std::string& expected);

// What settings, and all that stands on them, know of tracers.

// What Whitted's model gives: of tracers that shade by cl/shading/shading.h.
inline constexpr const char* kWhittedPicture = "whitted";
// What physics gives: of the tracer `path`.
inline constexpr const char* kPathPicture = "path";

struct TracerChoice {
    const char* id = "";    // of the setting `tracer`, and the name of its folders
    const char* help = "";  // for the setting
    const char* when = "";  // where `auto` takes it: "on a GPU if nothing refracts"; empty: where no other is taken
    // What its pictures show, with the same settings. Tracers of which it is the same make the same picture, apart from last
    // bits: a finished frame of one serves as one of the other, and a checkpoint goes on with the other.
    const char* picture = "";
};

// The tracers that users may choose, in their order. Defined with all tracers, in tracers/tracers.cpp, which is above.
const std::vector<TracerChoice>& tracer_choices();

// The choices of the setting `tracer`, `auto` first, and their help.
std::vector<std::string> tracer_names();
std::string tracer_help();
// TracerChoice::picture of the setting's value. Those that `auto` takes have the same.
std::string picture_of_tracer(const std::string& name);

}  // namespace clarity
