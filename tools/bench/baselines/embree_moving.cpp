// embree_moving.cpp -- Embree's dynamic scenes: geometry of quality REFIT, LOW or MEDIUM, whose vertices are in a shared
// buffer.
#include <atomic>
#include <chrono>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "tools/bench/baselines/baseline.hpp"
#include "tools/bench/baselines/embree.hpp"

namespace clarity::bench {

class EmbreeMoving : public MovingBaseline {
 public:
    EmbreeMoving(const BaselineMesh& mesh, const std::string& quality, unsigned threads)
        : device_(rtcNewDevice(("threads=" + std::to_string(threads)).c_str())), positions_(mesh.positions.size()) {
        std::copy(mesh.positions.begin(), mesh.positions.end(), positions_.begin());
        if (!device_) fail(rtcGetDeviceError(nullptr));
        rtcSetDeviceMemoryMonitorFunction(device_, count_bytes, &bytes_);
        scene_ = rtcNewScene(device_);
        const bool refits = quality == "refit";
        rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_DYNAMIC);
        // Only a scene of low quality has a tree for each geometry, and thus refits it.
        rtcSetSceneBuildQuality(scene_, quality == "medium" ? RTC_BUILD_QUALITY_MEDIUM : RTC_BUILD_QUALITY_LOW);
        geometry_ = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetGeometryBuildQuality(geometry_, refits             ? RTC_BUILD_QUALITY_REFIT
                                              : quality == "low" ? RTC_BUILD_QUALITY_LOW
                                                                 : RTC_BUILD_QUALITY_MEDIUM);
        rtcSetSharedGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, positions_.data(), 0, 12,
                                   mesh.vertex_count());
        rtcSetSharedGeometryBuffer(geometry_, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0, 12,
                                   mesh.triangle_count());
        rtcCommitGeometry(geometry_);
        rtcAttachGeometry(scene_, geometry_);
        rtcCommitScene(scene_);
        if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE) {
            release();
            fail(error);
        }
    }
    ~EmbreeMoving() override { release(); }
    EmbreeMoving(const EmbreeMoving&) = delete;
    EmbreeMoving& operator=(const EmbreeMoving&) = delete;

    float* positions() override { return positions_.data(); }
    double update_ms() override {
        const auto begin = std::chrono::steady_clock::now();
        rtcUpdateGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0);
        rtcCommitGeometry(geometry_);
        rtcCommitScene(scene_);
        return ms_since(begin);
    }
    uint64_t bytes() const override { return static_cast<uint64_t>(std::max<int64_t>(0, bytes_)); }

 private:
    [[noreturn]] static void fail(RTCError error) {
        throw Error(Exit::failed,
                    "Embree cannot build a dynamic scene: error " + std::to_string(error) + "; --no-peers leaves it out");
    }
    static bool count_bytes(void* sum, ssize_t bytes, bool) {
        *static_cast<std::atomic<int64_t>*>(sum) += bytes;
        return true;
    }
    void release() {
        if (geometry_) rtcReleaseGeometry(geometry_);
        if (scene_) rtcReleaseScene(scene_);
        if (device_) rtcReleaseDevice(device_);
        geometry_ = nullptr;
        scene_ = nullptr;
        device_ = nullptr;
    }

    RTCDevice device_ = nullptr;
    RTCScene scene_ = nullptr;
    RTCGeometry geometry_ = nullptr;
    BaselineArray<float> positions_;  // with one float of padding, because Embree reads 16 bytes per vertex
    std::atomic<int64_t> bytes_{0};
};

std::unique_ptr<MovingBaseline> make_moving_baseline(const BaselineMesh& mesh, const std::string& quality, unsigned threads) {
    return std::make_unique<EmbreeMoving>(mesh, quality, threads);
}

}  // namespace clarity::bench
