#include "materials.hpp"

#include <algorithm>
#include <cmath>

#include "../common/materials.hpp"
#include "nodes.hpp"
#include "rt_plugin.hpp"

namespace gltf_import {
namespace {

// The texture of the colour, as the material describes it.
Value color_texture(const Value& material) {
    const Value gloss = material.object("extensions").object("KHR_materials_pbrSpecularGlossiness");
    if (gloss.has("diffuseTexture")) return gloss["diffuseTexture"];
    return material.object("pbrMetallicRoughness").object("baseColorTexture");
}

}  // namespace

Materials::Materials(const Document& document, Accessors& accessors, const rt_scene_sink& sink)
    : accessors_(accessors),
      materials_(document.list("materials")),
      textures_(document.list("textures")),
      images_(document.list("images")),
      sink_(sink),
      ids_(materials_.size()),
      image_ids_(images_.size()) {}

rt_u32 Materials::id(const Value& primitive) {
    const auto index = primitive.index("material", materials_);
    if (!index) return RT_NONE;
    if (!ids_[*index]) ids_[*index] = add(materials_[*index]);
    return *ids_[*index];
}

rt_u32 Materials::add(const Value& material) {
    const std::string name = material.text("name", "");
    const Value pbr = material.object("pbrMetallicRoughness"), extensions = material.object("extensions");
    const Value gloss = extensions.object("KHR_materials_pbrSpecularGlossiness");
    rt_material_desc out = rt::material(name.c_str());
    const std::array<double, 4> base = gloss.numbers<4>("diffuseFactor", pbr.numbers<4>("baseColorFactor", {1, 1, 1, 1}));
    importers::store_color(base, 1, 1, out.color);
    out.texture = texture(color_texture(material));
    importers::apply_metallic(pbr.number("metallicFactor", 1), pbr.number("roughnessFactor", 1), out);
    // The host has one texture, which multiplies the colour. A picture that confines emission to a part of the surface is lost.
    const std::array<double, 3> emission = material.numbers<3>("emissiveFactor", {0, 0, 0});
    const double strength = extensions.object("KHR_materials_emissive_strength").number("emissiveStrength", 1);
    const bool shines = emission[0] > 0 || emission[1] > 0 || emission[2] > 0;
    if (shines && material.has("emissiveTexture")) {
        const std::string text = material.path() + " shines as a picture says (emissiveTexture); that light is left out";
        rt::warn(sink_, text);
    } else {
        importers::store_color(emission, strength, 1000, out.emission);
    }
    const double opacity = material.text("alphaMode", "OPAQUE") == "BLEND" ? base[3] : 1;
    const double transmission = extensions.object("KHR_materials_transmission").number("transmissionFactor", 0);
    importers::apply_transparency(opacity, transmission, extensions.object("KHR_materials_ior").number("ior", 0), out);
    return rt::id(sink_.material(sink_.ctx, &out));
}

TextureMapping Materials::mapping(const Value& primitive) const {
    TextureMapping mapping;
    const auto index = primitive.index("material", materials_);
    if (!index) return mapping;
    const Value info = color_texture(materials_[*index]), transform = info.object("extensions").object("KHR_texture_transform");
    mapping.set = transform.count("texCoord", info.count("texCoord", 0));
    const std::array<double, 2> offset = transform.numbers<2>("offset", {0, 0}), scale = transform.numbers<2>("scale", {1, 1});
    // Counter-clockwise where v points down.
    const double angle = transform.number("rotation", 0), c = std::cos(angle), s = std::sin(angle);
    mapping.matrix = {c * scale[0], s * scale[1], offset[0], -s * scale[0], c * scale[1], offset[1]};
    return mapping;
}

rt_u32 Materials::texture(const Value& info) {
    if (!info.has("index")) return RT_NONE;
    const Value texture = textures_[info["index"].index(textures_)];
    const auto image = texture.index("source", images_);
    if (!image) {
        // Only an extension names an image, of a kind that the host does not read (WebP, KTX).
        const std::string text = texture.path() + " has no 'source', so the material stays without it";
        return rt::warn(sink_, text), RT_NONE;
    }
    if (!image_ids_[*image]) image_ids_[*image] = add_image(images_[*image]);
    return *image_ids_[*image];
}

rt_u32 Materials::add_image(const Value& image) {
    rt_texture_desc out{};
    out.struct_bytes = sizeof out;
    std::string bytes_or_path;
    std::string_view bytes;
    if (image.has("bufferView")) {
        bytes = accessors_.view(image["bufferView"]);
    } else if (const Value uri = image["uri"]; decode_data_uri(uri, bytes_or_path)) {
        bytes = bytes_or_path;
    } else {
        // The host decides what may be read, and looks in the usual places for textures.
        bytes_or_path = percent_decoded(uri.text());
        out.path = bytes_or_path.c_str();
        return sink_.texture(sink_.ctx, &out);
    }
    if (bytes.empty()) image.refuse("an empty image", "an encoded one");
    out.bytes = reinterpret_cast<const uint8_t*>(bytes.data());
    out.byte_count = bytes.size();
    return sink_.texture(sink_.ctx, &out);
}

}  // namespace gltf_import
