// broken_importer.cpp -- an importer with one defect, DEFECT, for the tests of `clarity check`. A `.tri` file has the number of
// its triangles in the first line, then one triangle a line: nine numbers.
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "rt_plugin.hpp"

#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)

namespace {

bool is(const char* defect) {
    return std::strcmp(TEXT(DEFECT), defect) == 0;
}

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
    std::vector<rt_u32> indices;
    for (rt_u32 i = 0; i < positions.size() / 3; ++i) indices.push_back(i);
    rt_mesh mesh{};
    mesh.struct_bytes = sizeof mesh;
    mesh.material = RT_NONE;
    mesh.positions = positions.data();
    mesh.vertex_count = rt_u32(positions.size() / 3);
    mesh.position_stride = 12;
    mesh.indices = indices.data();
    mesh.index_count = indices.size();
    mesh.face_count = indices.size() / 3;
    rt_instance_desc instance{
        sizeof(rt_instance_desc), nullptr, 0, RT_NONE, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, 0, 0, nullptr};
    instance.mesh = rt::id(sink_of->mesh(sink_of->ctx, &mesh));
    rt::id(sink_of->instance(sink_of->ctx, &instance));
    return RT_OK;
}

int32_t probe(const uint8_t* head, uint64_t bytes) {
    return is("sure_of_all") ? 100 : bytes > 0 && head[0] >= '1' && head[0] <= '9' ? 30 : 0;
}

constexpr const char* kExtensions[] = {"tri", nullptr};
constexpr rt_importer kImporter = {sizeof(rt_importer), kExtensions, probe, rt::guarded<load>, 0, 0};

}  // namespace

const rt_plugin rt_plugin_v1 = rt::importer_plugin("tri", "Triangles in a text", "1.0.0", nullptr, kImporter);
