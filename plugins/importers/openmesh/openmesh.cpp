// openmesh.cpp -- the importer plugin for OBJ, PLY, STL, OFF, and OpenMesh's own OM. It keeps every face of the file.
#include <algorithm>
#include <cctype>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include "../common/file_kind.hpp"
#include "../common/mapped_file.hpp"
#include "../common/texture_path.hpp"
#include "ply_header.hpp"
#include "readers.hpp"
#include "rt_plugin.hpp"
#include "text.hpp"

namespace openmesh_import {

namespace {

// The share of reading in the progress. The rest is the host's copy.
constexpr float kReadShare = 0.9f;

std::string lower_extension(const std::string& path) {
    const size_t dot = path.find_last_of("./");
    std::string extension = dot == path.npos || path[dot] == '/' ? "" : path.substr(dot + 1);
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return extension;
}

rt_u32 texture_material(const Source& source, const std::string& path) {
    rt_texture_desc texture{};
    texture.struct_bytes = sizeof texture;
    texture.path = path.c_str();
    rt_material_desc material{};
    material.struct_bytes = sizeof material;
    material.name = path.c_str();
    material.texture = source.sink.texture(source.sink.ctx, &texture);
    if (material.texture == RT_NONE) return RT_NONE;
    std::fill(material.color, material.color + 3, 1.0f);
    material.shininess = material.ior = 1;
    return rt::id(source.sink.material(source.sink.ctx, &material));
}

void emit(const Source& source, FlatMesh& mesh, rt_u32 material) {
    const std::string name = importers::FilePlace(source.path).stem;
    if (std::all_of(mesh.sizes.begin(), mesh.sizes.end(), [](rt_u32 n) { return n == 3; })) mesh.sizes.clear();
    std::vector<rt_u32> materials = std::move(mesh.face_materials);
    if (materials.empty()) materials = {material};
    rt_instance_desc instance{};
    instance.struct_bytes = sizeof instance;
    instance.name = name.c_str();
    instance.mesh = mesh.pass(name, mesh.corners.data(), mesh.corners.size(), materials, source.sink);
    instance.material = RT_NONE;
    for (const int diagonal : {0, 5, 10}) instance.world_from_object[diagonal] = 1;
    rt::id(source.sink.instance(source.sink.ctx, &instance));
}

struct Format {
    std::string_view extension, word;  // word: with which files begin that can be told without their extension
    Reading (*read)(const Source&, FlatMesh&);
};
constexpr Format kFormats[] = {
    {"obj", "", read_obj},    {"stl", "", read_stl}, {"stla", "", read_stl},   {"stlb", "", read_stl},
    {"ply", "ply", read_ply}, {"om", "OM", read_om}, {"off", "OFF", read_off},
};

const Format& format_of(const std::string& path, std::string_view bytes) {
    const std::string extension = lower_extension(path);
    for (const Format& format : kFormats)
        if (format.extension == extension) return format;
    for (const Format& format : kFormats)
        if (!format.word.empty() && bytes.substr(0, format.word.size()) == format.word) return format;
    throw std::runtime_error("its extension is not one of obj, ply, stl, off and om");
}

Reading read(const Format& format, const Source& source, FlatMesh& mesh) {
    try {
        return format.read(source, mesh);
    } catch (const std::bad_alloc&) {
        throw std::runtime_error(
            "needs more memory than an import may take: a count in it is damaged, or the file is too large");
    } catch (const std::length_error&) {
        throw std::runtime_error("found a number that counts more than memory can hold: it is damaged");
    }
}

// "line 8: vertex 3 is not finite"
std::string first_broken(const Reading& reading, const FlatMesh& mesh, size_t vertices) {
    std::string text = reading.place_of_face ? reading.place_of_face(mesh.first_broken_face) : "";
    if (mesh.first_broken_vertex == RT_NONE) {
        text += "a vertex number out of range";
    } else {
        text += "vertex " + std::to_string(uint64_t(mesh.first_broken_vertex) + reading.first_number);
        if (mesh.first_broken_vertex < vertices) return text + " is not finite";
    }
    return text + ", and there are " + std::to_string(vertices);
}

int32_t load(const rt_host* host, const char* path, const double*, const rt_scene_sink* sink) {
    const importers::MappedFile file(host, path);
    if (file.bytes().empty()) throw std::runtime_error("the file is empty");
    const char* kind = importers::kind_of(file.bytes());
    if (kind && file.bytes().substr(0, 3) != "ply")
        throw std::runtime_error(std::string("byte 0: found ") + kind + ", expected what its extension says");
    const auto report = [&](float fraction) { rt::progress(host, kReadShare * std::min(1.0f, std::max(0.0f, fraction))); };
    const Source source{path, file.bytes(), report, *sink};
    const Format format = format_of(path, file.bytes());
    FlatMesh mesh;
    const Reading reading = read(format, source, mesh);
    const size_t vertices = mesh.vertex_count();
    mesh.finish();
    rt::progress(host, kReadShare);

    if (mesh.broken_faces > 0) {
        const std::string text =
            counted(mesh.broken_faces, "face") +
            " left out because of vertices that are missing or not finite, the first: " + first_broken(reading, mesh, vertices);
        if (mesh.sizes.empty()) throw std::runtime_error("contains no usable polygons: " + text);
        warn(source, text);
    }
    if (std::none_of(mesh.sizes.begin(), mesh.sizes.end(), [](rt_u32 n) { return n >= 3; })) {
        if (vertices > 0 && reading.points_and_lines > 0) {
            warn(source, "contains no polygons (points and lines were skipped)");
            return RT_OK;
        }
        if (vertices > 0) throw std::runtime_error("contains no polygons, only " + counted(vertices, "point"));
        throw std::runtime_error("byte 0: found " + quoted(file.bytes().substr(0, 24)) +
                                 " and no vertex behind it, expected a ." + std::string(format.extension) + " file");
    }
    emit(source, mesh, reading.texture.empty() ? RT_NONE : texture_material(source, reading.texture));
    return RT_OK;
}

int32_t probe(const uint8_t* head, uint64_t bytes) {
    const std::string_view text = importers::without_mark({reinterpret_cast<const char*>(head), bytes});
    if (ply::is_ply(text)) return 95;  // the importer of point clouds is surer of its own
    if (text.size() > 3 && text.substr(0, 2) == "OM" && std::string_view("TQP").find(text[2]) != text.npos) return 80;
    if (text.substr(0, 3) == "OFF" || text.substr(0, 4) == "COFF" || text.substr(0, 4) == "NOFF") return 90;
    return 0;
}

constexpr const char* kExtensions[] = {"obj", "ply", "stl", "stla", "stlb", "off", "om", nullptr};
constexpr rt_importer kImporter = {sizeof(rt_importer), kExtensions, probe, rt::guarded<load>, RT_IMPORTER_TAKES_CONTENT, 0};

}  // namespace
}  // namespace openmesh_import

extern "C" RT_EXPORT const rt_plugin rt_plugin_v1 =
    rt::importer_plugin("openmesh", "OBJ, PLY, STL, OFF, OM", "1.0.0", nullptr, openmesh_import::kImporter);
