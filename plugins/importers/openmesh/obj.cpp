// obj.cpp -- reads Wavefront OBJ. A broken line costs only that line, and the numbers of later vertices stay right. Materials
// are looked up when the file has been read whole, because programs name them before their library.
#include <unistd.h>

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "../common/mapped_file.hpp"
#include "../common/numbers.hpp"
#include "../common/texture_path.hpp"
#include "mtl.hpp"
#include "readers.hpp"
#include "rt_plugin.hpp"
#include "text.hpp"

namespace openmesh_import {
namespace {

// Finds the material libraries and pictures that an OBJ file names, and gives its materials to the host.
class ObjLibraries {
 public:
    // lines: what stands behind each `mtllib`. Reads the libraries, and warns about those that cannot be read.
    ObjLibraries(const Source& source, const std::vector<std::string>& lines);

    // The material of a name that is used behind `before` lines with libraries: of the last of them that has it, or else of the
    // first line behind. nullptr: there is none.
    const ObjMaterial* find(const std::string& name, size_t before) const;
    // The host's number of a material, which it gets at the first call. Warns if there is none.
    rt_u32 id(const std::string& name, const ObjMaterial* material);

 private:
    void read_line(std::string_view line, Library& library);
    bool read_file(std::string name, Library& library);
    void warn_of_left_out(const std::string& name, const ObjMaterial& material) const;
    std::string picture(const ObjMaterial& material, const std::vector<std::string>& names) const;
    rt_u32 texture(const ObjMaterial& material, const ObjMap& map);

    const Source& source_;
    const std::string folder_;  // of the OBJ file
    std::vector<Library> libraries_;
    std::map<const ObjMaterial*, rt_u32> ids_;
    std::map<std::tuple<std::string, bool, rt_u32>, rt_u32> textures_;  // by picture, clamped, space
    std::set<std::string> unknown_;
    bool has_missing_ = false;
};

std::string file_name(const std::string& path) {
    return path.substr(path.find_last_of('/') + 1);
}

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

// The numbers of a corner as written: vertex, uv, normal; 0: there is none.
struct Corner {
    long long numbers[3] = {0, 0, 0};
};

// Reads the corner of a face: `7`, `7/1`, `7//3`, `7/1/3`, `-1/-1/-1`.
bool parse_corner(std::string_view word, Corner& corner) {
    for (int part = 0; part < 3; ++part) {
        const char* const end = word.data() + word.size();
        const char* at = word.data();
        if (at < end && *at == '+') ++at;
        long long value = 0;
        const auto [stop, error] = std::from_chars(at, end, value);
        if (stop == at ? (part == 0 || at != word.data()) : (error != std::errc() || value > 2147483647 || value < -2147483647))
            return false;
        corner.numbers[part] = value;
        if (stop == end) return true;
        if (*stop != '/') return false;
        word.remove_prefix(static_cast<size_t>(stop + 1 - word.data()));
    }
    return word.empty();
}

// `count` numbers are known so far: -1 is the last of them, 1 the first one.
rt_u32 number_of(long long written, size_t count) {
    if (written == 0) return RT_NONE;
    return FlatMesh::vertex_number(written > 0 ? written - 1 : static_cast<long long>(count) + written);
}

class ObjReader {
 public:
    ObjReader(const Source& source, FlatMesh& mesh) : source_(source), mesh_(mesh), lines_(source.bytes) {}

    // Reads up to the end, or until the mesh has `most_faces`.
    void read(size_t most_faces) {
        Steps steps(source_);
        for (std::string_view line; mesh_.sizes.size() < most_faces && lines_.next_joined(line);) {
            steps.step([&] { return lines_.fraction(); });
            line_ = line;
            const std::string_view word = next_word(line);
            if (word.empty() || word.front() == '#') continue;
            if (word == "v") {
                vertex(before_comment(line));
            } else if (word == "f" || word == "fo") {  // fo: a face in files of Wavefront 2
                face(before_comment(line));
            } else if (word == "vt") {
                values(before_comment(line), 2, mesh_.corner_uvs);
            } else if (word == "vn") {
                values(before_comment(line), 3, mesh_.corner_normals);
            } else if (word == "l" || word == "p") {
                ++points_and_lines;
            } else if (is_word(word, "mtllib")) {
                libraries.emplace_back(trim(line));
            } else if (is_word(word, "usemtl")) {
                use(std::string(without_quotes(trim(line))));
            }
        }
    }
    size_t line_number() const { return lines_.number(); }

    struct Use {
        std::string name;
        size_t libraries;  // lines with libraries before it
    };
    std::vector<Use> uses;
    std::vector<std::string> libraries;  // what stands behind each `mtllib`
    uint64_t points_and_lines = 0, bad_faces = 0;
    std::string first_bad_face;

 private:
    void vertex(std::string_view rest) {
        double xyz[3];
        bool good = true;
        for (double& x : xyz) good = parse_float(next_word(rest), x) && good;
        mesh_.add_vertex(good ? xyz[0] : NAN, xyz[1], xyz[2]);
        // `v x y z r g b`; one number more is a weight. Files of scans have them in sRGB, as the pictures that they come from,
        // and Blender and three.js read them so; the format does not know them.
        float rgb[3];
        int more = 0;
        for (double x; more < 3 && parse_float(next_word(rest), x); ++more) rgb[more] = importers::linear_of_srgb(x);
        if (more < 3 && mesh_.colors.empty()) return;
        mesh_.colors.resize(4 * mesh_.vertex_count(), 1.0f);
        if (more == 3) std::copy_n(rgb, 3, mesh_.colors.end() - 4);
    }
    static void values(std::string_view rest, int count, std::vector<float>& out) {
        for (int i = 0; i < count; ++i) {
            float x;
            out.push_back(parse_float(next_word(rest), x) ? x : 0);
        }
    }
    void face(std::string_view rest) {
        corners_.clear();
        bool good = true;
        for (std::string_view word = next_word(rest); good && !word.empty(); word = next_word(rest)) {
            Corner corner;
            good = parse_corner(word, corner);
            corners_.push_back(corner);
        }
        if (!good || corners_.size() < 3) {
            std::string_view text = line_;
            next_word(text);
            if (bad_faces++ == 0)
                first_bad_face = "line " + std::to_string(lines_.number()) + ": " + quoted(before_comment(text));
            return;
        }
        for (const Corner& corner : corners_) mesh_.corners.push_back(number_of(corner.numbers[0], mesh_.vertex_count()));
        attributes(1, mesh_.corner_uvs.size() / 2, mesh_.uv_of_corner);
        attributes(2, mesh_.corner_normals.size() / 3, mesh_.normal_of_corner);
        mesh_.add_face(corners_.size());
        if (use_ == RT_NONE) return;
        mesh_.face_materials.resize(mesh_.sizes.size() - 1, RT_NONE);  // faces before the first `usemtl`
        mesh_.face_materials.push_back(use_);
    }
    // The uvs or normals of the face's corners. Files without them need no list.
    void attributes(int part, size_t count, std::vector<rt_u32>& list) {
        if (list.empty() &&
            std::all_of(corners_.begin(), corners_.end(), [&](const Corner& c) { return c.numbers[part] == 0; }))
            return;
        list.resize(mesh_.corners.size() - corners_.size(), RT_NONE);
        for (const Corner& corner : corners_) list.push_back(number_of(corner.numbers[part], count));
    }
    void use(const std::string& name) {
        const auto same = [&](const Use& u) { return u.name == name && u.libraries == libraries.size(); };
        const auto known = use_of_name_.find(name);
        if (known != use_of_name_.end() && same(uses[known->second])) {
            use_ = known->second;
            return;
        }
        use_ = use_of_name_[name] = static_cast<rt_u32>(uses.size());
        uses.push_back({name, libraries.size()});
    }

    const Source& source_;
    FlatMesh& mesh_;
    Lines lines_;
    std::string_view line_;
    std::vector<Corner> corners_;
    std::map<std::string, rt_u32> use_of_name_;
    rt_u32 use_ = RT_NONE;
};

// From the numbers of uses to the host's materials.
void assign_materials(const Source& source, const ObjReader& reader, FlatMesh& mesh) {
    ObjLibraries libraries(source, reader.libraries);
    std::vector<rt_u32> ids;
    for (const ObjReader::Use& use : reader.uses) {
        const ObjMaterial* material = libraries.find(use.name, use.libraries);
        ids.push_back(libraries.id(use.name, material));
    }
    mesh.uv_of_corner.resize(mesh.uv_of_corner.empty() ? 0 : mesh.corners.size(), RT_NONE);
    for (rt_u32& material : mesh.face_materials) material = material == RT_NONE ? RT_NONE : ids[material];
}

}  // namespace

Reading read_obj(const Source& source, FlatMesh& mesh) {
    ObjReader reader(source, mesh);
    reader.read(SIZE_MAX);
    if (reader.bad_faces > 0) {
        const std::string text =
            counted(reader.bad_faces, "face") + " left out because they cannot be read, the first at " + reader.first_bad_face;
        if (mesh.sizes.empty()) throw std::runtime_error(text);
        warn(source, text);
    }
    for (auto* list : {&mesh.uv_of_corner, &mesh.normal_of_corner})
        if (!list->empty()) list->resize(mesh.corners.size(), RT_NONE);
    if (mesh.corner_uvs.empty()) mesh.uv_of_corner.clear();
    if (mesh.corner_normals.empty()) mesh.normal_of_corner.clear();
    Reading reading;
    reading.first_number = 1;
    reading.place_of_face = [&source](size_t face) {
        FlatMesh again;
        ObjReader until(source, again);
        until.read(face + 1);
        return "line " + std::to_string(until.line_number()) + ": ";
    };
    reading.points_and_lines = reader.points_and_lines;
    if (mesh.sizes.empty()) return reading;
    assign_materials(source, reader, mesh);
    if (reader.points_and_lines > 0) warn(source, counted(reader.points_and_lines, "point or line element") + " skipped");
    return reading;
}

}  // namespace openmesh_import
