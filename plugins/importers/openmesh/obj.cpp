// obj.cpp -- reads Wavefront OBJ. Each line is checked before OpenMesh reads it. So a broken line costs only that line, the
// numbers of later vertices stay right, and the material of each face is known.
#include <map>
#include <optional>
#include <string>

#include "../common/mapped_file.hpp"
#include "mtl.hpp"
#include "readers.hpp"
#include "rt_plugin.hpp"
#include "text.hpp"

namespace openmesh_import {
namespace {

// True for the corner of a face: `7`, `7/1`, `7//3`, `7/1/3`, `-1/-1/-1`.
bool is_corner(std::string_view word) {
    for (int part = 0; part < 3; ++part) {
        const size_t slash = word.find('/');
        const std::string_view number = word.substr(0, slash);
        long long value;
        if (number.empty() ? part == 0 : (!parse_integer(number, value) || value > 2147483647 || value < -2147483647))
            return false;
        if (slash == word.npos) return true;
        word.remove_prefix(slash + 1);
    }
    return word.empty();
}

class ObjLines {
 public:
    ObjLines(const Source& source, FlatImporter& mesh) : source_(source), mesh_(mesh) {}

    // Edits one line for OpenMesh; false drops the line. The reader goes through the file twice: for vertices, then for faces.
    bool edit(std::string_view line, int pass, std::string& out) {
        line = trim(before_comment(line));
        const std::string_view word = next_word(line);
        if (word == "v") {
            if (pass == 0) vertex(line, out);
            if (pass > 0) out = "v";
            return true;
        }
        if (word == "vt" || word == "vn") {
            out = word;
            if (pass == 0) numbers(line, word == "vt" ? 2 : 3, out);
            return true;
        }
        if (pass == 0) return false;
        if (word == "f") return face(line, out);
        if (word == "l" || word == "p") ++points_and_lines;
        if (word == "mtllib") library(line);
        if (word == "usemtl") use(std::string(trim(line)));
        return false;
    }
    rt_u32 material() const { return material_; }

    uint64_t points_and_lines = 0, bad_faces = 0, faces = 0;
    std::string first_bad_face;
    LineBuffer* buffer = nullptr;

 private:
    // A vertex that cannot be read keeps its number, but faces must not use it.
    void vertex(std::string_view rest, std::string& out) {
        const std::string_view numbers = trim(rest);
        float xyz[3];
        bool good = true;
        for (float& x : xyz) good = good && parse_float(next_word(rest), x);
        out = "v ";
        if (good) out.append(numbers);
        if (!good) {
            out.append("0 0 0");
            mesh_.mark_unusable(vertices_);
        }
        ++vertices_;
    }
    void numbers(std::string_view rest, int count, std::string& out) {
        for (int i = 0; i < count; ++i) {
            float x;
            const std::string_view word = next_word(rest);
            out.append(" ").append(parse_float(word, x) ? word : "0");
        }
    }
    bool face(std::string_view rest, std::string& out) {
        out = "f";
        int corners = 0;
        bool good = true;
        for (std::string_view words = rest; good;) {
            const std::string_view word = next_word(words);
            if (word.empty()) break;
            good = is_corner(word);
            ++corners;
            out.append(" ").append(word);
        }
        good = good && corners >= 3;
        ++faces;
        if (!good && bad_faces++ == 0) first_bad_face = "line " + std::to_string(buffer->line_number()) + ": " + quoted(rest);
        return good;
    }

    void library(std::string_view rest) {
        // A line may list several files, and a name may contain spaces. The whole rest of the line is tried first.
        const std::string folder = source_.path.substr(0, source_.path.find_last_of('/') + 1);
        if (open_library(folder, std::string(trim(rest)))) return;
        bool found = false;
        for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
            found = open_library(folder, std::string(word)) || found;
            if (!found) missing_ = std::string(word);
        }
        if (!found)
            warn(source_,
                 "the material file " + quoted(missing_) + " cannot be read: its materials become the default material");
        has_missing_library_ = has_missing_library_ || !found;
    }
    bool open_library(const std::string& folder, std::string name) {
        for (char& c : name) c = c == '\\' ? '/' : c;
        try {
            const importers::MappedFile file((name.empty() || name.front() == '/' ? "" : folder) + name);
            parse_mtl(file.bytes(), materials_);
            return true;
        } catch (const std::runtime_error&) {
            return false;
        }
    }
    void use(const std::string& name) {
        const auto known = ids_.find(name);
        if (known != ids_.end()) {
            material_ = known->second;
            return;
        }
        const auto found = materials_.find(name);
        if (found == materials_.end()) {
            if (!has_missing_library_ && !materials_.empty()) warn(source_, "material " + quoted(name) + " is not defined");
            material_ = ids_[name] = RT_NONE;
            return;
        }
        rt_material_desc desc = found->second.values;
        desc.struct_bytes = sizeof desc;
        desc.name = name.c_str();
        if (!found->second.texture.empty()) desc.texture = texture(found->second.texture);
        material_ = ids_[name] = rt::id(source_.sink.material(source_.sink.ctx, &desc));
    }
    rt_u32 texture(const std::string& path) {
        const auto known = textures_.find(path);
        if (known != textures_.end()) return known->second;
        rt_texture_desc desc{};
        desc.struct_bytes = sizeof desc;
        desc.path = path.c_str();
        return textures_[path] = source_.sink.texture(source_.sink.ctx, &desc);
    }

    const Source& source_;
    FlatImporter& mesh_;
    size_t vertices_ = 0;
    std::map<std::string, ObjMaterial> materials_;
    std::map<std::string, rt_u32> ids_, textures_;
    rt_u32 material_ = RT_NONE;
    std::string missing_;
    bool has_missing_library_ = false;
};

}  // namespace

void read_obj(const Source& source, FlatImporter& mesh) {
    ObjLines lines(source, mesh);
    LineBuffer buffer(
        source.bytes, true, [&](std::string_view line, int pass, std::string& out) { return lines.edit(line, pass, out); }, 2,
        source.progress);
    lines.buffer = &buffer;
    mesh.material_of_next_face = [&] { return lines.material(); };
    mesh.line_number = [&] { return buffer.line_number(); };
    run_reader("obj", buffer, false, false, false, mesh);
    mesh.material_of_next_face = nullptr;
    mesh.line_number = nullptr;

    if (lines.bad_faces > 0) {
        const std::string text =
            counted(lines.bad_faces, "face") + " left out because they cannot be read, the first at " + lines.first_bad_face;
        if (lines.bad_faces == lines.faces) throw std::runtime_error(text);
        warn(source, text);
    }
    const uint64_t collapsed = lines.faces - lines.bad_faces - mesh.face_count();
    if (collapsed > 0) warn(source, counted(collapsed, "face") + " left out: fewer than three different corners");
    if (lines.points_and_lines > 0) warn(source, counted(lines.points_and_lines, "point or line element") + " skipped");
}

}  // namespace openmesh_import
