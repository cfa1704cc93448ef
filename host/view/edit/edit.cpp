#include "view/edit/edit.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "scene/light_kinds.hpp"
#include "scene/map_uses.hpp"
#include "scene/material_keys.hpp"
#include "scene/surface_models.hpp"
#include "scene/usable.hpp"
#include "view/edit/sky_edit.hpp"
#include "view/edit/texture_edit.hpp"
#include "view/settings/settings.hpp"
#include "view/view.hpp"

namespace clarity {
namespace {

constexpr float kLeastScale = 1e-6f;

std::vector<std::string> split(const std::string& text, char at) {
    std::vector<std::string> parts(1);
    for (const char c : text)
        if (c == at)
            parts.emplace_back();
        else
            parts.back() += c;
    return parts;
}

std::string key_names(const std::vector<Key>& keys) {
    std::string names;
    for (const Key& key : keys) names += (names.empty() ? "" : ", ") + std::string(key.name);
    return names;
}

std::string number_word(size_t count) {
    constexpr const char* kWords[] = {"no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"};
    return count < std::size(kWords) ? kWords[count] : std::to_string(count);
}

// Reads `count` numbers with commas between them.
void read_floats(const std::string& key, const std::string& text, float* values, size_t count, const char* expected) {
    const std::vector<float> numbers = read_numbers<float>(text);
    if (numbers.size() != count) refuse_value(key, text, expected);
    std::copy(numbers.begin(), numbers.end(), values);
}

void read_camera(Camera& camera, const std::string& text, const std::array<double, 3>& origin) {
    const std::optional<CameraNumbers> numbers = read_camera_numbers(text);
    if (!numbers || !numbers->up) refuse_value("camera", text, "ex,ey,ez,tx,ty,tz,fov_degrees,ux,uy,uz[,aperture,focus]");
    const double fov_deg = *numbers->fov_deg;
    if (fov_deg <= 0 || fov_deg >= 180)
        refuse_value("camera", text, "a camera: its field of view must be between 0 and 180 degrees");
    camera.eye = scene_point(numbers->eye, origin);
    camera.target = scene_point(numbers->target, origin);
    camera.fov_y_rad = static_cast<float>(fov_deg * kRadPerDegree);
    camera.up = *numbers->up;
    camera.aperture = numbers->aperture;
    camera.focus = numbers->focus;
}

// The keys of a kind of lights, each once. Numbers of `listed` follow the name of the kind: they are the keys before the first
// word. Each of the `others` has an edit of its own.
struct LightKeys {
    explicit LightKeys(const LightKind& kind) {
        for (const Key& key : kind.keys) {
            if (key.alias) continue;
            const bool is_word = key.kind == RT_KEY_WORD || key.kind == RT_KEY_FLAG;
            (is_word || !others.empty() ? others : listed).push_back(&key);
        }
    }
    std::vector<const Key*> listed, others;
};

// "x,y,z,r,g,b": the numbers of a kind of lights, and how many they are.
std::string numbers_form(const LightKind& kind, size_t& count) {
    std::string form;
    count = 0;
    for (const Key* key : LightKeys(kind).listed) {
        const char* what = count_of(*key) == 1 ? key->name : key->kind == RT_KEY_COLOR ? "r,g,b" : "x,y,z";
        form += (form.empty() ? "" : ",") + std::string(what);
        count += count_of(*key);
    }
    return form;
}
std::string light_forms() {
    std::string forms = "off";
    size_t count = 0;
    for (const LightKind& kind : light_kinds()) forms += " or " + std::string(kind.name) + "," + numbers_form(kind, count);
    return forms;
}

// Reads the text of one key. Throws Error(usage).
std::array<float, 3> read_key(const Key& key, const std::string& name, const std::string& text,
                              const std::array<double, 3>& origin) {
    std::array<float, 3> value{};
    std::string expected;
    if (!read_value(key, text, value, expected)) refuse_value(name, text, expected);
    if (key.moves != Moves::point) return value;
    const std::vector<double> exact = read_numbers<double>(text);
    return scene_point({exact[0], exact[1], exact[2]}, origin);
}

// kind: "point"; numbers: "x,y,z,r,g,b", or empty for those of the table.
rt_light read_light_numbers(const LightKind& kind, const std::string& name, const std::string& numbers,
                            const std::array<double, 3>& origin) {
    rt_light light = default_light(kind.kind);
    if (numbers.empty()) return light;
    size_t count = 0;
    const std::string form = numbers_form(kind, count);
    std::vector<std::string> parts = split(numbers, ',');
    if (parts.size() != count) refuse_value(name, numbers, number_word(count) + " numbers after its kind: " + form);
    size_t at = 0;
    for (const Key* key : LightKeys(kind).listed) {
        std::string text = parts[at];
        for (size_t k = 1; k < count_of(*key); ++k) text += "," + parts[at + k];
        at += count_of(*key);
        set_edit_value(*key, light, read_key(*key, name, text, origin));
    }
    return light;
}

void read_light(const Scene& scene, EditedView& edited, const std::string& key, const std::string& value) {
    const std::vector<std::string> path = split(key, '.');
    rt_u32 at = 0;
    if (path.size() > 3 || !read_number(path[1], at)) refuse_value(key, value, "for a light: light.N counts from 0");
    auto& lights = edited.view.lights;
    if (at > lights.size() || (path.size() == 3 && at == lights.size()))
        throw Error(Exit::usage, key + ": the view has " + std::to_string(lights.size()) +
                                     " lights, counted from 0; the next new one is light." + std::to_string(lights.size()));
    edited.lights_on.resize(std::max<size_t>(lights.size(), at + 1), true);
    if (value == "off" && path.size() == 2) {
        if (at == lights.size()) throw Error(Exit::usage, key + ": there is no such light to switch off");
        edited.lights_on[at] = false;
        return;
    }
    rt_light light;
    if (path.size() == 3) {
        light = lights[at];
        const std::vector<Key>& keys = light_kind_of(light).keys;
        const Key* part = find_key(keys, path[2]);
        if (!part)
            throw Error(Exit::usage,
                        key + ": a light of the kind " + light_kind_of(light).name + " has the parts " + key_names(keys));
        set_edit_value(*part, light, read_key(*part, key, value, scene.origin));
    } else {
        const size_t comma = value.find(',');
        const LightKind* kind = find_light_kind(value.substr(0, comma));
        if (!kind) refuse_value(key, value, light_forms());
        light = read_light_numbers(*kind, key, comma == std::string::npos ? "" : value.substr(comma + 1), scene.origin);
    }
    if (!make_sound(light, true)) refuse_value(key, value, "a light that has a size");
    if (at == lights.size())
        lights.push_back(light);
    else
        lights[at] = light;
    if (path.size() == 2) edited.lights_on[at] = true;
}

std::vector<MaterialValues> scene_materials(const Scene& scene) {
    std::vector<MaterialValues> all;
    for (const Material& material : scene.materials) all.push_back(material.values);
    return all;
}

void read_material(const Scene& scene, EditedView& edited, const std::string& key, const std::string& value) {
    const std::vector<std::string> path = split(key, '.');
    rt_u32 at = 0;
    const Key* part = path.size() == 3 ? find_material_key(RT_MODEL_WHITTED, path[2]) : nullptr;
    const rt_u32 use = path.size() == 3 ? find_map_use(path[2]) : RT_NONE;
    if ((!part && use == RT_NONE) || !read_number(path[1], at))
        throw Error(Exit::usage, key + ": expected material.N.PART with N from 0 and PART one of " +
                                     key_names(material_keys()) + ", " + map_names());
    if (at >= scene.materials.size())
        throw Error(Exit::usage, key + ": the scene has materials 0 to " + std::to_string(scene.materials.size() - 1));
    if (!part) return edited.maps.give(scene, at, use, read_texture(scene, use, key, value));
    if (edited.view.materials.empty()) edited.view.materials = scene_materials(scene);
    const rt_u32 model = edited.view.materials[at].model;
    part = find_material_key(model, path[2]);
    if (!has_room(model, *part))
        throw Error(Exit::usage, key + ": materials of the model " +
                                     value_text(material_key("model"), {static_cast<float>(model), 0, 0}, " ") +
                                     " have no such key");
    const std::array<float, 3> number = read_key(*part, key, value, scene.origin);
    set_material_value(edited.view.materials[at], *part, number);
}

void read_shift(const Scene& scene, InstanceEdits& edits, const std::string& key, const std::string& value) {
    const std::vector<std::string> path = split(key, '.');
    rt_u32 at = 0;
    if (path.size() != 3 || !read_number(path[1], at) ||
        (path[2] != "translate" && path[2] != "rotate" && path[2] != "scale" && path[2] != "hidden" && path[2] != "mask"))
        throw Error(Exit::usage,
                    key + ": expected instance.N.PART with N from 0 and PART one of translate, rotate, scale, hidden, mask");
    if (at >= scene.instances.size())
        throw Error(Exit::usage, key + ": the scene has " + std::to_string(scene.instances.size()) +
                                     " instances, counted from 0; there is no " + std::to_string(at));
    if (path[2] == "hidden") {
        if (value != "0" && value != "1") refuse_value(key, value, "0 or 1");
        return edits.hide(at, value == "1");
    }
    if (path[2] == "mask") {
        rt_u32 mask = 0;
        if (!read_number(value, mask) || mask > RT_SEEN_BY_ALL)
            refuse_value(key, value,
                         "a sum of 1 (camera rays), 2 (shadow rays), 4 (mirrored and other rays) and more bits, up to 255");
        return edits.set_mask(at, mask);
    }
    InstanceShift shift = edits.shift_of(at);
    const bool scales = path[2] == "scale";
    std::array<float, 3> n{};
    if (scales && value.find(',') == std::string::npos) {
        read_floats(key, value, n.data(), 1, "x,y,z or one number");
        n[1] = n[2] = n[0];
    } else {
        read_floats(key, value, n.data(), 3, scales ? "x,y,z or one number" : "x,y,z");
    }
    for (const float x : n) {
        if (!is_usable(x)) refuse_value(key, value, "numbers of at most 1e15");
        if (scales && !(std::fabs(x) >= kLeastScale)) refuse_value(key, value, "factors other than 0");
    }
    (scales ? shift.scale : path[2] == "rotate" ? shift.degrees : shift.translate) = n;
    edits.set_shift(at, shift);
}

void read_hidden(const Scene& scene, InstanceEdits& edits, const std::string& value) {
    std::vector<rt_u32> hidden;
    for (const std::string& range : split(value, ',')) {
        if (value.empty()) break;
        const size_t dash = range.find('-');
        rt_u32 first = 0, last = 0;
        if (!read_number(range.substr(0, dash), first) ||
            !read_number(dash == std::string::npos ? range : range.substr(dash + 1), last) || last < first)
            refuse_value("hide", value, "a list of instances such as 3,5-9");
        if (last >= scene.instances.size())
            throw Error(Exit::usage, "hide: the scene has " + std::to_string(scene.instances.size()) +
                                         " instances, counted from 0; there is no " + std::to_string(last));
        for (rt_u32 i = first; i <= last; ++i) hidden.push_back(i);
    }
    std::sort(hidden.begin(), hidden.end());
    hidden.erase(std::unique(hidden.begin(), hidden.end()), hidden.end());
    edits.hidden = std::move(hidden);
}

std::string hidden_text(const std::vector<rt_u32>& hidden) {
    std::string text;
    for (size_t i = 0; i < hidden.size();) {
        size_t end = i + 1;
        while (end < hidden.size() && hidden[end] == hidden[end - 1] + 1) ++end;
        text += (text.empty() ? "" : ",") + std::to_string(hidden[i]);
        if (end - i > 1) text += "-" + std::to_string(hidden[end - 1]);
        i = end;
    }
    return text;
}

bool begins(const std::string& text, const char* with) {
    return text.compare(0, std::strlen(with), with) == 0;
}

// The words that make a light from nothing.
void add_light_words(const rt_light& light, size_t number, const std::array<double, 3>& origin, std::vector<Word>& words) {
    const std::string name = "light." + std::to_string(number);
    const LightKeys keys(light_kind_of(light));
    std::string text = light_kind_of(light).name;
    for (const Key* key : keys.listed) {
        const std::array<float, 3> value = edit_value(*key, light);
        text += "," + (key->moves == Moves::point ? point_text(value.data(), origin, ",") : value_text(*key, value, ","));
    }
    words.push_back({name, text});
    for (const Key* key : keys.others)
        if (const std::array<float, 3> value = edit_value(*key, light); value != key->def)
            words.push_back({name + "." + key->name, value_text(*key, value, ",")});
}

// The words that turn one material into another one. Where a key changes what others follow, those are written, too.
void add_material_words(const MaterialValues& was, const MaterialValues& is, size_t number, std::vector<Word>& words) {
    bool differs = false;
    for (const Key& key : material_keys()) {
        if (!has_room(is.model, key)) continue;
        const std::array<float, 3> value = value_of(key, &is);
        // What the first of the words, that of the model, sets.
        const bool is_new = was.model != is.model && key.offset >= sizeof(rt_material) &&
                            (is_surface_model(was.model) || is_surface_model(is.model));
        const bool other = value != (is_new ? key.def : value_of(key, &was));
        differs |= other && !key.follows_model;
        if (other || (key.follows_model && differs && is.model != RT_MODEL_WHITTED))
            words.push_back({"material." + std::to_string(number) + "." + key.name, value_text(key, value, ",")});
    }
}

// The words that turn `from` into `to`.
void add_instance_words(const InstanceEdits& from, const InstanceEdits& to, std::vector<Word>& words) {
    std::vector<rt_u32> moved;
    for (const InstanceEdits* edits : {&from, &to})
        for (const InstanceEdits::Moved& m : edits->moved) moved.push_back(m.instance);
    std::sort(moved.begin(), moved.end());
    moved.erase(std::unique(moved.begin(), moved.end()), moved.end());
    for (const rt_u32 i : moved) {
        const InstanceShift was = from.shift_of(i), is = to.shift_of(i);
        const auto add = [&](const char* part, const std::array<float, 3>& a, const std::array<float, 3>& b) {
            if (a != b) words.push_back({"instance." + std::to_string(i) + "." + part, numbers_text(b.data(), 3)});
        };
        add("translate", was.translate, is.translate);
        add("rotate", was.degrees, is.degrees);
        add("scale", was.scale, is.scale);
    }
    if (from.hidden != to.hidden) words.push_back({"hide", hidden_text(to.hidden)});
    std::map<rt_u32, rt_u32> masked = to.masks;
    masked.insert(from.masks.begin(), from.masks.end());
    for (const auto& [i, mask] : masked)
        if (from.mask_of(i) != to.mask_of(i))
            words.push_back({"instance." + std::to_string(i) + ".mask", std::to_string(to.mask_of(i))});
}

}  // namespace

bool is_edit(const std::string& key) {
    return key == "camera" || key == "camera.aperture" || key == "camera.focus" || key == "camera_path" ||
           key == "background" || key == "ambient" || key == "hide" || key == "sky" || begins(key, "sky.") ||
           begins(key, "light.") || begins(key, "material.") || begins(key, "instance.");
}

void apply_edit(const Scene& scene, EditedView& edited, const std::string& key, const std::string& value) {
    View& view = edited.view;
    if (key == "camera") {
        Camera camera = view.camera;
        read_camera(camera, value, scene.origin);
        camera.name.clear();
        view.camera = camera;
        edited.follows_path = false;
    } else if (key == "camera.aperture" || key == "camera.focus") {
        float length = 0;
        if (!read_number(value, length) || length < 0 || !is_usable(length))
            refuse_value(key, value, "a length from 0 to 1e15");
        (key == "camera.focus" ? view.camera.focus : view.camera.aperture) = length;
    } else if (key == "camera_path") {
        edited.camera_path = read_path(value, scene.origin);
        edited.follows_path = !edited.camera_path.empty();
    } else if (key == "background" || key == "ambient") {
        float n[3];
        read_floats(key, value, n, 3, "r,g,b");
        for (int k = 0; k < 3; ++k)
            if (n[k] < 0) refuse_value(key, value, "a colour: it is negative");
        std::copy(n, n + 3, (key == "ambient" ? view.ambient : view.background).begin());
    } else if (key == "hide") {
        read_hidden(scene, edited.instances, value);
    } else if (begins(key, "instance.")) {
        read_shift(scene, edited.instances, key, value);
    } else if (key == "sky" || begins(key, "sky.")) {
        read_sky(scene, view, key, value);
    } else if (begins(key, "light.")) {
        read_light(scene, edited, key, value);
    } else if (begins(key, "material.")) {
        read_material(scene, edited, key, value);
    } else {
        throw Error(Exit::usage, "no edit `" + key +
                                     "`; there are camera, camera.aperture, camera.focus, camera_path, background, ambient, "
                                     "sky, sky.PART, light.N, light.N.PART, material.N.PART, hide, instance.N.PART");
    }
}

std::vector<Word> edits_between(const Scene& scene, const EditedView& from, const EditedView& edited) {
    std::vector<Word> words;
    const View &view = edited.view, &base = from.view;
    if (!edited.camera_path.empty()) words.push_back({"camera_path", path_text(edited.camera_path, scene.origin)});
    if (!edited.follows_path) words.push_back({"camera", camera_text(view.camera, scene.origin)});
    if (view.background != base.background) words.push_back({"background", numbers_text(view.background.data(), 3)});
    if (view.ambient != base.ambient) words.push_back({"ambient", numbers_text(view.ambient.data(), 3)});
    add_sky_words(sky_of(scene, base), sky_of(scene, view), words);
    for (size_t i = 0; i < view.lights.size(); ++i) {
        const bool was_off = i < from.lights_on.size() && !from.lights_on[i],
                   off = i < edited.lights_on.size() && !edited.lights_on[i];
        const bool known = i < base.lights.size() && std::memcmp(&view.lights[i], &base.lights[i], sizeof(rt_light)) == 0;
        if (!known || (was_off && !off)) add_light_words(view.lights[i], i, scene.origin, words);
        if (off && !(known && was_off)) words.push_back({"light." + std::to_string(i), "off"});
    }
    for (size_t i = view.lights.size(); i < base.lights.size(); ++i) words.push_back({"light." + std::to_string(i), "off"});
    for (size_t i = 0; i < view.materials.size() && i < scene.materials.size(); ++i) {
        const MaterialValues& was = i < base.materials.size() ? base.materials[i] : scene.materials[i].values;
        add_material_words(was, view.materials[i], i, words);
    }
    add_map_words(scene, from.maps, edited.maps, words);
    add_instance_words(from.instances, edited.instances, words);
    return words;
}

View visible_view(const EditedView& edited) {
    View view = edited.view;
    view.lights.clear();
    for (size_t i = 0; i < edited.view.lights.size(); ++i)
        if (i >= edited.lights_on.size() || edited.lights_on[i]) view.lights.push_back(edited.view.lights[i]);
    return view;
}

void apply_scene_edits(const Scene& scene, EditedView& edited) {
    for (const SceneEdit& edit : scene.edits) {
        try {
            apply_edit(scene, edited, edit.key, edit.value);
        } catch (const Error& e) {
            throw Error(Exit::import_failed, edit.where + ": " + e.what());
        }
    }
}

Scene with_scene_edits(Scene scene) {
    if (scene.edits.empty()) return scene;
    EditedView edited;
    for (const Light& light : scene.lights) edited.view.lights.push_back(light.values);
    apply_scene_edits(scene, edited);
    Scene result = edited_scene(scene, edited);
    result.edits.clear();
    result.sky.values = sky_of(scene, edited.view);
    if (result.sky.values.kind != RT_SKY_PICTURE) result.sky.texels = {};
    for (size_t i = 0; i < edited.view.materials.size(); ++i) {
        const rt_u32 texture = result.materials[i].values.texture;
        result.materials[i].values = edited.view.materials[i];
        result.materials[i].values.texture = texture;
    }
    for (size_t i = 0; i < edited.view.lights.size(); ++i) {
        if (i == result.lights.size()) result.lights.emplace_back();
        result.lights[i].values = edited.view.lights[i];
        const bool off = i < edited.lights_on.size() && !edited.lights_on[i];
        for (float& c : result.lights[i].values.color) c = off ? 0 : c;
    }
    return result;
}

Scene edited_scene(const Scene& scene, const EditedView& edited) {
    Scene result = with_edits(scene, edited.instances);
    return edited.maps.empty() ? result : with_maps(result, edited.maps);
}

EditedView scene_edits(const Scene& scene, const std::vector<Word>& edits) {
    EditedView all;
    for (const Light& light : scene.lights) all.view.lights.push_back(light.values);
    apply_scene_edits(scene, all);
    for (const Word& word : edits) {
        if (word.key == "hide") read_hidden(scene, all.instances, word.value);
        if (begins(word.key, "instance.")) read_shift(scene, all.instances, word.key, word.value);
        if (map_use_of(word.key) != RT_NONE) read_material(scene, all, word.key, word.value);
    }
    return all;
}

}  // namespace clarity
