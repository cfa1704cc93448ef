// embree_baseline.cpp -- Embree in the fastest configuration of its manual: one triangle mesh, no robust flag, the coherent
// flag for packets of all but diffuse rays, denormals flushed to zero, rays and hits in flat arrays.
#include "tools/bench/baselines/embree_baseline.hpp"

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/parallel_for.hpp"

namespace clarity::bench {
namespace {

constexpr size_t kBlock = 16;        // rays per block of the flat arrays
constexpr size_t kTaskBlocks = 256;  // blocks which a thread takes at a time
static_assert(sizeof(rt_ray) == 32, "eight floats a ray");

// 16 rays in structure-of-arrays form, as packets read them.
struct RayBlock {
    alignas(64) float field[8][kBlock];  // origin, t_min, direction, t_max; t_max < 0: inactive
};

BaselineArray<RayBlock> pack(const RaySet& set) {
    BaselineArray<RayBlock> blocks((set.rays.size() + kBlock - 1) / kBlock);
    for (size_t i = 0; i < blocks.size() * kBlock; ++i) {
        rt_ray ray = set.rays[std::min(i, set.rays.size() - 1)];
        if (i >= set.rays.size()) ray.t_max = -1;
        float fields[8];
        std::memcpy(fields, &ray, sizeof fields);
        for (int k = 0; k < 8; ++k) blocks[i / kBlock].field[k][i % kBlock] = fields[k];
    }
    return blocks;
}

// Prefetches the rays of the next block if it has active ones, as rt_fetch_ahead() does for our rays.
void fetch_ahead(const BaselineArray<RayBlock>& blocks, size_t block) {
#if defined(__SSE2__)
    const size_t last = blocks.size() - 1;
    const auto& next = blocks[std::min(block + 1, last)].field;
    if (std::any_of(next[7], next[7] + kBlock, [](float t_max) { return t_max >= 0; }))
        for (const auto& field : next) _mm_prefetch(reinterpret_cast<const char*>(field), _MM_HINT_T0);
    _mm_prefetch(reinterpret_cast<const char*>(blocks[std::min(block + 2, last)].field[7]), _MM_HINT_T0);
#endif
}

template <int kWidth>
struct Packet;
template <>
struct Packet<8> {
    using Ray = RTCRay8;
    using RayHit = RTCRayHit8;
};
template <>
struct Packet<16> {
    using Ray = RTCRay16;
    using RayHit = RTCRayHit16;
};

template <class Rays>
void load(Rays& to, const RayBlock& from, size_t first, size_t width) {
    const size_t bytes = width * sizeof(float);
    std::memcpy(to.org_x, from.field[0] + first, bytes);
    std::memcpy(to.org_y, from.field[1] + first, bytes);
    std::memcpy(to.org_z, from.field[2] + first, bytes);
    std::memcpy(to.tnear, from.field[3] + first, bytes);
    std::memcpy(to.dir_x, from.field[4] + first, bytes);
    std::memcpy(to.dir_y, from.field[5] + first, bytes);
    std::memcpy(to.dir_z, from.field[6] + first, bytes);
    std::memcpy(to.tfar, from.field[7] + first, bytes);
    std::memset(to.time, 0, bytes);
    std::memset(to.mask, 0xff, bytes);
    std::memset(to.flags, 0, bytes);
}

template <int kWidth>
void trace_block(RTCScene scene, EmbreeQuery& query, bool any_hit, const RayBlock& block, BaselineHit* hits) {
    using P = Packet<kWidth>;
    for (size_t first = 0; first < kBlock; first += kWidth) {
        alignas(64) int valid[kWidth];
        int some = 0;
        for (int i = 0; i < kWidth; ++i) some |= valid[i] = block.field[7][first + i] >= 0 ? -1 : 0;
        if (!some) continue;
        if (any_hit) {
            alignas(64) typename P::Ray rays;
            load(rays, block, first, kWidth);
            query.any(valid, scene, &rays);
            for (int i = 0; i < kWidth; ++i) hits[first + i] = {rays.tfar[i] < 0 ? 0.0f : INFINITY, -1};
        } else {
            alignas(64) typename P::RayHit rays;
            load(rays.ray, block, first, kWidth);
            std::memset(rays.hit.geomID, 0xff, sizeof rays.hit.geomID);
            query.closest(valid, scene, &rays);
            for (int i = 0; i < kWidth; ++i) {
                const bool hit = rays.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
                hits[first + i] = {hit ? rays.ray.tfar[i] : INFINITY, hit ? rt_i32(rays.hit.primID[i]) : -1};
            }
        }
    }
}

template <>
void trace_block<1>(RTCScene scene, EmbreeQuery& query, bool any_hit, const RayBlock& block, BaselineHit* hits) {
    for (size_t i = 0; i < kBlock; ++i) {
        const auto& f = block.field;
        if (f[7][i] < 0) continue;
        RTCRayHit one;
        one.ray = {f[0][i], f[1][i], f[2][i], f[3][i], f[4][i], f[5][i], f[6][i], 0, f[7][i], ~0u, 0, 0};
        one.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        if (any_hit) {
            query.any(scene, &one.ray);
            hits[i] = {one.ray.tfar < 0 ? 0.0f : INFINITY, -1};
        } else {
            query.closest(scene, &one);
            const bool hit = one.hit.geomID != RTC_INVALID_GEOMETRY_ID;
            hits[i] = {hit ? one.ray.tfar : INFINITY, hit ? rt_i32(one.hit.primID) : -1};
        }
    }
}

class EmbreeScene : public BaselineScene {
 public:
    EmbreeScene(const BaselineMesh& mesh, const std::string& quality, unsigned threads) : mesh_(mesh), threads_(threads) {
        device_ = rtcNewDevice(("threads=" + std::to_string(threads)).c_str());
        if (!device_) fail("gives no device", rtcGetDeviceError(nullptr));
        rtcSetDeviceMemoryMonitorFunction(device_, count_bytes, &bytes_);
        scene_ = rtcNewScene(device_);
        const RTCBuildQuality level = quality == "low"      ? RTC_BUILD_QUALITY_LOW
                                      : quality == "medium" ? RTC_BUILD_QUALITY_MEDIUM
                                                            : RTC_BUILD_QUALITY_HIGH;
        rtcSetSceneBuildQuality(scene_, level);
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetGeometryBuildQuality(geometry, level);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.positions.data(), 0, 12,
                                   mesh.vertex_count());
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0, 12,
                                   mesh.triangle_count());
        const auto begin = std::chrono::steady_clock::now();
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
        build_ms_ = ms_since(begin);
        if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE) {
            release();
            fail("cannot build its tree", error);
        }
    }
    ~EmbreeScene() override { release(); }
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    double build_ms() const override { return build_ms_; }
    uint64_t bytes() const override { return static_cast<uint64_t>(std::max<int64_t>(0, bytes_)); }
    const std::vector<std::string>& modes() const override {
        static const std::vector<std::string> names = {"single", "packet8", "packet16"};
        return names;
    }

    void take_rays(const RaySet& set) override {
        packed_ = pack(set);
        blocks_.resize(packed_.size());
        any_hit_ = set.any_hit;
        coherent_ = set.kind != "diffuse";  // faster of the two flags for each kind, measured
    }

    double trace_ms(const std::string& mode, BaselineArray<BaselineHit>& hits) override {
        hits.resize(std::max(hits.size(), blocks_.size() * kBlock));
        const auto trace = mode == "single" ? trace_block<1> : mode == "packet8" ? trace_block<8> : trace_block<16>;
        // Our rays are copied to the device just before tracing. This copy makes the baseline's rays equally warm in the
        // caches.
        std::memcpy(blocks_.data(), packed_.data(), packed_.size() * sizeof(RayBlock));
        std::atomic<size_t> next{0};
        const auto begin = std::chrono::steady_clock::now();
        parallel_for(threads_, [&](uint32_t) {
#if defined(__SSE2__)
            const unsigned saved = _mm_getcsr();
            _mm_setcsr(saved | 0x8040);  // flush denormal results (FTZ) and operands (DAZ) to zero
#endif
            EmbreeQuery query(coherent_);
            for (;;) {
                const size_t first = next.fetch_add(kTaskBlocks);
                if (first >= blocks_.size()) break;
                for (size_t b = first; b < std::min(first + kTaskBlocks, blocks_.size()); ++b) {
                    fetch_ahead(blocks_, b);
                    trace(scene_, query, any_hit_, blocks_[b], &hits[b * kBlock]);
                }
            }
#if defined(__SSE2__)
            _mm_setcsr(saved);
#endif
        });
        return ms_since(begin);
    }

    const std::vector<std::string>& frame_modes() const override {
        static const std::vector<std::string> names = {"packet16", "packet16 mixed"};
        return names;
    }

    double frame_ms(const std::string& mode, const WhittedScene& whitted, BaselineArray<float>& film,
                    BaselineRayCounts& counts) override {
        return embree_frame(scene_, mesh_, whitted, mode == "packet16", threads_, film, counts);
    }

 private:
    [[noreturn]] static void fail(const char* what, RTCError error) {
        throw Error(Exit::failed, std::string("Embree ") + what + ": error " + std::to_string(error) +
                                      (error == RTC_ERROR_OUT_OF_MEMORY ? " (out of memory)" : "") +
                                      "; --no-peers leaves it out");
    }
    static bool count_bytes(void* sum, ssize_t bytes, bool) {
        *static_cast<std::atomic<int64_t>*>(sum) += bytes;
        return true;
    }
    void release() {
        if (scene_) rtcReleaseScene(scene_);
        if (device_) rtcReleaseDevice(device_);
        scene_ = nullptr;
        device_ = nullptr;
    }

    const BaselineMesh& mesh_;
    const unsigned threads_;
    RTCDevice device_ = nullptr;
    RTCScene scene_ = nullptr;
    std::atomic<int64_t> bytes_{0};
    double build_ms_ = 0;
    bool any_hit_ = false, coherent_ = false;
    BaselineArray<RayBlock> packed_, blocks_;
};

}  // namespace

std::string baseline_version() {
    static const std::string text = [] {
        const RTCDevice device = rtcNewDevice("threads=1");
        const auto version = device ? rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION) : RTC_VERSION;  // 40303: 4.3.3
        if (device) rtcReleaseDevice(device);
        return "Embree " + std::to_string(version / 10000) + "." + std::to_string(version / 100 % 100) + "." +
               std::to_string(version % 100);
    }();
    return text;
}

std::unique_ptr<BaselineScene> build_embree(const BaselineMesh& mesh, const std::string& quality, unsigned threads) {
    return std::make_unique<EmbreeScene>(mesh, quality, threads);
}

}  // namespace clarity::bench
