#include "view/edit/edit.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <sstream>

#include "base/angle.hpp"
#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/files/read_file.hpp"
#include "base/numbers.hpp"
#include "scene/light_kinds.hpp"
#include "view/edit/sky_edit.hpp"
#include "view/view.hpp"

namespace clarity {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCamera = "saved_view";  // the name of the camera that is written
constexpr const char* kPicture = "picture_";   // the names of textures, with a number

std::string spaced(const float* values, size_t count) {
    std::string text;
    for (size_t i = 0; i < count; ++i) text += " " + exact_text(values[i]);
    return text;
}
template <class Array>
std::string spaced(const Array& values) {
    return spaced(values.data(), values.size());
}

fs::path whole(const std::string& path) {
    std::error_code error;
    const fs::path canonical = fs::weakly_canonical(fs::absolute(path, error), error);
    return error ? fs::path(path) : canonical;
}

// A name or a path in quotes, which have no escapes.
std::string quoted(const std::string& text, const std::string& what) {
    if (text.find_first_of("\"\n\r") != std::string::npos)
        throw Error(Exit::failed, what + ": cannot be named in a text scene, because its name holds a quote; rename it");
    return "\"" + text + "\"";
}

bool is_below(const fs::path& file, const fs::path& folder) {
    const fs::path relative = file.lexically_relative(folder);
    return !relative.empty() && *relative.begin() != "..";
}

// Degrees that a reader, who computes with floats, turns into these radians.
float degrees_of(float fov_rad) {
    constexpr float kRad = static_cast<float>(kPi) / 180.0f;
    const auto nearest = static_cast<float>(double{fov_rad} / kRadPerDegree);
    const float limits[] = {-std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity()};
    for (const float limit : limits)
        for (float degrees = nearest, i = 0; i < 4; ++i, degrees = std::nextafter(degrees, limit))
            if (degrees * kRad == fov_rad) return degrees;
    return nearest;
}

std::string camera_lines(const EditedView& edited, const std::array<double, 3>& origin) {
    if (!edited.camera_path.empty()) return animate_lines(edited.camera_path, kCamera, origin);
    const Camera& camera = edited.view.camera;
    return std::string("camera ") + kCamera + "  eye " + point_text(camera.eye.data(), origin, " ") + "  target " +
           point_text(camera.target.data(), origin, " ") + "  up" + spaced(camera.up) + "  fov " +
           exact_text(std::clamp(degrees_of(camera.fov_y_rad), 0.1f, 179.0f)) + lens_words(camera) + "\n";
}

std::string surroundings(const View& view) {
    return "background" + spaced(view.background) + "\nambient" + spaced(view.ambient) + "\n";
}

std::string instance_lines(const InstanceEdits& before, const InstanceEdits& now) {
    std::map<rt_u32, std::string> of_instance;
    for (const InstanceEdits* edits : {&before, &now}) {
        for (const InstanceEdits::Moved& moved : edits->moved) of_instance[moved.instance];
        for (const rt_u32 i : edits->hidden) of_instance[i];
        for (const auto& [i, mask] : edits->masks) of_instance[i];
    }
    std::string lines;
    for (auto& [i, text] : of_instance) {
        const InstanceShift was = before.shift_of(i), is = now.shift_of(i);
        if (was.translate != is.translate) text += "  translate" + spaced(is.translate);
        if (was.degrees != is.degrees) text += "  rotate" + spaced(is.degrees);
        if (was.scale != is.scale) text += "  scale" + spaced(is.scale);
        if (before.is_hidden(i) != now.is_hidden(i)) text += now.is_hidden(i) ? "  hidden 1" : "  hidden 0";
        if (before.mask_of(i) != now.mask_of(i)) text += "  mask " + std::to_string(now.mask_of(i));
        if (!text.empty()) lines += "edit instance " + std::to_string(i) + text + "\n";
    }
    return lines;
}

// "edit light 3 spot  position 1 2 3  angle 30": all that the light is made of.
std::string light_line(const std::string& object, const rt_light& light, const std::array<double, 3>& origin) {
    std::string line = object + " " + light_kind_of(light).name;
    for (const Key& key : light_kind_of(light).keys) {
        if (key.alias) continue;
        const std::array<float, 3> value = edit_value(key, light);
        line += "  " + std::string(key.name) + " " +
                (key.moves == Moves::point ? point_text(value.data(), origin, " ") : value_text(key, value, " "));
    }
    return line;
}

// The words of edit.hpp as statements: "material.3.color" and "1,0,0" become "edit material 3  color 1 0 0". Words for one
// material follow each other, and go into one line. Others than those of materials, lights and the sky are left out.
std::string word_lines(const std::vector<Word>& words, const Scene& scene, const View& view,
                       const std::map<std::string, std::string>& statements) {
    std::string lines, last;
    if (std::any_of(words.begin(), words.end(), [](const Word& word) { return word.key.rfind("sky", 0) == 0; }))
        lines = "edit sky " + sky_line(sky_of(scene, view));
    for (const Word& word : words) {
        std::istringstream key(word.key);
        std::string what, number, part, value = word.value;
        std::getline(key, what, '.'), std::getline(key, number, '.'), std::getline(key, part, '.');
        // A light's line has all of its parts.
        if (what != "material" && (what != "light" || !part.empty())) continue;
        if (map_use_of(word.key) == RT_NONE)
            std::replace(value.begin(), value.end(), ',', ' ');
        else
            value = quoted(statements.count(value) ? statements.at(value) : value, word.key);
        const std::string object = "edit " + what + " " + number;
        if (object != last) lines += lines.empty() ? "" : "\n";
        if (what == "material")
            lines += (object == last ? "" : object) + "  " + part + " " + value;
        else
            lines += value == "off" ? object + " off" : light_line(object, view.lights[std::stoul(number)], scene.origin);
        last = what == "material" ? object : "";
    }
    return lines.empty() ? "" : lines + "\n";
}

// The path of a file in statements of a scene that lies in this folder.
std::string written_path(const std::string& file, const fs::path& folder) {
    const fs::path path = whole(file);
    return quoted(is_below(path, folder) ? path.lexically_relative(folder).generic_string() : path.generic_string(), file);
}

// Statements of the pictures that words name by their files. statements: their names, by the files.
// kept: text that stays in the file.
std::string picture_lines(const std::vector<Word>& words, const Scene& scene, const fs::path& folder, const std::string& kept,
                          std::map<std::string, std::string>& statements) {
    std::string lines;
    size_t number = 0;
    for (const Word& word : words) {
        const bool is_map = map_use_of(word.key) != RT_NONE;
        if (!is_map || !is_picture_name(word.value) || statements.count(word.value)) continue;
        const auto& names = scene.texture_names;
        std::string name;
        do name = kPicture + std::to_string(++number);
        while (std::find(names.begin(), names.end(), name) != names.end() || kept.find(name) != std::string::npos);
        statements[word.value] = name;
        lines += "texture " + name + " " + written_path(word.value, folder) + "\n";
    }
    return lines;
}

// base: what the statements that are loaded show without these lines.
std::string edit_lines(const SceneToSave& scene, const EditedView& base, const fs::path& folder, const std::string& kept) {
    const std::vector<Word> words = edits_between(scene.imported, base, scene.edited);
    std::map<std::string, std::string> statements;
    const std::string pictures = picture_lines(words, scene.imported, folder, kept, statements);
    return pictures + instance_lines(base.instances, scene.edited.instances) +
           word_lines(words, scene.imported, scene.edited.view, statements);
}

// The view without any edit; a scene without lights has none to start from.
EditedView plain(const Scene& scene) {
    EditedView view;
    for (const Light& light : scene.lights) view.view.lights.push_back(light.values);
    for (const Material& material : scene.materials) view.view.materials.push_back(material.values);
    return view;
}

std::string load_line(const std::string& file, const fs::path& folder) {
    return "load " + written_path(file, folder) + "\n";
}

// The first two words of a line, and whether it begins a statement that save_scene() writes itself.
bool is_ours(const std::string& line) {
    std::istringstream in(line);
    std::string word, name;
    in >> word >> name;
    const bool of_camera = (word == "camera" || word == "animate") && name == kCamera;
    return of_camera || word == "edit" || word == "background" || word == "ambient";
}

std::string kept_lines(const std::string& text) {
    std::string kept;
    for (size_t at = 0; at < text.size();) {
        const size_t end = std::min(text.find('\n', at), text.size() - 1);
        const std::string line = text.substr(at, end + 1 - at);
        if (!is_ours(line)) kept += line;
        at = end + 1;
    }
    if (!kept.empty() && kept.back() != '\n') kept += '\n';
    return kept;
}

}  // namespace

std::vector<std::string> given_pictures(const Scene& scene, const MapEdits& maps) {
    std::vector<std::string> files;
    for (const MapEdits::Given& given : maps.given)
        if (given.texture < scene.texture_names.size() && is_picture_name(scene.texture_names[given.texture]))
            files.push_back(scene.texture_names[given.texture]);
    return files;
}

std::vector<std::string> folders_outside(const std::vector<std::string>& files, const std::string& path) {
    std::vector<std::string> folders;
    for (const std::string& file : files) {
        const fs::path own = whole(file);
        if (is_below(own, whole(path).parent_path())) continue;
        const std::string folder = own.parent_path().string();
        if (std::find(folders.begin(), folders.end(), folder) == folders.end()) folders.push_back(folder);
    }
    return folders;
}

void save_scene(const SceneToSave& scene, const std::string& path) {
    if (fs::path(path).extension() != ".scene")
        throw Error(Exit::usage, path + ": cannot save the scene there, because the name does not end in .scene");
    std::string text = camera_lines(scene.edited, scene.imported.origin) + surroundings(scene.edited.view);
    const fs::path target = whole(path);
    const bool in_place = scene.files.size() == 1 && whole(scene.files.front()) == target;
    if (in_place) {
        const std::string kept = kept_lines(read_file(path, kMaxTextFileBytes, Exit::failed));
        text += kept + edit_lines(scene, plain(scene.imported), target.parent_path(), kept);
    } else {
        // Edits of instances and materials come with a loaded text scene, those of lights do not.
        EditedView base = plain(scene.imported), own = base;
        apply_scene_edits(scene.imported, own);
        base.instances = own.instances;
        base.view.materials = own.view.materials;
        base.maps = own.maps;
        for (const std::string& file : scene.files) text += load_line(file, target.parent_path());
        text += edit_lines(scene, base, target.parent_path(), text);
    }
    write_text_file(path, text);
}

}  // namespace clarity
