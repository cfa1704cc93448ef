#include "tools/bench/output/row.hpp"

#include "plugin/parameters.hpp"
#include "tools/bench/output/machine.hpp"

namespace clarity::bench {

void describe(BenchRecord& row, const Scene& scene) {
    row.triangles = scene.placed_triangle_count();
    row.primitives = row.triangles + scene.spheres.size() + scene.polygons.size() + scene.planes.size() + scene.shapes.size();
}

void describe(BenchRecord& row, const DeviceInfo& device) {
    row.device = device.name;
    row.device_id = device.id();
    row.driver = device.platform + ", " + device.driver;
    row.device_clock_mhz = device.clock_mhz;
    row.threads = device.compute_units;
}

void describe_host(BenchRecord& row, unsigned threads) {
    row.device = host_cpu_name();
    row.device_id = "host";
    row.threads = threads;
}

void describe(BenchRecord& row, const Settings& settings) {
    row.tracer = settings.tracer;
    row.depth = settings.depth;
    row.ray_slots = settings.ray_slots;
    row.width = settings.width;
    row.height = settings.height;
}

void describe(BenchRecord& row, const AccelData& accel) {
    row.build_ms = accel.build_ms;
    row.pack_ms = accel.pack_ms;
    row.accel_bytes = accel.bytes;
    row.bytes_per_triangle = row.triangles > 0 ? double(accel.bytes) / double(row.triangles) : 0;
    row.nodes = static_cast<uint64_t>(accel.stat("nodes"));
    row.sah_cost = accel.stat("sah_cost");
}

void describe(BenchRecord& row, const Prepared& prepared) {
    row.tracer = prepared.settings.tracer;
    row.packet_w = prepared.settings.packet_w;
    row.packet_h = prepared.settings.packet_h;
    row.lanes = prepared.settings.lanes;
    row.compile_ms = prepared.compile_ms;
    describe(row, *prepared.accel);
}

void set_ray_counts(BenchRecord& row, const FrameStats& stats) {
    row.rays_primary = stats.primary;
    row.rays_shadow = stats.shadow;
    row.rays_secondary = stats.secondary;
    row.rays_dropped = stats.dropped;
}

std::string parameters_text(const rt_plugin& plugin, const ParameterValues& values) {
    std::string text;
    for (rt_u32 i = 0; i < plugin.param_count && i < values.size(); ++i)
        text += (text.empty() ? "" : ",") + parameter_text(plugin, values, i);
    return text;
}

}  // namespace clarity::bench
