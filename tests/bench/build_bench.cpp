// build_bench.cpp -- how long builders take, beside Embree's on the same triangles and threads.
//
// Runs are interleaved at random, each on fresh memory, and only the build itself is timed: of a plugin its build(), of Embree
// commits of geometry and scene at medium quality (its binned SAH, which also packs the triangles into its leaves; what packing
// takes us is the counter pack_ms). Medians matter: the rows that end in _median.
//   build_bench --benchmark_repetitions=9   (CLARITY_PLUGIN_PATH as the tests have it, CLARITY_SHARED for the dragon)
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "plugin/registry.hpp"
#include "render/accel_build.hpp"
#ifdef CLARITY_HAVE_EMBREE
#include <embree3/rtcore.h>
#endif

namespace {

using namespace clarity;

Scene scene_of(std::vector<float> positions, std::vector<rt_u32> triangles) {
    Scene scene;
    scene.positions = std::move(positions);
    scene.triangles = std::move(triangles);
    scene.triangle_materials.assign(scene.triangle_count(), 0);
    scene.materials.push_back({"default", default_material()});
    Mesh mesh;
    mesh.vertex_count = scene.vertex_count();
    mesh.triangle_count = scene.triangle_count();
    scene.meshes.push_back(mesh);
    Instance instance;
    scene.instances.push_back(instance);
    return scene;
}

// A sphere with bumps, 2 * rings * 2 * rings triangles.
Scene generated(rt_u32 rings) {
    const rt_u32 segments = 2 * rings;
    std::vector<float> positions;
    std::vector<rt_u32> triangles;
    for (rt_u32 ring = 0; ring <= rings; ++ring)
        for (rt_u32 segment = 0; segment < segments; ++segment) {
            const double theta = M_PI * ring / rings, phi = 2 * M_PI * segment / segments;
            const double r =
                1 + 0.1 * std::sin(9 * theta) * std::sin(7 * phi) + 0.01 * std::sin(90 * theta) * std::cos(70 * phi);
            positions.push_back(static_cast<float>(r * std::sin(theta) * std::cos(phi)));
            positions.push_back(static_cast<float>(r * std::cos(theta)));
            positions.push_back(static_cast<float>(r * std::sin(theta) * std::sin(phi)));
        }
    for (rt_u32 ring = 0; ring < rings; ++ring)
        for (rt_u32 segment = 0; segment < segments; ++segment) {
            const rt_u32 next = (segment + 1) % segments, a = ring * segments + segment, b = ring * segments + next;
            for (const rt_u32 corner : {a, a + segments, b, b, a + segments, b + segments}) triangles.push_back(corner);
        }
    return scene_of(std::move(positions), std::move(triangles));
}

// The dragon of 871 k triangles, where it is: a binary little-endian PLY of float x y z and triangles, compressed.
bool dragon(Scene& scene) {
    const char* shared = std::getenv("CLARITY_SHARED");
    const std::string path =
        std::string(shared ? shared : CLARITY_SOURCE_DIR "/../shared") + "/scenes/models/dragon_871k.ply.gz";
    if (!std::filesystem::exists(path)) return false;
    FILE* file = popen(("gzip -dc '" + path + "'").c_str(), "r");
    if (!file) return false;
    size_t vertices = 0, faces = 0;
    char line[256];
    while (std::fgets(line, sizeof line, file) && std::strcmp(line, "end_header\n") != 0) {
        std::sscanf(line, "element vertex %zu", &vertices);
        std::sscanf(line, "element face %zu", &faces);
    }
    std::vector<float> positions(3 * vertices);
    std::vector<rt_u32> triangles(3 * faces);
    bool whole = std::fread(positions.data(), 12, vertices, file) == vertices;
    for (size_t f = 0; f < faces && whole; ++f)
        whole = std::fgetc(file) == 3 && std::fread(&triangles[3 * f], 12, 1, file) == 1;
    pclose(file);
    if (whole) scene = scene_of(std::move(positions), std::move(triangles));
    return whole;
}

double ms_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void finish(benchmark::State& state, const Scene& scene) {
    state.SetItemsProcessed(static_cast<int64_t>(state.iterations()) * scene.triangle_count());
}

void build_plugin(benchmark::State& state, const Scene& scene, const rt_plugin& plugin) {
    double pack_ms = 0;
    for (auto _ : state) {
        Progress progress;
        const AccelData data = build_accel(scene, plugin, default_parameters(plugin), progress);
        state.SetIterationTime(data.build_ms / 1000);
        pack_ms += data.pack_ms;
        state.counters["sah_cost"] = data.stat("sah_cost");
    }
    state.counters["pack_ms"] = pack_ms / static_cast<double>(state.iterations());
    finish(state, scene);
}

#ifdef CLARITY_HAVE_EMBREE
void build_embree(benchmark::State& state, const Scene& scene, RTCDevice device) {
    for (auto _ : state) {
        RTCScene world = rtcNewScene(device);
        rtcSetSceneBuildQuality(world, RTC_BUILD_QUALITY_MEDIUM);
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        void* positions =
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, scene.vertex_count());
        void* indices =
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, scene.triangle_count());
        std::memcpy(positions, scene.positions.data(), scene.positions.size() * 4);
        std::memcpy(indices, scene.triangles.data(), scene.triangles.size() * 4);
        const auto start = std::chrono::steady_clock::now();
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(world, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(world);
        state.SetIterationTime(ms_since(start) / 1000);
        if (rtcGetDeviceError(device) != RTC_ERROR_NONE) state.SkipWithError("Embree reports an error");
        rtcReleaseScene(world);
    }
    finish(state, scene);
}
#endif

}  // namespace

int main(int argc, char** argv) {
    // Flags given later win.
    std::vector<std::string> flags = {argv[0], "--benchmark_enable_random_interleaving=true", "--benchmark_repetitions=5",
                                      "--benchmark_report_aggregates_only=true", "--benchmark_min_time=0.01"};
    flags.insert(flags.end(), argv + 1, argv + argc);
    std::vector<char*> pointers;
    for (std::string& flag : flags) pointers.push_back(flag.data());
    int count = static_cast<int>(pointers.size());
    benchmark::Initialize(&count, pointers.data());
    if (benchmark::ReportUnrecognizedArguments(count, pointers.data())) return 2;

    static std::vector<std::pair<std::string, Scene>> scenes;
    scenes.emplace_back("generated_1M", generated(500));
    Scene model;
    if (dragon(model))
        scenes.emplace_back("dragon_871k", std::move(model));
    else
        std::fputs("no dragon: set CLARITY_SHARED to where scenes/models/dragon_871k.ply.gz is\n", stderr);

    const PluginRegistry registry = PluginRegistry::discover();
    for (const auto& [name, scene] : scenes) {
        for (const char* id : {"bvh2", "spheres"}) {
            const rt_plugin* plugin = registry.accel(id);
            if (!plugin) {
                std::fprintf(stderr, "accel plugin %s not found: set CLARITY_PLUGIN_PATH\n", id);
                return 1;
            }
            benchmark::RegisterBenchmark((std::string(id) + "/" + name).c_str(),
                                         [&scene = scene, plugin](benchmark::State& s) { build_plugin(s, scene, *plugin); })
                ->UseManualTime()
                ->Unit(benchmark::kMillisecond);
        }
#ifdef CLARITY_HAVE_EMBREE
        static RTCDevice device = rtcNewDevice(nullptr);
        benchmark::RegisterBenchmark(("embree_medium/" + name).c_str(),
                                     [&scene = scene](benchmark::State& s) { build_embree(s, scene, device); })
            ->UseManualTime()
            ->Unit(benchmark::kMillisecond);
#endif
    }
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
