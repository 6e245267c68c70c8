/* Embree alone on recorded rays: what a renderer's throughput is measured against. */
#include "ray.h"

#include <math.h>
#include <stddef.h>

_Static_assert(sizeof(struct ShimRay) == 32, "ShimRay has no padding");
_Static_assert(offsetof(struct ShimRay, direction) == 16, "ShimRay is two pieces of 16 bytes");

/* A recorded ray in Embree's layout. */
static inline void load_ray(struct RTCRay *to, const struct ShimRay *from)
{
    Four way = *(const Four *)from->direction;
    float far = way[3];
    way[3] = 0.0f;
    set_ray(to, *(const Four *)from->origin, way, far);
}

struct ShimTally shim_raw_closest(RTCScene scene, const struct ShimRay *rays, size_t count)
{
    struct ShimTally tally = {0, 0.0};
#if RTC_VERSION_MAJOR < 4
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
#endif
    for (size_t index = 0; index < count; index++) {
        struct RTCRayHit query;
        load_ray(&query.ray, &rays[index]);
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
        rtcIntersect1(scene, &query, NULL);
#else
        rtcIntersect1(scene, &context, &query);
#endif
        if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
            tally.hits++;
            tally.distances += query.ray.tfar;
        }
    }
    return tally;
}

struct ShimTally shim_raw_occluded(RTCScene scene, const struct ShimRay *rays, size_t count)
{
    struct ShimTally tally = {0, 0.0};
#if RTC_VERSION_MAJOR < 4
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
#endif
    for (size_t index = 0; index < count; index++) {
        struct RTCRay ray;
        load_ray(&ray, &rays[index]);
#if RTC_VERSION_MAJOR >= 4
        rtcOccluded1(scene, &ray, NULL);
#else
        rtcOccluded1(scene, &context, &ray);
#endif
        tally.hits += ray.tfar == -INFINITY;
    }
    return tally;
}
