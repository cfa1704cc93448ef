#include "tools/bench/report/sample.hpp"

#include <cmath>

namespace clarity::test {
using namespace bench;
namespace {

Summary around(double median) {
    return {median, .98 * median, 1.03 * median, .95 * median, 1.2 * median, 21};
}

struct Where {
    const char *name, *id, *driver;
    double speed;  // relative to the processor
    unsigned units;
};
constexpr Where kWhere[] = {{"pthread-skylake-avx512-AMD EPYC", "0:0", "3.1", 1, 2},
                            {"NVIDIA H200 NVL", "1:0", "550.127", 60, 132}};
constexpr const char* kScenes[] = {"1_two_triangles", "2_two_spheres", "3_triangle_two_spheres",
                                   "4_35_triangles",  "5_36_spheres",  "6_2406_triangles"};

BenchRecord record_on(const Where& where, const char* suite, const std::string& scene, const char* measure) {
    BenchRecord r;
    r.suite = suite;
    r.scene = scene;
    r.measure = measure;
    r.case_name = scene + "/" + measure;
    r.device = where.name;
    r.device_id = where.id;
    r.driver = where.driver;
    r.threads = where.units;
    r.accel = "bvh2";
    r.tracer = "iterative";
    r.depth = 4;
    r.packet_w = r.packet_h = 4;
    r.lanes = 16;
    r.ray_slots = 8;
    r.width = 1024;
    r.height = 768;
    r.triangles = r.primitives = 2406;
    return r;
}

void set_frame(BenchRecord& r, double ms) {
    r.time_ms = around(ms);
    r.wall_ms = around(ms * 1.02 + .3);
    r.fps = 1000 / r.wall_ms.median;
    r.rays_primary = 786432;
    r.rays_shadow = 400000;
    r.rays_secondary = static_cast<uint64_t>(r.depth - 1) * 500000;
    r.mrays_per_s = double(r.rays()) / r.time_ms.median / 1000;
}

void set_rays(BenchRecord& r, double mrays) {
    r.rays_primary = r.hits = 786432;
    r.time_ms = r.wall_ms = around(786.432 / mrays);
    r.mrays_per_s = mrays;
}

void add_thesis(BenchReport& report) {
    for (const Where& where : kWhere) {
        double cost = 6;
        for (const char* scene : kScenes) {
            for (int steps = 1; steps <= 4; ++steps)
                for (const char* variant : {"now", "then"}) {
                    BenchRecord r = record_on(where, "thesis", scene, "frame");
                    r.variant = variant;
                    r.depth = steps;
                    set_frame(r, cost * steps * (r.variant == "then" ? 12 : 1) / where.speed);
                    report.records.push_back(r);
                }
            for (const char* kind : {"primary", "reflection"})
                for (const char* variant : {"now", "then"}) {
                    BenchRecord r = record_on(where, "thesis", scene, kind);
                    r.variant = variant;
                    const double more = r.variant == "then" ? 5 : 1;
                    r.analysis = {true,
                                  9 * more,
                                  8,
                                  3 * more,
                                  .95 / std::sqrt(more),
                                  where.units > 2 ? .9 / more : 0,
                                  45 * more,
                                  where.units > 2 ? 0 : .93,
                                  64,
                                  18.5,
                                  "boxes"};
                    report.records.push_back(r);
                }
            for (const int slots : {1, 2, 4, 8}) {
                BenchRecord r = record_on(where, "thesis", scene, "dropped");
                r.variant = "slots " + std::to_string(slots);
                r.ray_slots = slots;
                r.rays_secondary = 1000000;
                r.rays_dropped = slots == 8 ? 0 : static_cast<uint64_t>(100000 / (slots * slots));
                report.records.push_back(r);
            }
            cost *= 1.6;
        }
        for (const char* scene : {"spheres21", "aim_100k"}) {
            BenchRecord r = record_on(where, "thesis", scene, "frame");
            r.variant = "now";
            set_frame(r, 60 / where.speed);
            r.kernels_ms = {{"trace", 58 / where.speed}, {"tone map", 1.5 / where.speed}, {"read back", .5}};
            report.records.push_back(r);
        }
    }
}

void add_packets(BenchReport& report) {
    for (const int lanes : {1, 16})
        for (const int side : {1, 2, 4, 8, 16}) {
            BenchRecord r = record_on(kWhere[0], "packets", kScenes[5], "frame");
            r.lanes = lanes;
            r.packet_w = r.packet_h = side;
            r.variant = std::to_string(side) + "x" + std::to_string(side) + ", lanes " + std::to_string(lanes);
            set_frame(r, (lanes == 1 ? 300 : 60) + std::fabs(std::log2(side) - 2) * 10);
            if (side == 1 && lanes == 16) r.status = RowStatus::skipped, r.why = "a packet narrower than the lanes";
            report.records.push_back(r);
        }
}

void add_structures(BenchReport& report, const char* suite, const std::string& scene, uint64_t triangles) {
    const double size = 1 + std::log10(double(triangles)) / 3;
    for (const char* measure : {"build", "primary", "shadow", "reflection", "diffuse"}) {
        for (const char* accel : {"bvh2", "bvh8", "spheres"}) {
            BenchRecord r = record_on(kWhere[0], suite, scene, measure);
            r.variant = r.accel = accel;
            r.triangles = triangles;
            set_rays(r, (accel[0] == 's' ? 12 : accel[3] == '8' ? 80 : 90) / size);
            r.mtris_per_s = 8 / size;
            r.bytes_per_triangle = 64;
            r.nodes = triangles / 2;
            r.sah_cost = 12.5;
            if (accel[3] == '8' && r.measure == "shadow")
                r.status = RowStatus::refused, r.why = "the middle half spreads over 31 %";
            report.records.push_back(r);
        }
        for (const char* baseline : {"embree single medium", "embree packet16 medium"}) {
            BenchRecord r = record_on(kWhere[0], suite, scene, measure);
            r.baseline = baseline;
            r.device = "AMD EPYC";
            r.driver = "Embree 4.3.3";
            r.triangles = triangles;
            r.accel.clear();
            set_rays(r, (baseline[7] == 's' ? 30 : 84) / size);
            r.mtris_per_s = 4 / size;
            report.records.push_back(r);
        }
    }
}

void add_light(BenchReport& report) {
    for (const char* sampler : {"independent", "sobol"}) {
        BenchRecord r = record_on(kWhere[0], "light", "veach", "light");
        r.variant = sampler;
        r.time_ms = r.wall_ms = around(900);
        r.light = {sampler, "mis", "1024 samples of another seed", 1.165, sampler[0] == 'i' ? -.503 : -.717, {}, 116, -1, -1};
        for (unsigned samples = 1; samples <= 64; samples *= 4) {
            const double rmse = .3 * std::pow(samples, r.light.slope);
            r.light.points.push_back({samples, 56. * samples, rmse, rmse * .9, rmse * rmse});
        }
        report.records.push_back(r);
    }
    for (const char* label : {"path, cold", "path, warm"}) {
        BenchRecord r = record_on(kWhere[0], "light", "veach", "start");
        r.variant = label;
        r.time_ms = around(label[6] == 'c' ? 8200 : 140);
        r.wall_ms = around(label[6] == 'c' ? 8700 : 640);
        report.records.push_back(r);
    }
}

}  // namespace

BenchReport sample_report() {
    BenchReport report;
    report.run = {"0.1.0",
                  "2026-11-21T13:00:00Z",
                  "clarity bench thesis packets accel scale --device all --report out",
                  "AMD EPYC 9B45 2-Core",
                  2,
                  "",
                  0,
                  0,
                  .1,
                  2,
                  .1,
                  412};
    add_thesis(report);
    add_packets(report);
    add_structures(report, "accel", "bunny", 69451);
    for (uint64_t triangles = 1488; triangles < 12000000; triangles *= 3)
        add_structures(report, "scale", "spot_x" + std::to_string(triangles / 372), triangles);
    add_light(report);
    report.notes = {"shared models were not found in /nowhere; CLARITY_SHARED should name their folder"};
    return report;
}

}  // namespace clarity::test
