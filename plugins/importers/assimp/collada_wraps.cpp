#include "collada_wraps.hpp"

#include <charconv>
#include <vector>

#include "xml_tags.hpp"

namespace assimp_import {
namespace {

std::string trimmed(std::string_view text) {
    const size_t first = text.find_first_not_of(kXmlBlanks);
    return first == text.npos ? "" : std::string(text.substr(first, text.find_last_not_of(kXmlBlanks) + 1 - first));
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

// <image id><init_from>file; in an <effect>: <newparam sid="surface"><surface><init_from>image, and
// <newparam><sampler2D><source>surface</source><wrap_s>CLAMP</wrap_s><wrap_t>MIRROR. COLLADA 1.5 has <ref> within <init_from>,
// and <instance_image url> in place of the surface. Source: COLLADA 1.4.1 and 1.5.0 specifications, Khronos Group, 2008.
ColladaWraps collada_wraps(std::string_view text) {
    struct Sampler {
        std::string image;
        Wrap wrap = {RT_WRAP_REPEAT, RT_WRAP_REPEAT};
    } sampler;
    std::vector<Sampler> samplers;
    std::map<std::string, std::string> files, surfaces;  // by ids of images; ids of images by sids within an effect
    std::string image, parameter;
    for (XmlTags tags(text); tags.next();) {
        if (!tags.is_tag) continue;
        if (!tags.ends) {
            if (tags.name == "effect") surfaces.clear();
            if (tags.name == "image") image = xml_attribute(tags.tag, "id");
            if (tags.name == "newparam") parameter = xml_attribute(tags.tag, "sid");
            if (tags.name == "sampler2D") sampler = {};
            if (tags.name == "instance_image") {
                const std::string url = trimmed(xml_attribute(tags.tag, "url"));
                sampler.image = url.substr(url.find('#') == 0 ? 1 : 0);
            }
            continue;
        }
        const std::string word = trimmed(tags.before);
        if (tags.name == "image") image.clear();
        if ((tags.name == "init_from" || tags.name == "ref") && !word.empty())
            (image.empty() ? surfaces[parameter] : files[image]) = word;
        if (tags.name == "source" && surfaces.count(word)) sampler.image = surfaces[word];
        if (tags.name == "wrap_s") sampler.wrap.first = wrap_mode(word);
        if (tags.name == "wrap_t") sampler.wrap.second = wrap_mode(word);
        if (tags.name == "sampler2D") samplers.push_back(sampler);
    }
    ColladaWraps out;
    std::map<std::string, Wrap> first;
    for (const Sampler& s : samplers) {
        const auto file = files.find(s.image);
        if (file == files.end()) continue;
        const std::string name = file_name(file->second);
        const auto [known, is_new] = first.emplace(name, s.wrap);
        if (known->second != s.wrap) out.differs = name;
        if (is_new && s.wrap != Wrap(RT_WRAP_REPEAT, RT_WRAP_REPEAT)) out.of_picture[name] = s.wrap;
    }
    return out;
}

}  // namespace assimp_import
