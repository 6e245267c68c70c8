/* Exact spheres, disks and cylinders as Embree user geometries.
 *
 * Everything is computed in double precision from the ray's single-precision numbers, so a hit is
 * as good from a million units away, or from the inside next to the surface, as from nearby, and
 * no square of a float overflows. The quadratics use the ray's closest point to the centre (or
 * axis) instead of b*b - a*c, which cancels for far origins. The interval is Embree's own for
 * triangles in robust scenes: near <= distance <= far. */
#include "shim.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>

static const double two_pi = 6.283185307179586476925286766559;

/* A point of a shape on the ray: `position` is relative to the centre (sphere, in world units)
 * or in object space (disk, cylinder). */
struct Crossing {
    float distance;
    double position[3];
};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* A root as the ray stores it, if it lies on the ray's interval. Not-a-number never does. */
static bool accept(const struct RTCRay *ray, double root, struct Crossing *crossing)
{
    float distance = (float)root;
    crossing->distance = distance;
    return distance >= ray->tnear && distance <= ray->tfar && distance <= FLT_MAX;
}

static void relative_ray(const struct ShimShape *shape, const struct RTCRay *ray, double origin[3],
                         double direction[3])
{
    origin[0] = (double)ray->org_x - shape->origin[0];
    origin[1] = (double)ray->org_y - shape->origin[1];
    origin[2] = (double)ray->org_z - shape->origin[2];
    direction[0] = ray->dir_x;
    direction[1] = ray->dir_y;
    direction[2] = ray->dir_z;
}

static void object_ray(const struct ShimShape *shape, const struct RTCRay *ray, double origin[3],
                       double direction[3])
{
    double relative_origin[3], world_direction[3];
    relative_ray(shape, ray, relative_origin, world_direction);
    for (int row = 0; row < 3; row++) {
        origin[row] = dot(shape->to_object[row], relative_origin);
        direction[row] = dot(shape->to_object[row], world_direction);
    }
}

static void advance(const double origin[3], const double direction[3], double distance,
                    double position[3])
{
    for (int axis = 0; axis < 3; axis++)
        position[axis] = origin[axis] + distance * direction[axis];
}

static bool cross_sphere(const struct ShimShape *shape, const struct RTCRay *ray,
                         struct Crossing *crossing)
{
    double origin[3], direction[3], nearest[3];
    relative_ray(shape, ray, origin, direction);
    double squared_length = dot(direction, direction);
    double middle = -dot(origin, direction) / squared_length;
    advance(origin, direction, middle, nearest);
    double chord_squared = shape->radius * shape->radius - dot(nearest, nearest);
    if (!(chord_squared >= 0.0))
        return false;
    double half_chord = sqrt(chord_squared / squared_length);
    for (int side = -1; side <= 1; side += 2) {
        double root = middle + side * half_chord;
        if (accept(ray, root, crossing)) {
            advance(origin, direction, root, crossing->position);
            return true;
        }
    }
    return false;
}

static bool cross_disk(const struct ShimShape *shape, const struct RTCRay *ray,
                       struct Crossing *crossing)
{
    double origin[3], direction[3];
    object_ray(shape, ray, origin, direction);
    double root = -origin[2] / direction[2];
    if (!accept(ray, root, crossing))
        return false;
    double *position = crossing->position;
    advance(origin, direction, root, position);
    return position[0] * position[0] + position[1] * position[1] <= 1.0;
}

static bool cross_cylinder(const struct ShimShape *shape, const struct RTCRay *ray,
                           struct Crossing *crossing)
{
    double origin[3], direction[3];
    object_ray(shape, ray, origin, direction);
    double squared_length = direction[0] * direction[0] + direction[1] * direction[1];
    double middle = -(origin[0] * direction[0] + origin[1] * direction[1]) / squared_length;
    /* Twice the area of the triangle (axis, origin, origin + direction): distance from the axis
     * times length. */
    double area = origin[0] * direction[1] - origin[1] * direction[0];
    double chord_squared = 1.0 - area * area / squared_length;
    if (!(chord_squared >= 0.0))
        return false;
    double half_chord = sqrt(chord_squared / squared_length);
    for (int side = -1; side <= 1; side += 2) {
        double root = middle + side * half_chord;
        advance(origin, direction, root, crossing->position);
        double height = crossing->position[2];
        if (height >= 0.0 && height <= 1.0 && accept(ray, root, crossing))
            return true;
    }
    return false;
}

/* Angle around z as a fraction of a turn, in [0, 1). */
static float turn(const double position[3])
{
    double angle = atan2(position[1], position[0]) / two_pi;
    float fraction = (float)(angle < 0.0 ? angle + 1.0 : angle);
    return fraction < 1.0f ? fraction : 0.0f;
}

/* The world-space normal of an object-space one: by the inverse transpose. */
static void set_normal(const struct ShimShape *shape, const double object_normal[3],
                       struct RTCHit *hit)
{
    double normal[3];
    for (int axis = 0; axis < 3; axis++)
        normal[axis] = shape->to_object[0][axis] * object_normal[0] +
                       shape->to_object[1][axis] * object_normal[1] +
                       shape->to_object[2][axis] * object_normal[2];
    /* Scaled to length 1 here, in double: a shape of extreme size would overflow a float. */
    double scale = 1.0 / sqrt(dot(normal, normal));
    hit->Ng_x = (float)(normal[0] * scale);
    hit->Ng_y = (float)(normal[1] * scale);
    hit->Ng_z = (float)(normal[2] * scale);
}

static void describe_sphere(const struct ShimShape *shape, const struct Crossing *crossing,
                            struct RTCHit *hit)
{
    const double *position = crossing->position;
    double scale = 1.0 / shape->radius;
    hit->Ng_x = (float)(position[0] * scale);
    hit->Ng_y = (float)(position[1] * scale);
    hit->Ng_z = (float)(position[2] * scale);
    hit->u = 0.0f;
    hit->v = 0.0f;
}

static void describe_disk(const struct ShimShape *shape, const struct Crossing *crossing,
                          struct RTCHit *hit)
{
    static const double up[3] = {0.0, 0.0, 1.0};
    const double *position = crossing->position;
    set_normal(shape, up, hit);
    hit->u = (float)sqrt(position[0] * position[0] + position[1] * position[1]);
    hit->v = turn(position);
}

static void describe_cylinder(const struct ShimShape *shape, const struct Crossing *crossing,
                              struct RTCHit *hit)
{
    const double *position = crossing->position;
    const double outwards[3] = {position[0], position[1], 0.0};
    set_normal(shape, outwards, hit);
    hit->u = turn(position);
    hit->v = (float)position[2];
}

/* A member of one ray of a packet: for each member in turn a packet has those of all `count` rays,
 * where a ray alone has one. */
#define OF_LANE(type, packet, count, lane, structure, member)                                      \
    (((type *)(packet))[(count) * (offsetof(structure, member) / sizeof(type)) + (lane)])
#define OF_RAY(packet, count, lane, member)                                                        \
    OF_LANE(float, packet, count, lane, struct RTCRay, member)
#define OF_HIT(type, packet, count, lane, member)                                                  \
    OF_LANE(type, packet, count, lane, struct RTCRayHit, hit.member)

static struct RTCRay ray_of_lane(void *packet, unsigned count, unsigned lane)
{
    struct RTCRay ray;
    ray.org_x = OF_RAY(packet, count, lane, org_x);
    ray.org_y = OF_RAY(packet, count, lane, org_y);
    ray.org_z = OF_RAY(packet, count, lane, org_z);
    ray.tnear = OF_RAY(packet, count, lane, tnear);
    ray.dir_x = OF_RAY(packet, count, lane, dir_x);
    ray.dir_y = OF_RAY(packet, count, lane, dir_y);
    ray.dir_z = OF_RAY(packet, count, lane, dir_z);
    ray.tfar = OF_RAY(packet, count, lane, tfar);
    return ray;
}

static void store_hit(const struct RTCIntersectFunctionNArguments *arguments, unsigned lane,
                      float distance, const struct RTCHit *found)
{
    unsigned count = arguments->N;
    void *packet = arguments->rayhit;
    OF_RAY(packet, count, lane, tfar) = distance;
    OF_HIT(float, packet, count, lane, Ng_x) = found->Ng_x;
    OF_HIT(float, packet, count, lane, Ng_y) = found->Ng_y;
    OF_HIT(float, packet, count, lane, Ng_z) = found->Ng_z;
    OF_HIT(float, packet, count, lane, u) = found->u;
    OF_HIT(float, packet, count, lane, v) = found->v;
    OF_HIT(unsigned, packet, count, lane, primID) = arguments->primID;
    OF_HIT(unsigned, packet, count, lane, geomID) = arguments->geomID;
    OF_HIT(unsigned, packet, count, lane, instID[0]) = arguments->context->instID[0];
}

/* Embree asks about one ray or about a packet; of a packet often about one ray only. */
#define CALLBACKS(name)                                                                            \
    static void intersect_##name(const struct RTCIntersectFunctionNArguments *arguments)           \
    {                                                                                              \
        const struct ShimShape *shape = arguments->geometryUserPtr;                                \
        unsigned count = arguments->N;                                                             \
        for (unsigned lane = 0; lane < count; lane++) {                                            \
            struct Crossing crossing;                                                              \
            struct RTCHit found;                                                                   \
            if (!arguments->valid[lane])                                                           \
                continue;                                                                          \
            struct RTCRay ray = ray_of_lane(arguments->rayhit, count, lane);                        \
            if (!cross_##name(shape, &ray, &crossing))                                             \
                continue;                                                                          \
            describe_##name(shape, &crossing, &found);                                             \
            store_hit(arguments, lane, crossing.distance, &found);                                 \
        }                                                                                          \
    }                                                                                              \
    static void occluded_##name(const struct RTCOccludedFunctionNArguments *arguments)             \
    {                                                                                              \
        const struct ShimShape *shape = arguments->geometryUserPtr;                                \
        unsigned count = arguments->N;                                                             \
        for (unsigned lane = 0; lane < count; lane++) {                                            \
            struct Crossing crossing;                                                              \
            if (!arguments->valid[lane])                                                           \
                continue;                                                                          \
            struct RTCRay ray = ray_of_lane(arguments->ray, count, lane);                           \
            if (cross_##name(shape, &ray, &crossing))                                              \
                OF_RAY(arguments->ray, count, lane, tfar) = -INFINITY;                             \
        }                                                                                          \
    }

CALLBACKS(sphere)
CALLBACKS(disk)
CALLBACKS(cylinder)

static void bounds(const struct RTCBoundsFunctionArguments *arguments)
{
    const struct ShimShape *shape = arguments->geometryUserPtr;
    struct RTCBounds *box = arguments->bounds_o;
    box->lower_x = shape->lower[0];
    box->lower_y = shape->lower[1];
    box->lower_z = shape->lower[2];
    box->upper_x = shape->upper[0];
    box->upper_y = shape->upper[1];
    box->upper_z = shape->upper[2];
}

RTCGeometry shim_new_analytic(RTCDevice device, enum ShimKind kind, const struct ShimShape *shape)
{
    static const RTCIntersectFunctionN intersect[] = {intersect_sphere, intersect_disk,
                                                      intersect_cylinder};
    static const RTCOccludedFunctionN occluded[] = {occluded_sphere, occluded_disk,
                                                    occluded_cylinder};
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    if (!geometry)
        return NULL;
    rtcSetGeometryUserPrimitiveCount(geometry, 1);
    /* Embree takes a plain pointer and hands it back as it was: nothing writes through it. */
    rtcSetGeometryUserData(geometry, (void *)shape);
    rtcSetGeometryBoundsFunction(geometry, bounds, NULL);
    rtcSetGeometryIntersectFunction(geometry, intersect[kind]);
    rtcSetGeometryOccludedFunction(geometry, occluded[kind]);
    return geometry;
}
