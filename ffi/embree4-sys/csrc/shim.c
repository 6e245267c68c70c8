#include "shim.h"

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
_Static_assert(offsetof(struct RTCRay, tfar) == 32, "RTCRay.tfar is at byte 32");
_Static_assert(sizeof(struct RTCHit) == EXPECTED_HIT_BYTES, "RTCHit has 32 or 48 bytes");
_Static_assert(offsetof(struct RTCHit, geomID) == 24, "RTCHit.geomID is at byte 24");
_Static_assert(offsetof(struct RTCHit, instID) == 28, "RTCHit.instID is at byte 28");
_Static_assert(sizeof(struct RTCRayHit) == 48 + EXPECTED_HIT_BYTES, "no gap between ray and hit");
_Static_assert(RTC_INVALID_GEOMETRY_ID == 0xFFFFFFFFu, "the Rust side names no id by this");
_Static_assert(sizeof(struct ShimShape) == 24 + 13 * sizeof(double), "ShimShape has no padding");

void shim_intersect(RTCScene scene, struct RTCRayHit *hit)
{
#if RTC_VERSION_MAJOR >= 4
    rtcIntersect1(scene, hit, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, hit);
#endif
}

void shim_occluded(RTCScene scene, struct RTCRay *ray)
{
#if RTC_VERSION_MAJOR >= 4
    rtcOccluded1(scene, ray, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene, &context, ray);
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
