// embree.hpp -- Embree 3 or 4, whichever CMake has found. Other files call no function that differs between them.
#pragma once
#if CLARITY_EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace clarity {

// What a query is told beside its rays. coherent: the rays of a packet go through the tree together. Each thread needs its own.
class EmbreeQuery {
 public:
#if CLARITY_EMBREE == 4
    explicit EmbreeQuery(bool coherent) {
        rtcInitIntersectArguments(&closest_);
        rtcInitOccludedArguments(&any_);
        closest_.flags = any_.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    }
    void closest(RTCScene scene, RTCRayHit* ray) { rtcIntersect1(scene, ray, &closest_); }
    void closest(const int* valid, RTCScene scene, RTCRayHit8* rays) { rtcIntersect8(valid, scene, rays, &closest_); }
    void closest(const int* valid, RTCScene scene, RTCRayHit16* rays) { rtcIntersect16(valid, scene, rays, &closest_); }
    void any(RTCScene scene, RTCRay* ray) { rtcOccluded1(scene, ray, &any_); }
    void any(const int* valid, RTCScene scene, RTCRay8* rays) { rtcOccluded8(valid, scene, rays, &any_); }
    void any(const int* valid, RTCScene scene, RTCRay16* rays) { rtcOccluded16(valid, scene, rays, &any_); }

 private:
    RTCIntersectArguments closest_;
    RTCOccludedArguments any_;
#else
    explicit EmbreeQuery(bool coherent) {
        rtcInitIntersectContext(&context_);
        context_.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    }
    void closest(RTCScene scene, RTCRayHit* ray) { rtcIntersect1(scene, &context_, ray); }
    void closest(const int* valid, RTCScene scene, RTCRayHit8* rays) { rtcIntersect8(valid, scene, &context_, rays); }
    void closest(const int* valid, RTCScene scene, RTCRayHit16* rays) { rtcIntersect16(valid, scene, &context_, rays); }
    void any(RTCScene scene, RTCRay* ray) { rtcOccluded1(scene, &context_, ray); }
    void any(const int* valid, RTCScene scene, RTCRay8* rays) { rtcOccluded8(valid, scene, &context_, rays); }
    void any(const int* valid, RTCScene scene, RTCRay16* rays) { rtcOccluded16(valid, scene, &context_, rays); }

 private:
    RTCIntersectContext context_;
#endif
};

}  // namespace clarity
