// test_importer.cpp -- an importer for `.cltest` files. Each line is a command; they run in order. `command` lists them.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <memory>
#include <new>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "misbehave.hpp"
#include "moving.hpp"
#include "rt_plugin.hpp"

namespace test_importer {
namespace {

template <class T>
T sized() {
    T value{};
    value.struct_bytes = sizeof value;
    return value;
}

struct Run {
    const rt_host& host;
    const rt_scene_sink& sink;
    const double* params;
    std::vector<rt_u32> materials;

    int32_t fail(const std::string& why) const { return host.fail(host.ctx, why.c_str()); }
    static int32_t status(rt_u32 id) { return id == RT_NONE ? RT_FAILED : RT_OK; }

    int32_t place(rt_u32 mesh, const float* m, rt_u32 material = RT_NONE) const {
        auto instance = sized<rt_instance_desc>();
        instance.name = "placed";
        instance.mesh = mesh;
        instance.material = material;
        std::copy(m, m + 12, instance.world_from_object);
        return status(sink.instance(sink.ctx, &instance));
    }

    // A row of `count` separate triangles of area 1/2. The first `bad` ones have the given fault.
    int32_t triangles(const std::string& fault, rt_u32 count, rt_u32 bad) const {
        std::vector<float> positions;
        std::vector<rt_u32> indices;
        for (rt_u32 i = 0; i < count; ++i) {
            const float x = 2 * static_cast<float>(i);
            for (const float p : {x, 0.f, 0.f, x + 1, 0.f, 0.f, x, 1.f, 0.f}) positions.push_back(p);
            for (rt_u32 k = 0; k < 3; ++k) indices.push_back(3 * i + k);
            if (i >= bad) continue;
            if (fault == "index") indices.back() = 3 * count + 5;
            if (fault == "nan") positions.back() = std::numeric_limits<float>::quiet_NaN();
            if (fault == "infinite") positions.back() = -std::numeric_limits<float>::infinity();
            if (fault == "huge") positions.back() = 1e30f;
        }
        auto mesh = sized<rt_mesh>();
        mesh.name = "row";
        mesh.positions = positions.data();
        mesh.vertex_count = static_cast<rt_u32>(positions.size() / 3);
        mesh.position_stride = 12;
        mesh.indices = indices.data();
        mesh.index_count = indices.size();
        mesh.face_count = count;
        mesh.material = materials.empty() ? RT_NONE : materials.back();
        const rt_u32 id = sink.mesh(sink.ctx, &mesh);
        const float identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
        return id == RT_NONE ? RT_FAILED : place(id, identity);
    }

    // Descriptions which no correct importer would deliver.
    int32_t broken(const std::string& what) const {
        static const float corner[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
        static const rt_u32 index[3] = {0, 1, 2}, size[1] = {3}, material[1] = {77};
        auto mesh = sized<rt_mesh>();
        mesh.positions = corner;
        mesh.vertex_count = 3;
        mesh.position_stride = 12;
        mesh.indices = index;
        mesh.index_count = 3;
        mesh.face_count = 1;
        mesh.material = RT_NONE;
        if (what == "struct") mesh.struct_bytes = 8;
        if (what == "stride") mesh.position_stride = 4;
        if (what == "positions") mesh.positions = nullptr;
        if (what == "count") mesh.index_count = ~uint64_t{0};
        if (what == "faces") mesh.face_count = 2;
        if (what == "material") mesh.material = 77;
        if (what == "face_material") mesh.face_materials = material;
        if (what == "sizes") {
            mesh.face_sizes = size;
            mesh.index_count = 2;
        }
        const float identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
        const rt_u32 id = sink.mesh(sink.ctx, &mesh);
        if (id == RT_NONE) return RT_FAILED;
        if (what == "instance_mesh") return place(9, identity);
        if (what == "instance_material") return place(id, identity, 3);
        return fail("the sink took it");
    }

    // A mesh of one face, with corners as x y pairs. It tests triangulation, or with `strided` the copying with normals,
    // uvs and colours, of which blue and alpha may be out of range.
    int32_t face(std::istream& words) const {
        std::vector<float> data;
        std::vector<rt_u32> indices;
        for (float x = 0, y = 0; words >> x >> y;) {
            for (const float value : {x, y, 0.f, 0.f, 0.f, 1.f, x, y, x, 0.5f, 200.f * y, -1.f}) data.push_back(value);
            indices.push_back(static_cast<rt_u32>(indices.size()));
        }
        const rt_u32 size = static_cast<rt_u32>(indices.size());
        auto mesh = sized<rt_mesh>();
        mesh.positions = data.data();
        mesh.normals = data.data() + 3;
        mesh.uvs = data.data() + 6;
        mesh.colors = data.data() + 8;
        mesh.vertex_count = size;
        mesh.position_stride = mesh.normal_stride = mesh.uv_stride = mesh.color_stride = 48;
        mesh.indices = indices.data();
        mesh.index_count = size;
        mesh.face_sizes = &size;
        mesh.face_count = 1;
        mesh.material = RT_NONE;
        const float identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
        const rt_u32 id = sink.mesh(sink.ctx, &mesh);
        return id == RT_NONE ? RT_FAILED : place(id, identity);
    }

    int32_t analytic(const std::string& what, std::istream& words) const {
        float v[16] = {};
        int count = 0;
        for (std::string word; count < 16 && words >> word;) v[count++] = std::strtof(word.c_str(), nullptr);
        const rt_u32 material = materials.empty() ? RT_NONE : materials.back();
        if (what == "sphere") return status(sink.sphere(sink.ctx, v, v[3], material));
        if (what == "plane") return status(sink.plane(sink.ctx, v, v[3], material));
        if (what == "polygon") return status(sink.polygon(sink.ctx, v, static_cast<rt_u32>(count / 3), material));
        if (what == "light") {
            auto light = sized<rt_light_desc>();
            light.name = "lamp";
            light.kind = v[3] != 0 ? RT_LIGHT_DIRECTIONAL : RT_LIGHT_POINT;
            for (int i = 0; i < 3; ++i) {
                light.position[i] = v[i];
                light.direction[i] = -v[i];
                light.color[i] = 1;
            }
            return status(sink.light(sink.ctx, &light));
        }
        auto camera = sized<rt_camera>();
        camera.name = "view";
        for (int i = 0; i < 3; ++i) {
            camera.eye[i] = v[i];
            camera.target[i] = v[3 + i];
            camera.up[i] = v[6 + i];
        }
        camera.fov_y_rad = v[9];
        return status(sink.camera(sink.ctx, &camera));
    }

    int32_t material(std::istream& words) {
        auto desc = sized<rt_material_desc>();
        desc.name = "paint";
        desc.texture = RT_NONE;
        std::string color, texture;
        words >> color;
        for (float& channel : desc.color) channel = std::strtof(color.c_str(), nullptr);
        if (words >> texture) {
            auto picture = sized<rt_texture_desc>();
            picture.path = texture.c_str();
            desc.texture = sink.texture(sink.ctx, &picture);
        }
        materials.push_back(sink.material(sink.ctx, &desc));
        return status(materials.back());
    }

    int32_t load(std::istream& words) const {
        std::string path;
        float scale = 1, x = 0;
        words >> path >> scale >> x;
        auto desc = sized<rt_load>();
        desc.path = path.c_str();
        desc.name = "part";
        desc.material = materials.empty() ? RT_NONE : materials.back();
        const float m[12] = {scale, 0, 0, x, 0, scale, 0, 0, 0, 0, scale, 0};
        std::copy(m, m + 12, desc.world_from_object);
        return sink.load(sink.ctx, &desc);
    }

    // Works in `steps` pieces of 100 ms and reports its progress; if stuck, it always reports the same.
    int32_t work(int steps, bool stuck) const {
        for (int i = 0; i < steps; ++i) {
            const float fraction = stuck ? 0.5f : static_cast<float>(i) / static_cast<float>(steps);
            if (host.progress(host.ctx, fraction) == 0) return RT_CANCELLED;
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
        }
        return RT_OK;
    }

    int32_t command(const std::string& line) {
        std::istringstream words(line);
        std::string what, argument;
        words >> what;
        rt_u32 count = 0, bad = 0;
        if (what == "#") return RT_OK;
        if (what == "triangles") {
            words >> argument >> count >> bad;
            return triangles(argument, count, bad);
        }
        if (what == "face") return face(words);
        if (what == "material") return material(words);
        if (what == "load") return load(words);
        for (const char* known : {"sphere", "plane", "polygon", "light", "camera"}) {
            if (what == known) return analytic(what, words);
        }
        if (what == "instance") {  // of the last mesh, with twelve numbers
            float m[12];
            for (float& value : m) {
                words >> argument;
                value = std::strtof(argument.c_str(), nullptr);
            }
            return place(0, m);
        }
        std::getline(words >> std::ws, argument);
        if (what == "up_axis") {
            auto info = sized<rt_scene_info>();
            info.up_axis = static_cast<rt_u32>(std::atoi(argument.c_str()));
            return sink.info(sink.ctx, &info), RT_OK;
        }
        if (what == "moving") return moving(host, sink, argument);
        if (what == "broken") return broken(argument);
        if (what == "fail") return fail(argument);
        if (what == "fail_silently") return RT_FAILED;
        if (what == "say_cancelled") return RT_CANCELLED;
        if (what == "warn") return sink.warn(sink.ctx, argument.c_str()), RT_OK;
        if (what == "work") return work(std::atoi(argument.c_str()), false);
        if (what == "stuck") return work(std::atoi(argument.c_str()), true);
        if (what == "say") {  // as a parser's last words: without a newline, and not flushed
            std::fputs(argument.c_str(), stdout);
            return RT_OK;
        }
        if (what == "number") {  // the parameter's value
            if (params[0] == std::stod(argument)) return RT_OK;
            return fail("the number is " + std::to_string(int(params[0])));
        }
        if (what == "print") {
            for (int i = 0; i < 5000; ++i) std::puts(argument.c_str());
            std::fflush(stdout);
            return RT_OK;
        }
        if (what == "reserve") {  // MiB of address space, which are not touched
            const std::vector<char>::size_type bytes = std::strtoull(argument.c_str(), nullptr, 10) << 20;
            return std::unique_ptr<char[]>(new (std::nothrow) char[bytes]) ? int32_t(RT_OK) : fail("no room for " + argument);
        }
        if (what == "threads") {
            std::vector<std::thread> threads;
            for (int i = 0; i < 8; ++i) threads.emplace_back([] { std::vector<double>(100000, 1.0); });
            for (std::thread& thread : threads) thread.join();
            return RT_OK;
        }
        if (misbehave(what, argument)) return RT_OK;
        std::string outcome;
        if (try_forbidden(what, argument, outcome)) return fail("tried to " + what + ": " + outcome);
        return fail("unknown command: " + line);
    }
};

int32_t load(const rt_host* host, const char* path, const double* params, const rt_scene_sink* sink) {
    Run run{*host, *sink, params, {}};
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        const int32_t status = run.command(line);
        if (status != RT_OK) return status;
    }
    return RT_OK;
}

const char* const kExtensions[] = {"cltest", nullptr};
constexpr rt_param kParams[] = {rt::int_param("number", "Number", "what the command `number` expects", 1, 9, 3)};
const rt_importer kImporter = {sizeof(rt_importer), kExtensions, nullptr, load, 0, 0};

}  // namespace
}  // namespace test_importer

extern "C" RT_EXPORT const rt_plugin rt_plugin_v1 =
    rt::importer_plugin("cltest", "Test importer", "1.0", nullptr, test_importer::kParams, test_importer::kImporter);
