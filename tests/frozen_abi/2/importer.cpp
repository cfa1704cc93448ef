// importer.cpp -- a plugin of ABI version 2, kept as it was when it was frozen: do not edit it. Reads .frozen2 files, one
// object a line, and uses every function of the sink.
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "rt_plugin.hpp"

namespace {

void read(std::istream& words, float* to, int count) {
    for (int i = 0; i < count; ++i) words >> to[i];
}

int32_t load(const rt_host* host, const char* path, const double* params, const rt_scene_sink* sink) {
    std::ifstream file(path);
    if (!file) throw rt::fail(host, "cannot be opened");
    const float background[3] = {0.25f, 0.5f, 0.75f};
    rt_scene_info info{};
    info.struct_bytes = sizeof info;
    info.up_axis = 2;
    info.unit_scale = 0.01;
    info.background = background;
    sink->info(sink->ctx, &info);
    rt_u32 material = RT_NONE;
    std::string line, word;
    while (std::getline(file, line)) {
        std::istringstream words(line);
        words >> word;
        float v[12] = {};
        if (word == "material") {
            rt_material_desc m = rt::material("paint");
            read(words, m.color, 3);
            m.reflect = static_cast<float>(params[0]);
            m.flags = RT_MATERIAL_CHECKER;
            const uint8_t texel[4] = {255, 128, 0, 255};
            rt_texture_desc texture{};
            texture.struct_bytes = sizeof texture;
            texture.bytes = texel;
            texture.byte_count = sizeof texel;
            texture.width = texture.height = 1;
            m.texture = sink->texture(sink->ctx, &texture);
            material = rt::id(sink->material(sink->ctx, &m));
        } else if (word == "sphere") {
            read(words, v, 4);
            rt::id(sink->sphere(sink->ctx, v, v[3], material));
        } else if (word == "plane") {
            read(words, v, 4);
            rt::id(sink->plane(sink->ctx, v, v[3], material));
        } else if (word == "square") {  // two triangles, placed twice
            read(words, v, 12);
            const rt_u32 corners[] = {0, 1, 2, 3}, size = 4;
            rt_mesh mesh{};
            mesh.struct_bytes = sizeof mesh;
            mesh.name = "square";
            mesh.positions = v;
            mesh.vertex_count = 4;
            mesh.position_stride = 12;
            mesh.indices = corners;
            mesh.index_count = 4;
            mesh.face_sizes = &size;
            mesh.face_count = 1;
            mesh.material = material;
            rt_instance_desc placed{};
            placed.struct_bytes = sizeof placed;
            placed.mesh = rt::id(sink->mesh(sink->ctx, &mesh));
            placed.material = RT_NONE;
            for (int k = 0; k < 3; ++k) placed.world_from_object[5 * k] = 1;
            rt::id(sink->instance(sink->ctx, &placed));
            placed.world_from_object[11] = 3;
            rt::id(sink->instance(sink->ctx, &placed));
        } else if (word == "polygon") {
            read(words, v, 9);
            rt::id(sink->polygon(sink->ctx, v, 3, material));
        } else if (word == "lamp" || word == "sun") {
            rt_light_desc light = rt::light(word == "sun" ? RT_LIGHT_DIRECTIONAL : RT_LIGHT_POINT, word.c_str());
            read(words, word == "sun" ? light.direction : light.position, 3);
            rt::id(sink->light(sink->ctx, &light));
        } else if (word == "camera") {
            rt_camera camera{};
            camera.struct_bytes = sizeof camera;
            read(words, camera.eye, 3);
            camera.up[2] = 1;
            camera.fov_y_rad = 1;
            rt::id(sink->camera(sink->ctx, &camera));
        } else if (word == "load") {
            words >> word;
            rt_load other{};
            other.struct_bytes = sizeof other;
            other.path = word.c_str();
            for (int k = 0; k < 3; ++k) other.world_from_object[5 * k] = 1;
            other.material = RT_NONE;
            if (sink->load(sink->ctx, &other) != RT_OK) return RT_FAILED;
        } else {
            sink->warn(sink->ctx, ("left out: " + word).c_str());
        }
        rt::progress(host, 0.5f);
    }
    return RT_OK;
}

int32_t probe(const uint8_t* head, uint64_t bytes) {
    return bytes > 7 && std::string(head, head + 7) == "frozen2" ? 90 : 0;
}

constexpr rt_param kParams[] = {rt::float_param("reflect", "Mirror", "mirror share of materials", 0, 1, 0.25)};
const char* const kExtensions[] = {"frozen2", nullptr};
constexpr rt_importer kImporter = {sizeof(rt_importer), kExtensions, probe, rt::guarded<load>};

}  // namespace

const rt_plugin rt_plugin_v1 =
    rt::importer_plugin("frozen2_importer", "An importer of ABI 2", "1.0.0", nullptr, kParams, kImporter);
