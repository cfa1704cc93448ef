// openmesh.cpp -- the importer plugin for OBJ, PLY, STL, OFF and OM. It uses OpenMesh's readers and keeps every face of the
// file.
#include <OpenMesh/Core/IO/IOManager.hh>
#include <OpenMesh/Core/IO/Options.hh>
#include <OpenMesh/Core/System/omstream.hh>
#include <algorithm>
#include <cctype>
#include <istream>
#include <new>
#include <stdexcept>
#include <string>

#include "../common/file_kind.hpp"
#include "../common/mapped_file.hpp"
#include "readers.hpp"
#include "rt_plugin.hpp"
#include "text.hpp"

namespace openmesh_import {

void warn(const Source& source, const std::string& text) {
    source.sink.warn(source.sink.ctx, text.c_str());
}

bool run_reader(const char* extension, std::streambuf& buffer, bool stop_at_errors, bool is_binary, bool custom_properties,
                FlatImporter& mesh) {
    using OpenMesh::IO::Options;
    Options options = Options::VertexNormal | Options::VertexTexCoord;
    if (is_binary) options += Options::Binary;
    if (custom_properties) options += Options::Custom;
    // OpenMesh would print a line for each bad face. We count such faces and report them once.
    omerr().disable();
    omlog().disable();
    std::istream stream(&buffer);
    if (std::string(extension) == "om") stream.unsetf(std::ios::skipws);
    stream.exceptions(stop_at_errors ? std::ios::badbit | std::ios::failbit : std::ios::badbit);
    return OpenMesh::IO::IOManager().read(stream, extension, mesh, options);
}

std::string too_large(const char* what, unsigned long long count, unsigned long long least_bytes,
                      unsigned long long available) {
    // OpenMesh's indices are signed.
    if (count <= available / least_bytes && count < 0x7FFFFFFFull) return {};
    return "declares " + std::to_string(count) + " elements '" + what + "' of at least " + std::to_string(least_bytes) +
           " bytes and has " + std::to_string(available) + " bytes for them: it is cut off or damaged";
}

namespace {

// The share of reading in the progress. The rest is the host's copy.
constexpr float kReadShare = 0.9f;

std::string lower_extension(const std::string& path) {
    const size_t dot = path.find_last_of("./");
    std::string extension = dot == path.npos || path[dot] == '/' ? "" : path.substr(dot + 1);
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return extension;
}

// PLY, OFF and OM files without a known extension are recognised by their first bytes.
std::string format_of(const std::string& path, std::string_view bytes) {
    const std::string extension = lower_extension(path);
    if (extension == "stla" || extension == "stlb") return "stl";
    if (extension == "obj" || extension == "stl" || extension == "ply" || extension == "off" || extension == "om")
        return extension;
    if (bytes.substr(0, 3) == "ply") return "ply";
    if (bytes.substr(0, 2) == "OM") return "om";
    return bytes.substr(0, 3) == "OFF" ? "off" : extension;
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

void emit(const Source& source, const FlatImporter& mesh, rt_u32 material) {
    const size_t slash = source.path.find_last_of('/');
    const std::string file = slash == source.path.npos ? source.path : source.path.substr(slash + 1);
    const std::string name = file.substr(0, file.find_last_of('.'));
    rt_mesh out{};
    out.struct_bytes = sizeof out;
    out.name = name.c_str();
    out.positions = mesh.positions.data();
    out.vertex_count = static_cast<rt_u32>(mesh.positions.size() / 3);
    out.position_stride = out.normal_stride = 3 * sizeof(float);
    out.uv_stride = 2 * sizeof(float);
    if (!mesh.normals.empty()) out.normals = mesh.normals.data();
    if (!mesh.uvs.empty()) out.uvs = mesh.uvs.data();
    out.indices = mesh.indices.data();
    out.index_count = mesh.indices.size();
    out.face_count = mesh.face_count();
    if (std::any_of(mesh.face_sizes.begin(), mesh.face_sizes.end(), [](rt_u32 n) { return n != 3; })) {
        out.face_sizes = mesh.face_sizes.data();
    }
    if (!mesh.face_materials.empty()) out.face_materials = mesh.face_materials.data();
    out.material = material;
    rt_instance_desc instance{};
    instance.struct_bytes = sizeof instance;
    instance.name = name.c_str();
    instance.mesh = rt::id(source.sink.mesh(source.sink.ctx, &out));
    instance.material = RT_NONE;
    for (const int diagonal : {0, 5, 10}) instance.world_from_object[diagonal] = 1;
    rt::id(source.sink.instance(source.sink.ctx, &instance));
}

// Reads the bytes of a file in one of the formats into `mesh`. Returns the name of its texture, or an empty string.
std::string read(const std::string& format, const Source& source, FlatImporter& mesh) {
    std::string texture;
    try {
        if (format == "obj") read_obj(source, mesh);
        if (format == "ply") texture = read_ply(source, mesh);
        if (format == "stl") read_stl(source, mesh);
        if (format == "off") read_off(source, mesh);
        if (format == "om") read_om(source, mesh);
    } catch (const std::bad_alloc&) {
        throw std::runtime_error(
            "needs more memory than an import may take: a count in it is damaged, or the file is too large");
    } catch (const std::length_error&) {
        throw std::runtime_error("found a number that counts more than memory can hold: it is damaged");
    } catch (const std::ios_base::failure&) {
        throw std::runtime_error("cannot be read to its end: it is cut off or damaged");
    }
    return texture;
}

int32_t load(const rt_host* host, const char* path, const double*, const rt_scene_sink* sink) {
    const importers::MappedFile file(path);
    if (file.bytes().empty()) throw std::runtime_error("the file is empty");
    const char* kind = importers::kind_of(file.bytes());
    if (kind && file.bytes().substr(0, 3) != "ply")
        throw std::runtime_error(std::string("byte 0: found ") + kind + ", expected what its extension says");
    const auto report = [&](float fraction) { rt::progress(host, kReadShare * std::min(1.0f, std::max(0.0f, fraction))); };
    const Source source{path, file.bytes(), report, *sink};
    const std::string format = format_of(path, file.bytes());
    FlatImporter mesh(format == "obj");
    const std::string texture = read(format, source, mesh);
    mesh.finish_faces();
    rt::progress(host, kReadShare);

    if (mesh.broken_faces > 0) {
        const std::string text =
            counted(mesh.broken_faces, "face") +
            " left out because of vertices that are missing or not finite, the first: " + mesh.first_broken;
        if (mesh.face_count() == 0) throw std::runtime_error("contains no usable polygons: " + text);
        warn(source, text);
    }
    const bool any_polygon = std::any_of(mesh.face_sizes.begin(), mesh.face_sizes.end(), [](rt_u32 n) { return n >= 3; });
    if (any_polygon) {
        emit(source, mesh, texture.empty() ? RT_NONE : texture_material(source, texture));
    } else if (mesh.n_vertices() > 0) {
        warn(source, "contains no polygons (points and lines were skipped)");
    } else {
        throw std::runtime_error("byte 0: found " + quoted(file.bytes().substr(0, 24)) +
                                 " and no vertex behind it, expected a ." + format + " file");
    }
    return RT_OK;
}

int32_t probe(const uint8_t* head, uint64_t bytes) {
    const std::string_view text(reinterpret_cast<const char*>(head), bytes);
    if (text.substr(0, 4) == "ply\n" || text.substr(0, 4) == "ply\r") return 100;
    if (text.size() > 3 && text.substr(0, 2) == "OM" && std::string_view("TQP").find(text[2]) != text.npos) return 80;
    if (text.substr(0, 3) == "OFF" || text.substr(0, 4) == "COFF" || text.substr(0, 4) == "NOFF") return 90;
    return 0;
}

constexpr const char* kExtensions[] = {"obj", "ply", "stl", "stla", "stlb", "off", "om", nullptr};
constexpr rt_importer kImporter = {sizeof(rt_importer), kExtensions, probe, rt::guarded<load>};

}  // namespace
}  // namespace openmesh_import

extern "C" RT_EXPORT const rt_plugin rt_plugin_v1 =
    rt::importer_plugin("openmesh", "OBJ, PLY, STL, OFF, OM (OpenMesh)", "1.0.0", nullptr, openmesh_import::kImporter);
