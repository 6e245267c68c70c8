/* Embree alone on recorded rays: what a renderer's throughput is measured against. */
#include "ray.h"

#include <math.h>
#include <stddef.h>

_Static_assert(sizeof(struct ShimRay) == 32, "ShimRay has no padding");
_Static_assert(offsetof(struct RTCRay8, tnear) == 96 && offsetof(struct RTCRay8, time) == 224,
               "a packet begins like ShimPacket");
_Static_assert(offsetof(struct ShimRay, direction) == 16, "ShimRay is two pieces of 16 bytes");

/* What a call of Embree 3 needs beside its rays: made once, before a loop. Embree 4 needs nothing. */
#if RTC_VERSION_MAJOR >= 4
struct Context {
    char unused;
};
#define CALL(function, context, rays, ...) function(__VA_ARGS__, rays, NULL)
static inline void begin(struct Context *context)
{
    context->unused = 0;
}
#else
struct Context {
    struct RTCIntersectContext embree;
};
#define CALL(function, context, rays, ...) function(__VA_ARGS__, &(context)->embree, rays)
static inline void begin(struct Context *context)
{
    rtcInitIntersectContext(&context->embree);
}
#endif

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
    struct Context context;
    begin(&context);
    for (size_t index = 0; index < count; index++) {
        struct RTCRayHit query;
        load_ray(&query.ray, &rays[index]);
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        CALL(rtcIntersect1, &context, &query, scene);
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
    struct Context context;
    begin(&context);
    for (size_t index = 0; index < count; index++) {
        struct RTCRay ray;
        load_ray(&ray, &rays[index]);
        CALL(rtcOccluded1, &context, &ray, scene);
        tally.hits += ray.tfar == -INFINITY;
    }
    return tally;
}

/* Recorded rays in Embree's layout; what a call leaves as it was is set before the first one. */
static inline void load_packet(struct RTCRay8 *to, const struct ShimPacket *from)
{
    memcpy(to->org_x, from->start_and_direction, sizeof from->start_and_direction);
    memcpy(to->tfar, from->far, sizeof from->far);
}

/* The parts of a packet that all packets share. */
static void begin_packets(struct RTCRay8 *ray)
{
    memset(ray, 0, sizeof *ray);
    memset(ray->mask, 0xFF, sizeof ray->mask);
}

struct ShimTally shim_raw_closest_packets(RTCScene scene, const struct ShimPacket *packets,
                                          size_t count)
{
    struct ShimTally tally = {0, 0.0};
    struct Context context;
    begin(&context);
    struct RTCRayHit8 query;
    begin_packets(&query.ray);
    for (size_t index = 0; index < count; index++) {
        const struct ShimPacket *packet = &packets[index];
        load_packet(&query.ray, packet);
        memset(query.hit.geomID, 0xFF, sizeof query.hit.geomID);
        memset(query.hit.instID[0], 0xFF, sizeof query.hit.instID[0]);
        CALL(rtcIntersect8, &context, &query, packet->valid, scene);
        for (int lane = 0; lane < 8; lane++) {
            if (query.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID) {
                tally.hits++;
                tally.distances += query.ray.tfar[lane];
            }
        }
    }
    return tally;
}

struct ShimTally shim_raw_occluded_packets(RTCScene scene, const struct ShimPacket *packets,
                                           size_t count)
{
    struct ShimTally tally = {0, 0.0};
    struct Context context;
    begin(&context);
    struct RTCRay8 rays;
    begin_packets(&rays);
    for (size_t index = 0; index < count; index++) {
        const struct ShimPacket *packet = &packets[index];
        load_packet(&rays, packet);
        CALL(rtcOccluded8, &context, &rays, packet->valid, scene);
        for (int lane = 0; lane < 8; lane++)
            tally.hits += rays.tfar[lane] == -INFINITY;
    }
    return tally;
}
