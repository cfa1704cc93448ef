#include "obj_libraries.hpp"

#include <unistd.h>

#include <algorithm>
#include <stdexcept>

#include "../common/mapped_file.hpp"
#include "../common/texture_path.hpp"
#include "rt_plugin.hpp"
#include "text.hpp"

namespace openmesh_import {
namespace {

std::string file_name(const std::string& path) {
    return path.substr(path.find_last_of('/') + 1);
}

}  // namespace

ObjLibraries::ObjLibraries(const Source& source, const std::vector<std::string>& lines)
    : source_(source), folder_(source.path.substr(0, source.path.find_last_of('/') + 1)), libraries_(lines.size()) {
    for (size_t i = 0; i < lines.size(); ++i) {
        // Programs that write `mtllib` before each object name the same library many times.
        const auto same = std::find(lines.begin(), lines.begin() + static_cast<ptrdiff_t>(i), lines[i]);
        if (same == lines.begin() + static_cast<ptrdiff_t>(i)) read_line(lines[i], libraries_[i]);
    }
}

// A line may list several libraries, and names may hold blanks and '#', so the longest name that is a file's counts. A '#' that
// begins a word which is part of no file's name begins a comment.
void ObjLibraries::read_line(std::string_view line, Library& library) {
    std::string missing;
    const std::string whole(trim(line));
    bool found = false;
    constexpr int kMostMissing = 64;
    int missing_words = 0;
    for (line = trim(line); !line.empty() && missing_words < kMostMissing; line = trim(line)) {
        size_t end = line.size();
        if (line.front() == '"' && line.find('"', 1) != line.npos) end = line.find('"', 1) + 1;
        const auto shorter = [&] {
            while (end > 0 && !is_blank(line[end - 1])) --end;
            while (end > 0 && is_blank(line[end - 1])) --end;
        };
        constexpr int kMostTries = 64;
        int tries = 0;
        while (end > 0 && tries++ < kMostTries && !read_file(std::string(without_quotes(trim(line.substr(0, end)))), library))
            shorter();
        if (end > 0 && tries <= kMostTries) {
            found = true;
            line.remove_prefix(end);
            continue;
        }
        if (line.front() == '#') break;
        const std::string_view word = next_word(line);
        if (missing_words++ == 0) missing = std::string(word);
    }
    if (found && missing.empty()) return;
    has_missing_ = true;
    warn(source_,
         "the material file " + quoted(found ? missing : whole) + " cannot be read: its materials become the default material");
}

bool ObjLibraries::read_file(std::string name, Library& library) {
    if (name.empty()) return false;
    std::replace(name.begin(), name.end(), '\\', '/');
    const bool is_absolute = name.front() == '/' || (name.size() > 1 && name[1] == ':');
    // The path of another machine: the library may lie beside.
    for (const std::string& path : {is_absolute ? name : folder_ + name, folder_ + file_name(name)}) {
        try {
            const importers::MappedFile file(path);
            const std::string beside = path.compare(0, folder_.size(), folder_) == 0 ? path.substr(folder_.size()) : path;
            parse_mtl(file.bytes(), beside.substr(0, beside.find_last_of('/') + 1), library);
            return true;
        } catch (const std::runtime_error&) {
        }
    }
    return false;
}

const ObjMaterial* ObjLibraries::find(const std::string& name, size_t before) const {
    for (size_t i = before; i > 0; --i)
        if (const ObjMaterial* found = libraries_[i - 1].find(name)) return found;
    for (size_t i = before; i < libraries_.size(); ++i)
        if (const ObjMaterial* found = libraries_[i].find(name)) return found;
    return nullptr;
}

rt_u32 ObjLibraries::id(const std::string& name, const ObjMaterial* material) {
    if (!material) {
        const bool any =
            std::any_of(libraries_.begin(), libraries_.end(), [](const Library& l) { return !l.materials.empty(); });
        if (any && !has_missing_ && !name.empty() && unknown_.insert(name).second)
            warn(source_, "material " + quoted(name) + " is not defined");
        return RT_NONE;
    }
    const auto known = ids_.find(material);
    if (known != ids_.end()) return known->second;
    rt_material_desc desc = material->values;
    desc.struct_bytes = sizeof desc;
    desc.name = name.c_str();
    std::vector<rt_map_desc> maps;
    for (const ObjMap& map : material->maps) {
        const ObjTexture& t = map.texture;
        rt_map_desc out = rt::map(map.use, texture(*material, map));
        if (map.space == RT_SPACE_HEIGHT) out.scale = t.bump;
        const float matrix[6] = {t.scale[0], 0, t.offset[0], 0, t.scale[1], t.offset[1]};
        std::copy_n(matrix, 6, out.matrix);
        if (out.texture != RT_NONE) maps.push_back(out);
    }
    importers::give_maps(maps, desc);
    material->keys.give(desc);
    warn_of_left_out(name, *material);
    return ids_[material] = rt::id(source_.sink.material(source_.sink.ctx, &desc));
}

// One warning for each material that is used.
void ObjLibraries::warn_of_left_out(const std::string& name, const ObjMaterial& material) const {
    if (material.left_out.empty()) return;
    std::string list;
    for (const std::string& what : material.left_out) list += (list.empty() ? "" : ", ") + what;
    warn(source_, "material " + quoted(name) + ": left out " + list);
}

// The name of the picture that is there: beside the library, beside the OBJ file, or in its folder `textures`. If none is, the
// host says so of the likeliest name, and looks in the search paths.
std::string ObjLibraries::picture(const ObjMaterial& material, const std::vector<std::string>& names) const {
    const auto is_there = [&](const std::string& path) {
        return access((path.front() == '/' ? path : folder_ + path).c_str(), R_OK) == 0;
    };
    for (const std::string& name : names) {
        const std::string path = importers::with_slashes(name);
        if (path.empty()) continue;
        for (const std::string& place : {path.front() == '/' ? path : material.folder + path, path, file_name(path),
                                         material.folder + file_name(path), "textures/" + file_name(path)})
            if (!place.empty() && place.back() != '/' && is_there(place)) return place;
    }
    const auto plain = std::find_if(names.begin(), names.end(), [](const std::string& name) {
        return comment_in_name(name) == name.npos && name.find('.') != name.npos;
    });
    return plain == names.end() ? names.front() : *plain;
}

rt_u32 ObjLibraries::texture(const ObjMaterial& material, const ObjMap& map) {
    const auto key = std::make_tuple(picture(material, map.texture.names), map.texture.clamped, map.space);
    const auto known = textures_.find(key);
    if (known != textures_.end()) return known->second;
    rt_texture_desc desc{};
    desc.struct_bytes = sizeof desc;
    desc.path = std::get<0>(key).c_str();
    desc.space = map.space;
    if (map.texture.clamped) desc.wrap_u = desc.wrap_v = RT_WRAP_CLAMP;
    return textures_[key] = source_.sink.texture(source_.sink.ctx, &desc);
}

}  // namespace openmesh_import
