// pointcloud.cpp -- the importer plugin for points: PLY without faces, XYZ, PTS and ASC. Each point is a sphere.
//
// Spheres have materials, not colours of their own, so each colour is a material (points.hpp). Spheres have no origin of their
// own either: where points are far from 0, they are moved there, and a warning says by how much.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "../common/file_kind.hpp"
#include "../common/mapped_file.hpp"
#include "../openmesh/ply_header.hpp"
#include "../openmesh/text.hpp"
#include "points.hpp"
#include "rt_plugin.hpp"
#include "xyz.hpp"

namespace pointcloud {
namespace {

using namespace openmesh_import;

enum Param { kRadius };
constexpr rt_param kParams[] = {
    rt::float_param("radius", "Radius", "of each point, in scene units; 0: seven tenths of the median distance of neighbours",
                    0, 1e9, 0),
};

// Half of a square's diagonal: spheres of a square lattice then leave no hole.
constexpr double kRadiusPerSpacing = 0.7072;
// Of the progress; the rest is the host's copy.
constexpr float kReadShare = 0.7f;

// The materials of the points; one for all if they have no colours.
std::vector<rt_u32> materials_of(const Source& source, const FlatMesh& mesh) {
    const size_t count = mesh.vertex_count();
    if (mesh.colors.size() != 4 * count) return std::vector<rt_u32>(count, RT_NONE);
    const Palette palette = palette_of(mesh.colors);
    if (palette.different * 3 > palette.colors.size())
        warn(source, "has " + std::to_string(palette.different) + " colours; those that are alike are drawn as one of " +
                         std::to_string(palette.colors.size() / 3));
    std::vector<rt_u32> ids;
    for (size_t i = 0; i < palette.colors.size(); i += 3) {
        rt_material_desc material = rt::material();
        std::copy_n(&palette.colors[i], 3, material.color);
        ids.push_back(rt::id(source.sink.material(source.sink.ctx, &material)));
    }
    std::vector<rt_u32> materials;
    for (const rt_u32 color : palette.of_point) materials.push_back(ids[color]);
    return materials;
}

void emit(const rt_host* host, const Source& source, const FlatMesh& mesh, double radius) {
    if (std::any_of(mesh.origin, mesh.origin + 3, [](double x) { return x != 0; })) {
        char text[160];
        std::snprintf(text, sizeof text,
                      "its points are moved by %.17g %.17g %.17g to the origin, since floats would lose their digits",
                      0 - mesh.origin[0], 0 - mesh.origin[1], 0 - mesh.origin[2]);
        warn(source, text);
    }
    const std::vector<rt_u32> materials = materials_of(source, mesh);
    for (size_t i = 0; i < mesh.corners.size(); ++i) {
        const rt_u32 point = mesh.corners[i];
        rt::id(source.sink.sphere(source.sink.ctx, &mesh.positions[3 * size_t(point)], static_cast<float>(radius),
                                  materials[point]));
        if (i % 65536 == 0)
            rt::progress(host, kReadShare + (1 - kReadShare) * static_cast<float>(i) / static_cast<float>(mesh.corners.size()));
    }
}

int32_t load(const rt_host* host, const char* path, const double* params, const rt_scene_sink* sink) {
    const importers::MappedFile file(host, path);
    if (file.bytes().empty()) throw std::runtime_error("the file is empty");
    const bool of_ply = ply::is_ply(file.bytes());
    const char* kind = importers::kind_of(file.bytes());
    if (kind && !of_ply) throw std::runtime_error(std::string("byte 0: found ") + kind + ", expected points as text");
    const auto report = [&](float fraction) { rt::progress(host, kReadShare * std::clamp(fraction, 0.0f, 1.0f)); };
    const Source source{path, file.bytes(), report, *sink};
    FlatMesh mesh;
    if (of_ply)
        read_ply_points(source, mesh);
    else
        read_xyz(source, mesh);
    // A face of one corner for each point: finish() leaves out those that are not finite.
    for (size_t i = 0, count = mesh.vertex_count(); i < count; ++i) {
        mesh.corners.push_back(static_cast<rt_u32>(i));
        mesh.add_face(1);
    }
    mesh.finish();
    if (mesh.broken_faces > 0)
        warn(source, counted(mesh.broken_faces, "point") + " left out because of coordinates that are not finite");
    if (mesh.corners.empty()) throw std::runtime_error("contains no points");
    const double radius = params[kRadius] > 0 ? params[kRadius] : kRadiusPerSpacing * spacing(mesh.positions);
    emit(host, source, mesh, radius > 0 ? radius : 1);
    return RT_OK;
}

// Sure of a PLY header that names vertices and no faces.
int32_t probe(const uint8_t* head, uint64_t bytes) {
    const std::string_view text(reinterpret_cast<const char*>(head), bytes);
    const std::string_view header = text.substr(0, text.find("end_header"));
    if (!ply::is_ply(text) || header.size() == text.size()) return 0;
    const auto has = [&](const char* element) { return header.find(element) != header.npos; };
    return has("element vertex ") && !has("element face ") && !has("element tristrips ") ? 100 : 0;
}

constexpr const char* kExtensions[] = {"ply", "xyz", "pts", "asc", nullptr};
constexpr rt_importer kImporter = {sizeof(rt_importer), kExtensions, probe, rt::guarded<load>, RT_IMPORTER_TAKES_CONTENT, 0};

}  // namespace
}  // namespace pointcloud

extern "C" RT_EXPORT const rt_plugin rt_plugin_v1 = rt::importer_plugin("pointcloud", "Point clouds (PLY, XYZ, PTS)", "1.0.0",
                                                                        nullptr, pointcloud::kParams, pointcloud::kImporter);
