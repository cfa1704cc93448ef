#include "collada_pictures.hpp"

#include <array>
#include <charconv>
#include <sstream>
#include <vector>

#include "../common/materials.hpp"
#include "xml_tags.hpp"

namespace assimp_import {
namespace {

std::string trimmed(std::string_view text) {
    const size_t first = text.find_first_not_of(kXmlBlanks);
    return first == text.npos ? "" : std::string(text.substr(first, text.find_last_not_of(kXmlBlanks) + 1 - first));
}

// The id that a reference within the file means.
std::string after_hash(std::string_view reference) {
    const std::string url = trimmed(reference);
    return url.substr(url.find('#') == 0 ? 1 : 0);
}

// NONE and BORDER have a colour around the picture, for which its own border is nearer than its repetition.
rt_u32 wrap_mode(const std::string& word) {
    return word == "MIRROR"                                        ? RT_WRAP_MIRROR
           : word == "CLAMP" || word == "BORDER" || word == "NONE" ? RT_WRAP_CLAMP
                                                                   : RT_WRAP_REPEAT;
}

}  // namespace

std::string file_name(std::string_view reference) {
    const size_t folders = reference.find_last_of("/\\");
    if (folders != reference.npos) reference.remove_prefix(folders + 1);
    std::string out;
    while (!reference.empty()) {
        const char* const digits = reference.data() + 1;
        unsigned char code = 0;
        const bool is_code =
            reference.size() > 2 && reference[0] == '%' && std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2;
        out += is_code ? static_cast<char>(code) : reference[0];
        reference.remove_prefix(is_code ? 3 : 1);
    }
    return out;
}

namespace {

// <image id><init_from>file; in an <effect>: <newparam sid="surface"><surface><init_from>image, and
// <newparam sid="sampler"><sampler2D><source>surface</source><wrap_s>CLAMP</wrap_s><wrap_t>MIRROR. COLLADA 1.5 has <ref> within
// <init_from>, and <instance_image url> in place of the surface. <transparent opaque="A_ONE"><texture texture="sampler"/>, and
// <transparency><float>1; <material name><instance_effect url="#effect"/>. Source: COLLADA 1.4.1 and 1.5.0 specifications,
// Khronos Group, 2008.
class Reader {
 public:
    void read(std::string_view text) {
        for (XmlTags tags(text); tags.next();) {
            if (!tags.is_tag) continue;
            if (tags.ends)
                end(tags.name, trimmed(tags.before));
            else
                begin(tags);
        }
    }
    ColladaPictures pictures() const {
        ColladaPictures out;
        std::map<std::string, Wrap> first;
        for (const Sampler& s : samplers_) {
            const std::string name = picture(s.image);
            if (name.empty()) continue;
            const auto [known, is_new] = first.emplace(name, s.wrap);
            if (known->second != s.wrap) out.differs = name;
            if (is_new && s.wrap != Wrap(RT_WRAP_REPEAT, RT_WRAP_REPEAT)) out.wraps[name] = s.wrap;
        }
        for (const auto& [image, transparency] : transparencies_) {
            const std::string name = picture(image);
            if (!name.empty()) out.transparencies.emplace(name, transparency);
        }
        for (const auto& [material, effect] : effects_) {
            if (shiny_effects_.count(effect)) out.shininess.insert(material);
            if (hued_effects_.count(effect)) out.hues.insert(material);
        }
        return out;
    }

 private:
    struct Sampler {
        std::string image;
        Wrap wrap = {RT_WRAP_REPEAT, RT_WRAP_REPEAT};
    };
    static bool is_hued(const std::string& color) {
        std::istringstream text(color);
        std::array<double, 3> rgb{};
        return (text >> rgb[0] >> rgb[1] >> rgb[2]) && importers::has_hue(rgb);
    }
    std::string picture(const std::string& image) const {
        const auto file = files_.find(image);
        return file == files_.end() ? "" : file_name(file->second);
    }

    void begin(const XmlTags& tags) {
        const std::string_view name = tags.name;
        if (name == "effect") effect_ = xml_attribute(tags.tag, "id");
        if (name == "material") {
            const std::string_view shown = xml_attribute(tags.tag, "name");
            material_ = shown.empty() ? xml_attribute(tags.tag, "id") : shown;
        }
        if (name == "instance_effect") effects_[material_] = after_hash(xml_attribute(tags.tag, "url"));
        if (name == "shininess") is_in_shininess_ = !tags.is_empty;
        if (name == "texture" && is_in_shininess_) shiny_effects_.insert(effect_);
        if (name == "effect") surfaces_.clear(), images_of_samplers_.clear(), clear_ = {}, clear_image_.clear();
        if (name == "image") image_ = xml_attribute(tags.tag, "id");
        if (name == "newparam") parameter_ = xml_attribute(tags.tag, "sid");
        if (name == "sampler2D") sampler_ = {};
        if (name == "instance_image") sampler_.image = after_hash(xml_attribute(tags.tag, "url"));
        if (name == "transparent" && !tags.is_empty) {
            is_in_transparent_ = true;
            const std::string_view mode = xml_attribute(tags.tag, "opaque");
            clear_.mode = mode.empty() ? "A_ONE" : mode;
        }
        if (name == "transparency") is_in_transparency_ = !tags.is_empty;
        if (name == "texture" && is_in_transparent_) {
            const auto known = images_of_samplers_.find(std::string(xml_attribute(tags.tag, "texture")));
            if (known != images_of_samplers_.end()) clear_image_ = known->second;
        }
    }

    void end(std::string_view name, const std::string& word) {
        if (name == "image") image_.clear();
        if ((name == "init_from" || name == "ref") && !word.empty())
            (image_.empty() ? surfaces_[parameter_] : files_[image_]) = word;
        if (name == "source" && surfaces_.count(word)) sampler_.image = surfaces_[word];
        if (name == "wrap_s") sampler_.wrap.first = wrap_mode(word);
        if (name == "wrap_t") sampler_.wrap.second = wrap_mode(word);
        if (name == "sampler2D") {
            samplers_.push_back(sampler_);
            images_of_samplers_[parameter_] = sampler_.image;
        }
        if (name == "color" && is_in_transparent_ && clear_.mode.rfind("RGB", 0) == 0 && is_hued(word))
            hued_effects_.insert(effect_);
        if (name == "transparent") is_in_transparent_ = false;
        if (name == "shininess") is_in_shininess_ = false;
        if (name == "transparency") is_in_transparency_ = false;
        if (name == "float" && is_in_transparency_) std::from_chars(word.data(), word.data() + word.size(), clear_.factor);
        if (name == "effect" && !clear_image_.empty()) transparencies_.emplace_back(clear_image_, clear_);
    }

    Sampler sampler_;
    std::vector<Sampler> samplers_;
    std::map<std::string, std::string> files_;                          // by ids of images
    std::map<std::string, std::string> surfaces_, images_of_samplers_;  // ids of images by sids within an effect
    std::vector<std::pair<std::string, Transparency>> transparencies_;  // by ids of images
    std::map<std::string, std::string> effects_;                        // ids by names of materials
    std::set<std::string> shiny_effects_;                               // ids of those with a picture of the shininess
    std::set<std::string> hued_effects_;                                // and of those whose transparency has a hue
    std::string image_, parameter_, clear_image_, effect_, material_;
    Transparency clear_;
    bool is_in_transparent_ = false, is_in_transparency_ = false, is_in_shininess_ = false;
};

}  // namespace

ColladaPictures collada_pictures(std::string_view text) {
    Reader reader;
    reader.read(text);
    return reader.pictures();
}

}  // namespace assimp_import
