#include "harness.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <mutex>
#include <random>
#include <thread>

namespace accel_test {

const rt_plugin& load(const std::string& id, const std::string& file) {
    const std::string path = file.empty() ? std::string(CLARITY_BUILD_DIR) + "/lib/clarity/plugins/accel/" + id + ".so" : file;
    void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!library) throw std::runtime_error(dlerror());
    const auto* plugin = static_cast<const rt_plugin*>(dlsym(library, "rt_plugin_v1"));
    if (!plugin) throw std::runtime_error(path + " exports no rt_plugin_v1");
    return *plugin;
}

void Input::add_group(const std::vector<rt_prim>& more) {
    groups.push_back({static_cast<rt_u32>(prims.size()), static_cast<rt_u32>(more.size())});
    prims.insert(prims.end(), more.begin(), more.end());
}

rt_built Built::view() const {
    return {sizeof(rt_built), static_cast<rt_u32>(roots.size()), slots.data(), slot_counts.data(), roots.data()};
}

Input one_group(const std::vector<rt_prim>& prims) {
    Input input;
    input.add_group(prims);
    return input;
}

namespace {

struct HostContext {
    unsigned threads;
    const std::function<bool(float)>* progress;
    std::mutex mutex;
    std::string why;
};

int32_t fail(void* ctx, const char* why) {
    auto* host = static_cast<HostContext*>(ctx);
    const std::lock_guard lock(host->mutex);
    if (host->why.empty()) host->why = why;
    return RT_FAILED;
}

int32_t progress(void* ctx, float fraction) {
    auto* host = static_cast<HostContext*>(ctx);
    const std::lock_guard lock(host->mutex);
    return !*host->progress || (*host->progress)(fraction);
}

void parallel_for(void* ctx, rt_u32 count, void (*body)(void*, rt_u32), void* user) {
    auto* host = static_cast<HostContext*>(ctx);
    std::atomic<rt_u32> next{0};
    const auto work = [&] {
        for (rt_u32 i = next++; i < count; i = next++) body(user, i);
    };
    std::vector<std::thread> threads;
    for (unsigned t = 1; t < std::min<unsigned>(host->threads, count); ++t) threads.emplace_back(work);
    work();
    for (std::thread& thread : threads) thread.join();
}

struct OutputContext {
    const rt_plugin* plugin;
    Built* built;
    std::mutex mutex;
};

void* alloc(void* ctx, rt_u32 slot, uint64_t count) {
    auto* out = static_cast<OutputContext*>(ctx);
    Built& built = *out->built;
    if (slot >= built.storage.size() || !built.storage[slot].empty()) {
        built.allocated_twice = true;
        return nullptr;
    }
    built.storage[slot].assign(count * out->plugin->accel->slots[slot].elem_bytes + 64, 0);
    char* aligned = built.storage[slot].data();
    aligned += (64 - reinterpret_cast<uintptr_t>(aligned) % 64) % 64;
    built.slots[slot] = aligned;
    built.slot_counts[slot] = count;
    return aligned;
}

rt_u32* leaves(void* ctx, uint64_t count) {
    auto* out = static_cast<OutputContext*>(ctx);
    out->built->leaves.reserve(count + 1);  // so that the array exists even for no leaves
    out->built->leaves.assign(count, RT_NONE);
    return out->built->leaves.data();
}

}  // namespace

Built build(const rt_plugin& plugin, const Input& input, const Options& options) {
    const rt_accel& accel = *plugin.accel;
    std::vector<double> params;
    for (rt_u32 i = 0; i < plugin.param_count; ++i) params.push_back(plugin.params[i].def);
    for (const auto& [key, value] : options.params) {
        const auto* end = plugin.params + plugin.param_count;
        const auto* found = std::find_if(plugin.params, end, [&](const rt_param& p) { return key == p.key; });
        if (found == end) throw std::runtime_error("no parameter " + key);
        params[static_cast<size_t>(found - plugin.params)] = value;
    }

    Built built;
    built.storage.resize(accel.slot_count);
    built.slots.resize(accel.slot_count);
    built.slot_counts.resize(accel.slot_count);
    built.roots.assign(input.groups.size(), RT_NONE);
    HostContext host_context{options.threads, &options.progress, {}, {}};
    const rt_host host{sizeof(rt_host), &host_context, fail,    [](void*, int32_t, const char*) {},
                       progress,        parallel_for,  nullptr, 0};
    const rt_geometry geometry{sizeof(rt_geometry), input.triangles.data(), input.triangles.size()};
    rt_device device{};
    device.struct_bytes = sizeof device;
    rt_build_input in{};
    in.struct_bytes = sizeof in;
    in.group_count = static_cast<rt_u32>(input.groups.size());
    in.prims = input.prims.data();
    in.groups = input.groups.data();
    in.geometry = &geometry;
    in.params = params.data();
    in.device = &device;
    OutputContext out_context{&plugin, &built, {}};
    rt_build_output out{};
    out.struct_bytes = sizeof out;
    out.ctx = &out_context;
    out.alloc = alloc;
    out.leaves = leaves;
    out.root = [](void* ctx, rt_u32 group, rt_u32 node) { static_cast<OutputContext*>(ctx)->built->roots.at(group) = node; };
    out.define = [](void* ctx, const char* name, rt_u32 value) {
        static_cast<OutputContext*>(ctx)->built->defines[name] = value;
    };
    out.stat = [](void* ctx, const char* label, double value) {
        static_cast<OutputContext*>(ctx)->built->stats[label] = value;
    };
    built.status = accel.build(&host, &in, &out);
    built.why = host_context.why;
    return built;
}

void number(Input& input) {
    for (size_t i = 0; i < input.prims.size(); ++i) input.prims[i].ref = static_cast<rt_u32>(i);
}

bool same_tree(const rt_plugin& plugin, const Built& a, const Built& b) {
    if (a.leaves != b.leaves || a.roots != b.roots || a.slot_counts != b.slot_counts || a.defines != b.defines ||
        a.stats != b.stats)
        return false;
    for (size_t slot = 0; slot < a.slots.size(); ++slot)
        if (std::memcmp(a.slots[slot], b.slots[slot], a.slot_counts[slot] * plugin.accel->slots[slot].elem_bytes) != 0)
            return false;
    return true;
}

std::vector<Volume> volumes(const rt_plugin& plugin, const Built& built, rt_u32 group, rt_u32 level) {
    std::vector<Volume> result;
    std::function<bool(float)> no_progress;
    HostContext host_context{1, &no_progress, {}, {}};
    const rt_host host{sizeof(rt_host), &host_context, fail,    [](void*, int32_t, const char*) {},
                       progress,        parallel_for,  nullptr, 0};
    rt_volume_sink sink{};
    sink.struct_bytes = sizeof sink;
    sink.ctx = &result;
    sink.box = [](void* ctx, const float lo[3], const float hi[3]) {
        Volume v{};
        std::copy_n(lo, 3, v.lo);
        std::copy_n(hi, 3, v.hi);
        v.radius = -1;
        static_cast<std::vector<Volume>*>(ctx)->push_back(v);
    };
    sink.sphere = [](void* ctx, const float center[3], float radius) {
        Volume v{};
        std::copy_n(center, 3, v.center);
        v.radius = radius;
        static_cast<std::vector<Volume>*>(ctx)->push_back(v);
    };
    sink.oriented_box = [](void* ctx, const float center[3], const float halves[9]) {
        Volume v{};
        std::copy_n(center, 3, v.center);
        std::copy_n(halves, 9, v.halves);
        v.radius = -1;
        static_cast<std::vector<Volume>*>(ctx)->push_back(v);
    };
    const rt_built view = built.view();
    if (plugin.accel->levels(&host, &view, group, level, &sink) != RT_OK) throw std::runtime_error(host_context.why);
    return result;
}

rt_prim box_prim(const float lo[3], const float hi[3], rt_u32 ref, rt_u32 mesh) {
    rt_prim prim{};
    std::copy_n(lo, 3, prim.lo);
    std::copy_n(hi, 3, prim.hi);
    prim.ref = ref;
    prim.mesh = mesh;
    return prim;
}

rt_prim cube(float x, float y, float z, float size, rt_u32 ref) {
    const float lo[3] = {x, y, z}, hi[3] = {x + size, y + size, z + size};
    return box_prim(lo, hi, ref);
}

std::vector<rt_prim> bumpy_sphere(uint32_t count, std::vector<float>* corners) {
    const auto rings = static_cast<uint32_t>(std::sqrt(count / 4.0)) + 1, segments = 2 * rings;
    const auto point = [&](uint32_t ring, uint32_t segment, float* p) {
        const double theta = M_PI * ring / rings, phi = 2 * M_PI * (segment % segments) / segments;
        const double r = 1 + 0.1 * std::sin(9 * theta) * std::sin(7 * phi) + 0.01 * std::sin(90 * theta) * std::cos(70 * phi);
        p[0] = static_cast<float>(r * std::sin(theta) * std::cos(phi));
        p[1] = static_cast<float>(r * std::cos(theta));
        p[2] = static_cast<float>(r * std::sin(theta) * std::sin(phi));
    };
    std::vector<rt_prim> prims;
    for (uint32_t ring = 0; ring < rings; ++ring)
        for (uint32_t segment = 0; segment < segments; ++segment)
            for (int half = 0; half < 2; ++half) {
                float p[9];
                point(ring, segment, p);
                point(ring + 1, segment + (half ? 1 : 0), p + 3);
                point(ring + (half ? 0 : 1), segment + 1, p + 6);
                float lo[3], hi[3];
                for (int a = 0; a < 3; ++a) {
                    lo[a] = std::min({p[a], p[3 + a], p[6 + a]});
                    hi[a] = std::max({p[a], p[3 + a], p[6 + a]});
                }
                prims.push_back(box_prim(lo, hi, RT_REF_TRIANGLE | static_cast<rt_u32>(prims.size())));
                if (corners) corners->insert(corners->end(), p, p + 9);
            }
    return prims;
}

std::vector<rt_prim> scattered(uint32_t count, float size, float center, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<rt_prim> prims;
    for (uint32_t i = 0; i < count; ++i) {
        float lo[3], hi[3];
        for (int a = 0; a < 3; ++a) {
            // Not std::uniform_real_distribution: its sequence differs between standard libraries.
            lo[a] = center + size * (static_cast<float>(random()) / 4294967296.0f - 0.5f);
            hi[a] = lo[a] + 0.01f * size * (static_cast<float>(random()) / 4294967296.0f);
        }
        prims.push_back(box_prim(lo, hi, RT_REF_TRIANGLE | i));
    }
    return prims;
}

}  // namespace accel_test
