#include "ray.h"

#include <math.h>
#include <stddef.h>

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

/* Before 4.3 a hit ends with the instance; with instance arrays a second index follows. */
#if defined(RTC_GEOMETRY_INSTANCE_ARRAY)
#define EXPECTED_HIT_BYTES 48
#else
#define EXPECTED_HIT_BYTES 32
#endif

_Static_assert(RTC_MAX_INSTANCE_LEVEL_COUNT == 1, "the Rust side reads one instance id per hit");
_Static_assert(sizeof(struct RTCRay) == 48, "RTCRay has 48 bytes");
_Static_assert(offsetof(struct RTCRay, dir_x) == 16, "RTCRay.dir_x is at byte 16");
_Static_assert(offsetof(struct RTCRay, tfar) == 32, "RTCRay.tfar is at byte 32");
_Static_assert(sizeof(struct RTCHit) == EXPECTED_HIT_BYTES, "RTCHit has 32 or 48 bytes");
_Static_assert(offsetof(struct RTCHit, geomID) == 24, "RTCHit.geomID is at byte 24");
_Static_assert(offsetof(struct RTCHit, instID) == 28, "RTCHit.instID is at byte 28");
_Static_assert(sizeof(struct RTCRayHit) == 48 + EXPECTED_HIT_BYTES, "no gap between ray and hit");
_Static_assert(RTC_INVALID_GEOMETRY_ID == 0xFFFFFFFFu, "the Rust side names no id by this");
_Static_assert(_Alignof(struct RTCRay) >= 16, "quarters of a ray are aligned");
_Static_assert(sizeof(struct RTCRay8) == 8 * 48, "eight rays have no gaps");
_Static_assert(_Alignof(struct RTCRay8) == 32, "packets are aligned by 32 bytes");
_Static_assert(sizeof(struct ShimHit) == 36, "ShimHit has no padding");
_Static_assert(offsetof(struct ShimHit, primitive) == 12, "distance to primitive are one piece");
_Static_assert(sizeof(struct ShimShape) == 24 + 13 * sizeof(double), "ShimShape has no padding");

bool shim_intersect(RTCScene scene, float origin_x, float origin_y, float origin_z, float near,
                    float direction_x, float direction_y, float direction_z, float far,
                    struct ShimHit *hit)
{
    struct RTCRayHit query;
    set_ray(&query.ray, (Four){origin_x, origin_y, origin_z, near},
            (Four){direction_x, direction_y, direction_z, 0.0f}, far);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
    rtcIntersect1(scene, &query, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, &query);
#endif
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID)
        return false;
    *(Four *)&hit->distance =
        (Four){query.ray.tfar, query.hit.u, query.hit.v, as_float(query.hit.primID)};
    hit->normal[0] = query.hit.Ng_x;
    hit->normal[1] = query.hit.Ng_y;
    hit->normal[2] = query.hit.Ng_z;
    hit->geometry = query.hit.geomID;
    hit->instance = query.hit.instID[0];
    return true;
}

bool shim_occluded(RTCScene scene, float origin_x, float origin_y, float origin_z, float near,
                   float direction_x, float direction_y, float direction_z, float far)
{
    struct RTCRay ray;
    set_ray(&ray, (Four){origin_x, origin_y, origin_z, near},
            (Four){direction_x, direction_y, direction_z, 0.0f}, far);
#if RTC_VERSION_MAJOR >= 4
    rtcOccluded1(scene, &ray, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene, &context, &ray);
#endif
    return ray.tfar == -INFINITY;
}

void shim_intersect_packet(RTCScene scene, const int *valid, struct RTCRayHit8 *query)
{
#if RTC_VERSION_MAJOR >= 4
    rtcIntersect8(valid, scene, query, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect8(valid, scene, &context, query);
#endif
}

void shim_occluded_packet(RTCScene scene, const int *valid, struct RTCRay8 *rays)
{
#if RTC_VERSION_MAJOR >= 4
    rtcOccluded8(valid, scene, rays, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded8(valid, scene, &context, rays);
#endif
}

const char *shim_error_message(RTCDevice device)
{
#if RTC_VERSION >= 40300
    return rtcGetDeviceLastErrorMessage(device);
#else
    (void)device;
    return NULL;
#endif
}

void shim_flush_denormals(void)
{
#if defined(__SSE__)
    /* Bit 15: flush results to zero. Bit 6: read denormals as zero. */
    _mm_setcsr(_mm_getcsr() | 0x8040u);
#elif defined(__aarch64__)
    unsigned long long control;
    __asm__ volatile("mrs %0, fpcr" : "=r"(control));
    control |= 1ull << 24; /* FZ: both at once */
    __asm__ volatile("msr fpcr, %0" : : "r"(control));
#endif
}
