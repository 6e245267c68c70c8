/* What C says better than Rust: the calls whose shape differs between Embree 3 and 4, the
 * analytic shapes' callbacks, and the floating-point mode of a thread.
 *
 * bindgen reads this file too; the Rust names are the C names. */
#ifndef LUMIFLOW_EMBREE_SHIM_H
#define LUMIFLOW_EMBREE_SHIM_H

#include <rtcore.h>
#include <stdbool.h>
#include <stddef.h>

#if RTC_VERSION < 31300
#error "Embree 3.13 or newer is needed"
#endif

/* Which callbacks an analytic geometry gets. */
enum ShimKind { SHIM_SPHERE, SHIM_DISK, SHIM_CYLINDER };

/* One sphere, disk or cylinder. The owner keeps it at one address, unchanged, while a geometry
 * uses it. */
struct ShimShape {
    float lower[3]; /* bounds, rounded outwards */
    float upper[3];
    /* Sphere: the centre. Disk and cylinder: where the object-space origin is. */
    double origin[3];
    double radius; /* sphere only */
    /* Disk and cylinder: inverse of the linear part of object-to-world, by rows. */
    double to_object[3][3];
};

/* Linear curves. The owner keeps it, and what it points to, at one address, unchanged, while a
 * geometry uses it. */
struct ShimCurves {
    const float (*points)[4]; /* x, y, z, radius */
    const unsigned *segments; /* the first of each segment's two points */
    unsigned segment_count;
};

/* A ray as it is recorded. */
struct ShimRay {
    float origin[3], near;
    float direction[3], far;
};

/* Eight recorded rays, number by number, and which of them there are: -1 for those, 0 for others. */
struct ShimPacket {
    _Alignas(32) int valid[8];
    float start_and_direction[7][8]; /* origin, near, direction, as Embree has them */
    float far[8];
};

/* What became of many rays. */
struct ShimTally {
    unsigned long long hits;
    double distances; /* the sum, in the order of the rays; zero of occlusion */
};

/* What a closest hit is. */
struct ShimHit {
    float distance, u, v;
    unsigned primitive;
    float normal[3];
    unsigned geometry;
    unsigned instance; /* RTC_INVALID_GEOMETRY_ID without one */
};

/* Finds the closest hit; false on a miss, which leaves *hit as it was.
 *
 * The ray comes in eight registers: Embree reads it in pieces of 16 bytes, which must have been
 * written as such, or the processor waits until all smaller pieces have left for the cache. */
bool shim_intersect(RTCScene scene, float origin_x, float origin_y, float origin_z, float near,
                    float direction_x, float direction_y, float direction_z, float far,
                    struct ShimHit *hit);

/* Whether anything is hit. */
bool shim_occluded(RTCScene scene, float origin_x, float origin_y, float origin_z, float near,
                   float direction_x, float direction_y, float direction_z, float far);

/* The same for eight rays at once, in Embree's own layout; -1 in `valid`, which is aligned by 32
 * bytes, for rays to trace, 0 for others. Rays are not taken for coherent: what becomes of one ray
 * would then depend on the others. */
void shim_intersect_packet(RTCScene scene, const int *valid, struct RTCRayHit8 *query);

/* Whether anything is hit, for eight rays at once: `tfar` of a ray becomes minus infinity. */
void shim_occluded_packet(RTCScene scene, const int *valid, struct RTCRay8 *rays);

/* Traces rays one by one in a loop that does nothing else; every ray must be one that Embree
 * accepts. */
struct ShimTally shim_raw_closest(RTCScene scene, const struct ShimRay *rays, size_t count);

/* Whether anything is hit, likewise. */
struct ShimTally shim_raw_occluded(RTCScene scene, const struct ShimRay *rays, size_t count);

/* The same for rays in packets: what Embree alone makes of rays that are asked about together. */
struct ShimTally shim_raw_closest_packets(RTCScene scene, const struct ShimPacket *packets,
                                          size_t count);
struct ShimTally shim_raw_occluded_packets(RTCScene scene, const struct ShimPacket *packets,
                                           size_t count);

/* A new, uncommitted user geometry with one primitive; NULL on error. */
RTCGeometry shim_new_analytic(RTCDevice device, enum ShimKind kind, const struct ShimShape *shape);

/* A new, uncommitted user geometry with one primitive for each segment; NULL on error. */
RTCGeometry shim_new_linear_curves(RTCDevice device, const struct ShimCurves *curves);

/* The device's last error in words, NULL where this Embree has none. The device may be NULL. */
const char *shim_error_message(RTCDevice device);

/* Makes the calling thread read and write denormal numbers as zero. */
void shim_flush_denormals(void);

#endif
