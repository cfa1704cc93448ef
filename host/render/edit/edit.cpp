#include "render/edit/edit.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "render/settings/settings.hpp"
#include "render/view/camera_text.hpp"

namespace clarity {
namespace {

constexpr float kMostShift = 1e15f, kLeastScale = 1e-6f;

std::vector<std::string> split(const std::string& text, char at) {
    std::vector<std::string> parts(1);
    for (const char c : text)
        if (c == at)
            parts.emplace_back();
        else
            parts.back() += c;
    return parts;
}

// Reads `count` numbers with commas between them.
void read_floats(const std::string& key, const std::string& text, float* values, size_t count, const char* expected) {
    const std::vector<float> numbers = read_numbers<float>(text);
    if (numbers.size() != count) refuse_value(key, text, expected);
    std::copy(numbers.begin(), numbers.end(), values);
}

void read_camera(Camera& camera, const std::string& text, const std::array<double, 3>& origin) {
    const std::optional<CameraNumbers> numbers = read_camera_numbers(text);
    if (!numbers || !numbers->up) refuse_value("camera", text, "ex,ey,ez,tx,ty,tz,fov_degrees,ux,uy,uz");
    const double fov_deg = *numbers->fov_deg;
    if (fov_deg <= 0 || fov_deg >= 180)
        refuse_value("camera", text, "a camera: its field of view must be between 0 and 180 degrees");
    camera.eye = scene_point(numbers->eye, origin);
    camera.target = scene_point(numbers->target, origin);
    camera.fov_y_rad = static_cast<float>(fov_deg * kRadPerDegree);
    camera.up = *numbers->up;
}

void read_light(const Scene& scene, EditedView& edited, const std::string& key, const std::string& value) {
    rt_u32 at = 0;
    if (!read_number(key.substr(6), at)) refuse_value(key, value, "for a light: light.N counts from 0");
    auto& lights = edited.view.lights;
    if (at > lights.size())
        throw Error(Exit::usage, key + ": the view has " + std::to_string(lights.size()) +
                                     " lights, counted from 0; the next new one is light." + std::to_string(lights.size()));
    edited.lights_on.resize(std::max<size_t>(lights.size(), at + 1), true);
    if (value == "off") {
        if (at == lights.size()) throw Error(Exit::usage, key + ": there is no such light to switch off");
        edited.lights_on[at] = false;
        return;
    }
    const char* expected = "off, point,x,y,z,r,g,b or directional,x,y,z,r,g,b";
    const size_t comma = value.find(',');
    const std::string kind = value.substr(0, comma);
    if (comma == std::string::npos || (kind != "point" && kind != "directional")) refuse_value(key, value, expected);
    float n[6];
    read_floats(key, value.substr(comma + 1), n, 6, "six numbers after its kind: x,y,z,r,g,b");
    if (kind == "point") {
        const std::vector<double> exact = read_numbers<double>(value.substr(comma + 1));
        const std::array<float, 3> at_scene = scene_point({exact[0], exact[1], exact[2]}, scene.origin);
        std::copy(at_scene.begin(), at_scene.end(), n);
    }
    rt_light light{};
    light.kind = kind == "point" ? RT_LIGHT_POINT : RT_LIGHT_DIRECTIONAL;
    if (light.kind == RT_LIGHT_DIRECTIONAL) {
        const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        if (!(length > 0)) refuse_value(key, value, "a direction: it has no length");
        // A unit vector must stay exactly as it is.
        if (std::fabs(length - 1) > 1e-6f)
            for (int k = 0; k < 3; ++k) n[k] /= length;
    }
    for (int k = 0; k < 3; ++k) {
        if (n[3 + k] < 0) refuse_value(key, value, "a light: its colour is negative");
        light.position[k] = n[k];
        light.color[k] = n[3 + k];
    }
    if (at == lights.size())
        lights.push_back(light);
    else
        lights[at] = light;
    edited.lights_on[at] = true;
}

// The parts of a material that an edit may set, by name. `most` is the largest value allowed.
struct MaterialPart {
    const char* name;
    size_t offset, count;
    float most;
};
constexpr MaterialPart kMaterialParts[] = {
    {"color", offsetof(rt_material, color), 3, 1e6f},         {"emission", offsetof(rt_material, emission), 3, 1e6f},
    {"specular", offsetof(rt_material, specular), 3, 1e6f},   {"reflect", offsetof(rt_material, reflect), 1, 1},
    {"refract", offsetof(rt_material, refract), 1, 1},        {"ior", offsetof(rt_material, ior), 1, 100},
    {"shininess", offsetof(rt_material, shininess), 1, 1e6f},
};

float* part_of(rt_material& material, const MaterialPart& part) {
    return reinterpret_cast<float*>(reinterpret_cast<char*>(&material) + part.offset);
}

std::vector<rt_material> scene_materials(const Scene& scene) {
    std::vector<rt_material> all;
    for (const Material& material : scene.materials) all.push_back(material.values);
    return all;
}

void read_material(const Scene& scene, EditedView& edited, const std::string& key, const std::string& value) {
    const std::vector<std::string> path = split(key, '.');
    rt_u32 at = 0;
    const MaterialPart* part = nullptr;
    std::string known;
    for (const MaterialPart& p : kMaterialParts) {
        known += (known.empty() ? "" : ", ") + std::string(p.name);
        if (path.size() == 3 && path[2] == p.name) part = &p;
    }
    if (!part || !read_number(path[1], at))
        throw Error(Exit::usage, key + ": expected material.N.PART with N from 0 and PART one of " + known);
    if (at >= scene.materials.size())
        throw Error(Exit::usage, key + ": the scene has materials 0 to " + std::to_string(scene.materials.size() - 1));
    float n[3];
    read_floats(key, value, n, part->count, part->count == 3 ? "r,g,b" : "a number");
    const float least = std::strcmp(part->name, "ior") == 0 ? 1e-3f : 0.0f;
    for (size_t k = 0; k < part->count; ++k)
        if (n[k] < least || n[k] > part->most)
            refuse_value(key, value, "from " + exact_text(least) + " to " + exact_text(part->most));
    if (edited.view.materials.empty()) edited.view.materials = scene_materials(scene);
    std::copy(n, n + part->count, part_of(edited.view.materials[at], *part));
}

void read_shift(const Scene& scene, InstanceEdits& edits, const std::string& key, const std::string& value) {
    const std::vector<std::string> path = split(key, '.');
    rt_u32 at = 0;
    if (path.size() != 3 || !read_number(path[1], at) ||
        (path[2] != "translate" && path[2] != "rotate" && path[2] != "scale" && path[2] != "hidden"))
        throw Error(Exit::usage,
                    key + ": expected instance.N.PART with N from 0 and PART one of translate, rotate, scale, hidden");
    if (at >= scene.instances.size())
        throw Error(Exit::usage, key + ": the scene has " + std::to_string(scene.instances.size()) +
                                     " instances, counted from 0; there is no " + std::to_string(at));
    if (path[2] == "hidden") {
        if (value != "0" && value != "1") refuse_value(key, value, "0 or 1");
        return edits.hide(at, value == "1");
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
        if (!(std::fabs(x) <= kMostShift)) refuse_value(key, value, "numbers of at most 1e15");
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

std::string light_text(const rt_light& light, const std::array<double, 3>& origin) {
    const bool is_point = light.kind == RT_LIGHT_POINT;
    return (is_point ? "point," + point_text(light.position, origin, ",") : "directional," + numbers_text(light.position, 3)) +
           "," + numbers_text(light.color, 3);
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
}

}  // namespace

bool is_edit(const std::string& key) {
    return key == "camera" || key == "camera_path" || key == "background" || key == "ambient" || key == "hide" ||
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
    } else if (begins(key, "light.")) {
        read_light(scene, edited, key, value);
    } else if (begins(key, "material.")) {
        read_material(scene, edited, key, value);
    } else {
        throw Error(Exit::usage, "no edit `" + key +
                                     "`; there are camera, camera_path, background, ambient, light.N, material.N.PART, hide, "
                                     "instance.N.PART");
    }
}

std::vector<Word> edits_between(const Scene& scene, const EditedView& from, const EditedView& edited) {
    std::vector<Word> words;
    const View &view = edited.view, &base = from.view;
    if (!edited.camera_path.empty()) words.push_back({"camera_path", path_text(edited.camera_path, scene.origin)});
    if (!edited.follows_path) words.push_back({"camera", camera_text(view.camera, scene.origin)});
    if (view.background != base.background) words.push_back({"background", numbers_text(view.background.data(), 3)});
    if (view.ambient != base.ambient) words.push_back({"ambient", numbers_text(view.ambient.data(), 3)});
    for (size_t i = 0; i < view.lights.size(); ++i) {
        const bool was_off = i < from.lights_on.size() && !from.lights_on[i],
                   off = i < edited.lights_on.size() && !edited.lights_on[i];
        const bool known = i < base.lights.size() && std::memcmp(&view.lights[i], &base.lights[i], sizeof(rt_light)) == 0;
        if (!known || (was_off && !off))
            words.push_back({"light." + std::to_string(i), light_text(view.lights[i], scene.origin)});
        if (off && !(known && was_off)) words.push_back({"light." + std::to_string(i), "off"});
    }
    for (size_t i = view.lights.size(); i < base.lights.size(); ++i) words.push_back({"light." + std::to_string(i), "off"});
    for (size_t i = 0; i < view.materials.size() && i < scene.materials.size(); ++i) {
        rt_material was = i < base.materials.size() ? base.materials[i] : scene.materials[i].values, is = view.materials[i];
        for (const MaterialPart& part : kMaterialParts)
            if (!std::equal(part_of(is, part), part_of(is, part) + part.count, part_of(was, part)))
                words.push_back(
                    {"material." + std::to_string(i) + "." + part.name, numbers_text(part_of(is, part), part.count)});
    }
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
    Scene result = with_edits(scene, edited.instances);
    result.edits.clear();
    for (size_t i = 0; i < edited.view.materials.size(); ++i) result.materials[i].values = edited.view.materials[i];
    for (size_t i = 0; i < edited.view.lights.size(); ++i) {
        if (i == result.lights.size()) result.lights.emplace_back();
        result.lights[i].values = edited.view.lights[i];
        const bool off = i < edited.lights_on.size() && !edited.lights_on[i];
        for (float& c : result.lights[i].values.color) c = off ? 0 : c;
    }
    return result;
}

InstanceEdits instance_edits(const Scene& scene, const std::vector<Word>& edits) {
    EditedView all;
    for (const Light& light : scene.lights) all.view.lights.push_back(light.values);
    apply_scene_edits(scene, all);
    for (const Word& word : edits) {
        if (word.key == "hide") read_hidden(scene, all.instances, word.value);
        if (begins(word.key, "instance.")) read_shift(scene, all.instances, word.key, word.value);
    }
    return all.instances;
}

}  // namespace clarity
