// my_importer.cpp -- reads .tri files: one triangle per line, as nine numbers. Replace it by your own format.
#include <fstream>
#include <numeric>
#include <sstream>
#include <vector>

#include "rt_plugin.hpp"

namespace {

enum Param { kScale };
constexpr rt_param kParams[] = {rt::float_param("scale", "Scale", "factor of all positions", 0.001, 1000, 1)};

int32_t load(const rt_host* host, const char* path, const double* params, const rt_scene_sink* sink) {
    std::ifstream file(path);
    if (!file) throw rt::fail(host, "cannot be opened");
    std::vector<float> positions;
    std::string line;
    for (size_t number = 1; std::getline(file, line); ++number) {
        if (line.empty() || line[0] == '#') continue;
        std::istringstream words(line);
        for (int i = 0; i < 9; ++i) {
            float value = 0;
            if (!(words >> value))
                throw rt::fail(host, "line " + std::to_string(number) + ": expected nine numbers: '" + line + "'");
            positions.push_back(value * float(params[kScale]));
        }
        if (number % 4096 == 0) rt::progress(host, 0.5f);  // throws if the user has cancelled
    }
    std::vector<rt_u32> indices(positions.size() / 3);
    std::iota(indices.begin(), indices.end(), 0u);

    rt_mesh mesh{};
    mesh.struct_bytes = sizeof mesh;
    mesh.positions = positions.data();
    mesh.vertex_count = static_cast<rt_u32>(indices.size());
    mesh.position_stride = 3 * sizeof(float);
    mesh.indices = indices.data();
    mesh.index_count = indices.size();
    mesh.face_count = indices.size() / 3;  // face_sizes is NULL, so all faces are triangles
    mesh.material = RT_NONE;
    const rt_instance_desc placed = rt::instance(rt::id(sink->mesh(sink->ctx, &mesh)));  // the host copies the mesh
    rt::id(sink->instance(sink->ctx, &placed));  // a mesh is visible only through an instance
    return RT_OK;
}

const char* const kExtensions[] = {"tri", nullptr};
constexpr rt_importer kImporter = {sizeof(rt_importer), kExtensions, nullptr, rt::guarded<load>, 0, 0};

}  // namespace

const rt_plugin rt_plugin_v1 = rt::importer_plugin("my_importer", "Triangles as text", "0.1.0", nullptr, kParams, kImporter);
