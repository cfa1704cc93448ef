// broken_importer.cpp -- an importer with one defect (own_defect.hpp), for the tests of `clarity check`. A `.tri` file has the
// number of its triangles in the first line, then one triangle a line: nine numbers.
#include <cstdlib>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "own_defect.hpp"
#include "rt_plugin.hpp"

namespace {

bool is(const char* defect) {
    return own_defect("importer_") == defect;
}

// Memory that holds what was there before. The compiler must not know that nothing was written.
float* unwritten(size_t numbers) {
    static float* volatile kept = nullptr;  // the last one is freed, so that nothing leaks
    std::free(kept);
    return kept = static_cast<float*>(std::malloc(numbers * sizeof(float)));
}
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wuninitialized"
float unwritten_of_stack() {
    volatile float buffer[8192];
    return buffer[100];
}
#pragma GCC diagnostic pop

volatile int sink = 0;
char* volatile memory = nullptr;  // volatile: otherwise the compiler sees that nobody reads it
int imports = 0;

int32_t load(const rt_host* host, const char* path, const double*, const rt_scene_sink* sink_of) {
    std::ifstream file(path);
    long long count = 0;
    if (!(file >> count)) {
        if (is("endless"))
            for (;;) sink = sink + 1;
        if (is("crashes")) *reinterpret_cast<volatile int*>(16) = 1;
        throw rt::fail(host, std::string(path) + ":1: expected the number of triangles");
    }
    if (count < 1) throw rt::fail(host, std::string(path) + ":1: expected a number of triangles of at least 1");
    std::vector<float> positions;
    if (is("trusts_count")) {
        memory = static_cast<char*>(std::malloc(static_cast<size_t>(count) * 36));
        for (long long i = 0; i < count * 36; i += 4096) memory[i] = 1;
    }
    for (long long i = 0; i < count; ++i) {
        for (int k = 0; k < 9; ++k) {
            float value = 0;
            if (!(file >> value))
                throw rt::fail(
                    host, std::string(path) + ": ends in triangle " + std::to_string(i + 1) + " of " + std::to_string(count));
            positions.push_back(value);
        }
        if (host->progress(host->ctx, float(i + 1) / float(count)) == 0 && !is("ignores_cancel")) return RT_CANCELLED;
    }
    if (is("drops_last")) positions.resize(positions.size() - 9);
    if (is("keeps_state") && ++imports > 3) positions[0] += 1;
    if (is("leaks")) sink = sink + int(reinterpret_cast<uintptr_t>(std::malloc(500)) & 1);
    const size_t vertices = positions.size() / 3;
    std::vector<rt_u32> indices;
    for (rt_u32 i = 0; i < vertices; ++i) indices.push_back(i);
    // The normal of each triangle; u is x and v is y.
    std::vector<float> uvs, flat(positions.size());
    float* normals = is("border_normals") ? unwritten(positions.size()) : flat.data();
    for (size_t v = 0; v < vertices; ++v) {
        const float *a = &positions[v / 3 * 9], *b = a + 3, *c = a + 6;
        float n[3];
        for (int k = 0; k < 3; ++k) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            n[k] = (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
            if (is("flips_normals")) n[k] = -n[k];
        }
        if (is("turns_normals")) std::swap(n[1], n[2]);
        const bool border = is("border_normals") && v + 3 >= vertices;
        for (int k = 0; k < 3 && !border; ++k) normals[3 * v + size_t(k)] = n[k];
        float u = positions[3 * v], w = positions[3 * v + 1];
        if (is("swaps_uv")) std::swap(u, w);
        if (is("turns_uv_over")) w = 1 - w;
        if (is("uv_of_stack") && v == 2) u = unwritten_of_stack();
        uvs.push_back(u), uvs.push_back(w);
    }
    if (is("flips_winding"))
        for (size_t i = 0; i + 2 < indices.size(); i += 3) std::swap(indices[i + 1], indices[i + 2]);
    if (is("winds_last_back") && count > 1) std::swap(indices[indices.size() - 1], indices[indices.size() - 2]);
    rt_mesh mesh{};
    mesh.struct_bytes = sizeof mesh;
    mesh.material = RT_NONE;
    mesh.positions = positions.data();
    mesh.vertex_count = rt_u32(positions.size() / 3);
    mesh.position_stride = 12;
    mesh.normals = is("forgets_normals") ? nullptr : normals;
    mesh.normal_stride = 12;
    mesh.uvs = uvs.data();
    mesh.uv_stride = 8;
    mesh.indices = indices.data();
    mesh.index_count = indices.size();
    mesh.face_count = indices.size() / 3;
    rt_instance_desc instance{
        sizeof(rt_instance_desc), nullptr, 0, RT_NONE, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, 0, 0, nullptr};
    // One material for each half of the triangles.
    rt_material_desc white = rt::material();
    rt_u32 halves[2];
    for (int k = 0; k < 2; ++k) {
        white.name = k ? "second" : "first";
        halves[k] = rt::id(sink_of->material(sink_of->ctx, &white));
    }
    if (is("material_again")) rt::id(sink_of->material(sink_of->ctx, &white));
    std::vector<rt_u32> materials;
    for (size_t t = 0; t < mesh.face_count; ++t) materials.push_back(halves[t >= mesh.face_count / 2]);
    if (is("last_material")) materials.back() = halves[0];
    mesh.face_materials = materials.data();
    instance.name = is("loses_name") ? nullptr : "triangles";
    instance.mesh = rt::id(sink_of->mesh(sink_of->ctx, &mesh));
    if (is("moves_instance") && count == 4) instance.world_from_object[3] = 0.25f;
    if (is("singular")) instance.world_from_object[10] = 0;
    if (is("first_differs") && imports++ == 0) instance.world_from_object[3] = 1e-3f;
    if (!is("no_instance")) rt::id(sink_of->instance(sink_of->ctx, &instance));
    if (is("mesh_left_over")) rt::id(sink_of->mesh(sink_of->ctx, &mesh));
    return RT_OK;
}

int32_t probe(const uint8_t* head, uint64_t bytes) {
    return is("sure_of_all") ? 100 : bytes > 0 && head[0] >= '1' && head[0] <= '9' ? 30 : 0;
}

constexpr const char* kExtensions[] = {"tri", nullptr};
constexpr rt_importer kImporter = {sizeof(rt_importer), kExtensions, probe, rt::guarded<load>, 0, 0};

}  // namespace

const rt_plugin rt_plugin_v1 = rt::importer_plugin("tri", "Triangles in a text", "1.0.0", nullptr, kImporter);
