#include "cli/option_groups.hpp"

#include <cstdio>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "import/importer_choice.hpp"

namespace clarity {
namespace {

std::string setting_help(const Setting& setting) {
    static const Settings defaults;
    std::string range;
    char text[64];
    switch (setting.kind) {
        case Setting::Kind::integer:
        case Setting::Kind::real:
            std::snprintf(text, sizeof text, "%g to %g", setting.min, setting.max);
            range = text;
            break;
        case Setting::Kind::boolean:
            range = "true, false";
            break;
        case Setting::Kind::choice:
            for (const std::string& choice : setting.choices) range += (range.empty() ? "" : ", ") + choice;
            break;
        case Setting::Kind::size:
            std::snprintf(text, sizeof text, "WxH, each %g to %g", setting.min, setting.max);
            range = text;
            break;
    }
    return setting.help + " (" + range + "; default " + setting.get(defaults) + ")";
}

std::string option_name(std::string key) {
    for (char& c : key)
        if (c == '_') c = '-';
    return "--" + key;
}

// From "bounce=2,by=nee" to the settings only_bounce and only_by.
void add_only_paths(const std::string& text, std::vector<std::pair<std::string, std::string>>& settings) {
    for (size_t at = 0; at <= text.size();) {
        const size_t end = std::min(text.find(',', at), text.size()), equals = text.find('=', at);
        const std::string key = equals < end ? "only_" + text.substr(at, equals - at) : "";
        if (key.empty() || !find_setting(key))
            throw Error(Exit::usage, "--only-paths " + text + ": `" + text.substr(at, end - at) +
                                         "` is not bounce=K, by=nee|bsdf, first=diffuse|glossy|transmission or light=N");
        settings.emplace_back(key, text.substr(equals + 1, end - equals - 1));
        at = end + 1;
    }
}

}  // namespace

CLI::Option* single(CLI::Option* option) {
    return option->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
}

void add_common(CLI::App& app, CommonOptions& common) {
    app.add_option("--plugin", common.plugin_files, "A plugin library to load before all others; may be repeated")
        ->type_name("FILE")
        ->allow_extra_args(false);
    auto* verbose = app.add_flag("-v,--verbose", common.verbose, "Log debug messages too");
    app.add_flag("-q,--quiet", common.quiet, "Warnings and errors only, no progress bar")->excludes(verbose);
    single(app.add_option("--log-file", common.log_file, "Append the log, with times, to this file"))->type_name("FILE");
    single(app.add_option("--trace", common.timeline_file,
                          "Record what the program and its devices do, and when, for Perfetto or chrome://tracing (.json)"))
        ->type_name("FILE");
}

CLI::Option* add_scene(CLI::App& app, SceneOptions& scene) {
    app.add_option("--search-path", scene.import.search_paths,
                   "A folder which the scene may read files from, besides its own; may be repeated")
        ->type_name("DIR")
        ->allow_extra_args(false);
    app.add_option("--importer", scene.import.importers,
                   "Parameters of an importer (`clarity plugins` lists them); may be repeated")
        ->type_name("ID,key=value...")
        ->allow_extra_args(false);
    app.add_flag_callback(
        "--undeformed", [&scene] { scene.import.importers.push_back(import::kUndeformed); },
        "At rest, show meshes as their files store them: neither skins nor morphs move them");
    app.add_flag("--import-in-process", scene.import.in_process,
                 "Run importers in this process, to debug them; a crash then ends the program");
    return app.add_option("scene", scene.files, "Scene or model files; several become one scene")->type_name("FILE");
}

void add_settings(CLI::App& app, std::vector<std::pair<std::string, std::string>>& settings, std::vector<std::string>& sets) {
    for (const Setting& setting : settings_table()) {
        const auto set = [&settings, key = setting.key](const std::string& value) { settings.emplace_back(key, value); };
        single(app.add_option_function<std::string>(option_name(setting.key), set, setting_help(setting)))
            ->type_name(setting.kind == Setting::Kind::size ? "WxH" : "VALUE")
            ->group("Settings");
    }
    app.add_option("--set", sets, "A setting as key=value (ray_slots=16); may be repeated")
        ->type_name("key=value")
        ->allow_extra_args(false)
        ->group("Settings");
}

void add_device(CLI::App& app, TraceOptions& trace) {
    single(app.add_option("--device", trace.device,
                          "Numbers as `clarity devices` lists them, P:D, cpu, gpu, part of a name; several share the picture: "
                          "0,1 or gpus or all; cpu/2 is a CPU in two parts"))
        ->type_name("D");
    single(app.add_option("--accel", trace.accel, "Acceleration structure with its parameters (`clarity plugins` lists them)"))
        ->type_name("ID[,key=value...]")
        ->default_str("the one of highest merit for the device");
}

void add_trace(CLI::App& app, TraceOptions& trace) {
    add_device(app, trace);
    single(app.add_option("--camera", trace.camera, "A camera of the scene by name, or its position and target"))
        ->type_name("NAME|ex,ey,ez,tx,ty,tz[,fov_deg]");
    single(app.add_option("--light", trace.light, "Move the first light here"))->type_name("x,y,z");
    single(app.add_option_function<std::string>(
               "--only-paths", [&trace](const std::string& text) { add_only_paths(text, trace.settings); },
               "Of the tracer path: only light of these paths. bounce: number of events; by: nee, bsdf; first: diffuse, "
               "glossy, transmission; light: number of a lamp"))
        ->type_name("bounce=K,by=B,first=F,light=N");
    single(app.add_option("--preset", trace.preset, "Settings and view saved from the window; other options override it"))
        ->type_name("FILE");
    add_settings(app, trace.settings, trace.sets);
    app.get_option("--set")->description(
        "A setting as key=value (ray_slots=16), or a change of the view: "
        "camera=ex,ey,ez,tx,ty,tz,fov,ux,uy,uz, camera.aperture=f, camera.focus=f, background=r,g,b, ambient=r,g,b, "
        "sky=KIND, sky.KEY=value, "
        "light.N=off|point,x,y,z,r,g,b|rect,..., light.N.KEY=value, material.N.KEY=value (keys of text scenes, also maps: a "
        "texture or a picture's file), "
        "hide=3,5-9 (instances); may be repeated");
}

void add_pose(CLI::App& app, PoseOptions& pose) {
    single(app.add_option("--time", pose.time_s, "Show the scene at this time of the clip, seconds; default: at rest"))
        ->type_name("SECONDS");
    single(app.add_option("--clip", pose.clip,
                          "Which clip of the file moves the scene, by name or number; default: the first one"))
        ->type_name("NAME|N");
}

CLI::Validator percent() {
    return CLI::Validator(
        [](std::string& text) {
            double share = 0;
            if (!read_share(text, share)) return "`" + text + "` is no share, such as 0.05 or 5%";
            text = exact_text(share);
            return std::string();
        },
        "");
}

}  // namespace clarity
