#include "scene/material_keys.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <deque>
#include <functional>
#include <iterator>
#include <mutex>

#include "scene/surface_models.hpp"

namespace clarity {
namespace {

using M = rt_material;

constexpr const char* kModels[] = {"whitted", "lambert", "conductor", "dielectric", "gltf", "unlit", nullptr};  // of the host
static_assert(std::size(kModels) == RT_MODEL_KINDS + 1, "a word for each");
constexpr const char* kAlphas[] = {"opaque", "mask", "blend", nullptr};

// More than a surface can send back, but files have such colours. A colour of 8 bits a channel is beyond it.
constexpr double kMostColor = 100;

Key of_model(Key key) {
    key.follows_model = true;
    return key;
}
Key on_log_scale(Key key) {
    key.logarithmic = true;
    return key;
}

// A key of rt_layers.
Key of_layers(Key key) {
    key.offset += sizeof(M);
    key.models = 1u << RT_MODEL_GLTF;
    return key;
}

std::vector<Key> layer_keys() {
    using L = rt_layers;
    // Khronos' specification of glTF 2.0, appendix B, and of its extensions KHR_materials_*.
    return {
        shown(number_key("metallic", offsetof(L, metallic), 0, 1, 0), "Metallic", "share of metal",
              "`color` is the reflectance of the metal"),
        shown(number_key("specular_weight", offsetof(L, specular_weight), 0, 1, 1), "Reflection",
              "weight of what a surface that is no metal reflects"),
        shown(color_key("specular_color", offsetof(L, specular_color), kMostColor, 1), "Reflection colour", "r g b",
              "of that reflection, straight on"),
        shown(number_key("clearcoat", offsetof(L, clearcoat), 0, 1, 0), "Clearcoat",
              "share that has a layer of varnish on top"),
        shown(number_key("clearcoat_roughness", offsetof(L, clearcoat_roughness), 0, 1, 0), "Coat roughness", "of the varnish"),
        shown(color_key("sheen_color", offsetof(L, sheen_color), 1, 0), "Sheen", "r g b",
              "reflectance of fibres on top, as of velvet"),
        shown(number_key("sheen_roughness", offsetof(L, sheen_roughness), 0, 1, 0), "Sheen roughness", "of the fibres"),
        shown(number_key("transmission", offsetof(L, transmission), 0, 1, 0), "Transmission",
              "share of light that goes through what is no metal"),
        shown(flag_key("thin", offsetof(L, flags), RT_LAYERS_SOLID, true), "Thin",
              "whether it is a sheet that light goes straight through", "otherwise it bounds a solid that refracts by `ior`"),
        shown(number_key("anisotropy", offsetof(L, anisotropy), 0, 1, 0), "Anisotropy", "strength",
              "how much wider highlights are along the grain"),
        shown(number_key("anisotropy_rotation", offsetof(L, anisotropy_rotation), -360, 360, 0), "Grain", "angle in degrees",
              "of the grain, counter-clockwise from the tangent"),
        shown(number_key("iridescence", offsetof(L, iridescence), 0, 1, 0), "Iridescence",
              "share that has a film of the thickness of a wave of light"),
        shown(number_key("iridescence_ior", offsetof(L, iridescence_ior), 1e-3, 100, 1.3f), "Film index",
              "index of refraction of the film"),
        shown(number_key("iridescence_thickness", offsetof(L, iridescence_thickness), 0, 1e5, 400), "Film thickness",
              "in nanometres; where a texture has it, the greatest"),
        shown(number_key("iridescence_thickness_min", offsetof(L, iridescence_thickness_min), 0, 1e5, 100), "Film least",
              "least thickness, where a texture has it"),
    };
}

std::vector<Key> make_keys() {
    std::vector<Key> keys = {
        shown(word_key("model", offsetof(M, model), 0, kModels), "Model", "what `path` takes the surface for",
              "`lambert` scatters evenly, `conductor` is a metal, `dielectric` is glass or water; `gltf` has the layers of "
              "glTF; `unlit` shows its colour and neither gets nor gives light; `whitted` is the mixture below; others are "
              "plugins'"),
        shown(color_key("color", offsetof(M, color), kMostColor, 0.7f), "Colour", "r g b",
              "share of light that is scattered; also tints what is refracted. Of a conductor: what it mirrors straight on"),
        shown(number_key("roughness", offsetof(M, roughness), 0, 1, 0), "Roughness", "of a conductor, dielectric or `gltf`",
              "0 is smooth; GGX with alpha = roughness^2"),
        of_model(shown(number_key("reflect", offsetof(M, reflect), 0, 1, 0), "Mirror", "share that is mirrored")),
        of_model(shown(number_key("refract", offsetof(M, refract), 0, 1, 0), "Refraction",
                       "share that Fresnel's equations divide into reflected and refracted")),
        on_log_scale(shown(number_key("ior", offsetof(M, ior), 1e-3, 100, 1.5f), "Index", "index of refraction",
                           "of the inside: water 1.33, glass 1.5, diamond 2.4")),
        of_model(shown(color_key("specular", offsetof(M, specular), kMostColor, 0.15f), "Highlight", "r g b",
                       "colour of the Blinn-Phong highlight of Whitted's tracers")),
        of_model(on_log_scale(shown(number_key("shininess", offsetof(M, shininess), 0, 1e6, 32), "Shininess",
                                    "exponent of the highlight", "larger is smaller and sharper"))),
        shown(color_key("emission", offsetof(M, emission), kMostNumber, 0), "Emission", "r g b",
              "light of its own, a radiance. With `path` it lights other surfaces"),
        shown(color_key("absorption", offsetof(M, absorption), kMostNumber, 0), "Absorption", "r g b",
              "inside of a dielectric, per unit of length: light falls by exp(-absorption length)"),
        shown(word_key("alpha", offsetof(M, alpha), 0, kAlphas), "Alpha", "whether alpha counts",
              "that is `opacity` times the alpha of texture and vertices. `mask`: where it is below `cutoff` there is no "
              "surface. "
              "`blend`: it is the share of the surface that is there"),
        shown(number_key("opacity", offsetof(M, opacity), 0, 1, 1), "Opacity", "for `mask` and `blend`"),
        shown(number_key("cutoff", offsetof(M, cutoff), 0, 2, 0.5f), "Cutoff", "of `mask`", "above 1 nothing is left"),
        shown(flag_key("compensate", offsetof(M, flags), RT_MATERIAL_SINGLE_SCATTER, true), "Compensate",
              "whether light that is scattered several times between facets is kept", "of conductors and rough dielectrics"),
        shown(flag_key("one_sided", offsetof(M, flags), RT_MATERIAL_ONE_SIDED), "One-sided",
              "whether only the side that its normal points to emits light"),
        shown(flag_key("checker", offsetof(M, flags), RT_MATERIAL_CHECKER), "Checker", "whether it is a board of unit squares",
              "in world x and z, of `color` and a third of it; for floors"),
    };
    for (const Key& key : layer_keys()) keys.push_back(of_layers(key));
    return keys;
}

// Whitted's share of the layers of glTF: a smooth metal mirrors, a rough one is diffuse in its own colour.
void show_layers(MaterialValues& m) {
    const float smooth = 1 - m.roughness, metallic = m.layers.metallic;
    m.refract = m.layers.transmission;
    m.reflect = std::min(metallic * smooth, 1 - m.refract);
    // Blinn's exponent for a GGX roughness (alpha = roughness^2): 2 / alpha^2 - 2.
    const float alpha2 = std::max(1e-3f, m.roughness * m.roughness * m.roughness * m.roughness);
    m.shininess = std::clamp(2 / alpha2 - 2, 1.0f, 1000.0f);
    for (int k = 0; k < 3; ++k) m.specular[k] = smooth * (0.04f + metallic * (m.color[k] - 0.04f));
}

// What Whitted's tracers read, as the material's model has it. Unchanged if that is Whitted's own.
MaterialValues whitted_view(const MaterialValues& material) {
    MaterialValues m = material;
    if (m.model == RT_MODEL_WHITTED) return m;
    if (m.model == RT_MODEL_GLTF || m.model == RT_MODEL_UNLIT) {
        show_layers(m);
        return m;
    }
    m.reflect = m.model == RT_MODEL_CONDUCTOR ? 1 - m.roughness : 0.0f;
    m.refract = m.model == RT_MODEL_DIELECTRIC ? 1.0f : 0.0f;
    const MaterialValues usual = default_material();
    const bool is_smooth = m.roughness == 0, is_metal = m.model == RT_MODEL_CONDUCTOR;
    for (int k = 0; k < 3; ++k)
        m.specular[k] = m.model == RT_MODEL_DIELECTRIC ? usual.specular[k] : is_metal && !is_smooth ? m.color[k] : 0.0f;
    // Blinn's highlight is about as wide as a GGX lobe with this exponent (Walter et al. 2007, section 5.3: 2 / alpha^2 - 2).
    const float alpha = m.roughness * m.roughness;
    m.shininess = is_smooth ? usual.shininess : std::clamp(2 / std::max(alpha * alpha, 1e-6f) - 2, 1.0f, 1e6f);
    return m;
}

bool same_bytes(const MaterialValues& a, const MaterialValues& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

}  // namespace

namespace {

// All tables that there were, which are never freed; the last one counts.
struct Tables {
    std::mutex mutex;
    std::deque<std::vector<Key>> all{make_keys()};
    std::deque<std::vector<const char*>> words;  // of the key `model` in these tables
    std::atomic<const std::vector<Key>*> last{&all.back()};
};
Tables& tables() {
    static auto& tables = *new Tables;
    return tables;
}

}  // namespace

const std::vector<Key>& material_keys() {
    return *tables().last;
}

namespace {

void change_table(const std::function<void(std::vector<Key>&)>& change) {
    const std::lock_guard<std::mutex> lock(tables().mutex);
    std::vector<Key> next = tables().all.back();
    change(next);
    tables().all.push_back(std::move(next));
    tables().last = &tables().all.back();
}

}  // namespace

void add_model_word(rt_u32 model, const char* word) {
    change_table([&](std::vector<Key>& keys) {
        const auto key = std::find_if(keys.begin(), keys.end(), [](const Key& k) { return k.offset == offsetof(M, model); });
        std::vector<const char*>& words = tables().words.emplace_back(key->words, key->words + model);
        words.push_back(word);
        words.push_back(nullptr);
        key->words = words.data();
        key->max = model;
    });
}

void add_material_keys(const std::vector<Key>& more) {
    change_table([&](std::vector<Key>& keys) { keys.insert(keys.end(), more.begin(), more.end()); });
}

bool is_key_of_surface(const Key& key) {
    return key.models >> RT_MODEL_KINDS != 0;
}

bool has_room(rt_u32 model, const Key& key) {
    return key.offset < sizeof(M) || (is_surface_model(model) ? has_key(model, key) : !is_key_of_surface(key));
}

const Key* find_material_key(rt_u32 model, const std::string& name) {
    const Key* found = nullptr;
    for (const Key& key : material_keys())
        if (name == key.name && (!found || has_key(model, key))) found = &key;
    return found;
}

const Key& material_key(const char* name) {
    return *find_key(material_keys(), name);
}

const rt_primitive_kind* material_kind_for_plugins() {
    static std::mutex mutex;
    static auto& kinds = *new std::deque<std::pair<const std::vector<Key>*, PluginKeys>>;
    const std::lock_guard<std::mutex> lock(mutex);
    const std::vector<Key>* const table = &material_keys();
    for (const auto& [of, keys] : kinds)
        if (of == table) return &keys.kind;
    // Where several models have a key of one name, importers get it once, with the range of all.
    std::vector<Key> once;
    for (const Key& key : *table) {
        const auto same =
            std::find_if(once.begin(), once.end(), [&](const Key& o) { return std::strcmp(o.name, key.name) == 0; });
        if (same == once.end()) {
            once.push_back(key);
        } else {
            same->min = std::min(same->min, key.min);
            same->max = std::max(same->max, key.max);
        }
    }
    return &kinds.emplace_back(table, PluginKeys("material", once)).second.kind;
}

bool has_key(rt_u32 model, const Key& key) {
    return key.models == 0 || (key.models >> model & 1u) != 0;
}

MaterialValues::MaterialValues(const rt_material& plain) : rt_material(plain), layers{} {
    static const std::vector<Key> keys = layer_keys();
    for (const Key& key : keys) set_value(key, &layers, key.def);
}

MaterialValues default_material() {
    MaterialValues m;
    m.texture = RT_NONE;
    for (const Key& key : material_keys())
        if (has_room(m.model, key)) set_value(key, &m, key.def);
    return m;
}

void set_material_value(MaterialValues& material, const Key& key, const std::array<float, 3>& value) {
    if (!has_room(material.model, key)) return;
    const bool follows = same_bytes(material, whitted_view(material));
    const rt_u32 before = material.model;
    set_value(key, &material, value);
    if (material.model != before && (is_surface_model(before) || is_surface_model(material.model))) {
        material.layers = MaterialValues(material).layers;
        for (const Key& own : material_keys())
            if (is_key_of_surface(own) && has_key(material.model, own)) set_value(own, &material, own.def);
    }
    if (follows && !key.follows_model) material = whitted_view(material);
    if (std::strcmp(key.name, "model") == 0) material = whitted_view(material);
}

MaterialValues material_of(const rt_material_desc& d, std::string& problem) {
    MaterialValues m = default_material();
    std::copy_n(d.color, 3, m.color);
    std::copy_n(d.emission, 3, m.emission);
    std::copy_n(d.specular, 3, m.specular);
    m.reflect = d.reflect;
    m.refract = d.refract;
    m.shininess = d.shininess;
    m.ior = d.ior;
    m.texture = d.texture;
    m.flags = d.flags & (RT_MATERIAL_CHECKER | RT_MATERIAL_ONE_SIDED | RT_MATERIAL_SINGLE_SCATTER);
    problem.clear();
    for (const Key& key : material_keys())
        for (rt_u32 i = 0; d.values && i < d.value_count; ++i)
            if (d.values[i].key && std::strcmp(key.name, d.values[i].key) == 0) {
                const float* n = d.values[i].numbers;
                set_material_value(m, key, nearest_value(key, {n[0], n[1], n[2]}));
            }
    for (rt_u32 i = 0; d.values && i < d.value_count; ++i)
        if (!d.values[i].key || !find_key(material_keys(), d.values[i].key))
            problem = "has a key that this host does not know, which is left out";
    for (const Key& key : material_keys()) {
        if (!has_room(m.model, key)) continue;
        const std::array<float, 3> value = value_of(key, &m);
        if (!std::all_of(value.begin(), value.end(), [](float x) { return std::isfinite(x); }))
            problem = "has values that are not finite numbers; they are replaced by defaults";
        set_value(key, &m, nearest_value(key, value));
    }
    return m;
}

Problem material_fault(const MaterialValues& material) {
    for (const Key& key : material_keys())
        if (has_room(material.model, key))
            if (const Problem fault = fault_of(key, &material)) return fault;
    return {};
}

}  // namespace clarity
