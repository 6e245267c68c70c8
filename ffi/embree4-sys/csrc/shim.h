/* What C says better than Rust: the calls whose shape differs between Embree 3 and 4, the
 * analytic shapes' callbacks, and the floating-point mode of a thread.
 *
 * bindgen reads this file too; the Rust names are the C names. */
#ifndef LUMIFLOW_EMBREE_SHIM_H
#define LUMIFLOW_EMBREE_SHIM_H

#include <rtcore.h>

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

/* Finds the closest hit; fills hit->hit and ray.tfar, leaves hit.geomID invalid on a miss. */
void shim_intersect(RTCScene scene, struct RTCRayHit *hit);

/* Sets ray->tfar to minus infinity when anything is hit. */
void shim_occluded(RTCScene scene, struct RTCRay *ray);

/* A new, uncommitted user geometry with one primitive; NULL on error. */
RTCGeometry shim_new_analytic(RTCDevice device, enum ShimKind kind, const struct ShimShape *shape);

/* The device's last error in words, NULL where this Embree has none. The device may be NULL. */
const char *shim_error_message(RTCDevice device);

/* Makes the calling thread read and write denormal numbers as zero. */
void shim_flush_denormals(void);

#endif
