/* Exact spheres, disks, cylinders and linear curves as Embree user geometries.
 *
 * Everything is computed in double precision from the ray's single-precision numbers, so a hit is
 * as good from a million units away, or from the inside next to the surface, as from nearby, and
 * no square of a float overflows. The quadratics use the ray's distance from the centre (or axis)
 * instead of b*b - a*c, which cancels for far origins. The interval is Embree's own for triangles
 * in robust scenes: near <= distance <= far. */
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
    double origin[3], direction[3];
    relative_ray(shape, ray, origin, direction);
    double squared_length = dot(direction, direction);
    /* Twice the area of the triangle (centre, origin, origin + direction): distance from the centre
     * times length. */
    const double area[3] = {origin[1] * direction[2] - origin[2] * direction[1],
                            origin[2] * direction[0] - origin[0] * direction[2],
                            origin[0] * direction[1] - origin[1] * direction[0]};
    double chord_squared = shape->radius * shape->radius * squared_length - dot(area, area);
    /* A ray that misses has not divided, nor taken a root. */
    if (!(chord_squared >= 0.0))
        return false;
    double half_chord = sqrt(chord_squared);
    double middle = -dot(origin, direction);
    double scale = 1.0 / squared_length;
    for (int side = -1; side <= 1; side += 2) {
        double root = (middle + side * half_chord) * scale;
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

/* The rays of a packet that Embree asks about, as bits. */
static unsigned asked(const int *valid, unsigned count)
{
    unsigned lanes = 0;
    for (unsigned lane = 0; lane < count; lane++)
        lanes |= (valid[lane] != 0 ? 1u : 0u) << lane;
    return lanes;
}

/* Embree asks about one ray or about a packet; of a packet often about one ray only: which one
 * cannot be foreseen, so that nothing branches on the others. */
#define FOR_ASKED(lane, arguments)                                                                 \
    for (unsigned lanes = asked((arguments)->valid, (arguments)->N), lane;                         \
         lanes != 0 && (lane = (unsigned)__builtin_ctz(lanes), true); lanes &= lanes - 1)

#define CALLBACKS(name)                                                                            \
    static void intersect_##name(const struct RTCIntersectFunctionNArguments *arguments)           \
    {                                                                                              \
        const struct ShimShape *shape = arguments->geometryUserPtr;                                \
        FOR_ASKED(lane, arguments)                                                                 \
        {                                                                                          \
            struct Crossing crossing;                                                              \
            struct RTCHit found;                                                                   \
            struct RTCRay ray = ray_of_lane(arguments->rayhit, arguments->N, lane);                \
            if (!cross_##name(shape, &ray, &crossing))                                             \
                continue;                                                                          \
            describe_##name(shape, &crossing, &found);                                             \
            store_hit(arguments, lane, crossing.distance, &found);                                 \
        }                                                                                          \
    }                                                                                              \
    static void occluded_##name(const struct RTCOccludedFunctionNArguments *arguments)             \
    {                                                                                              \
        const struct ShimShape *shape = arguments->geometryUserPtr;                                \
        FOR_ASKED(lane, arguments)                                                                 \
        {                                                                                          \
            struct Crossing crossing;                                                              \
            struct RTCRay ray = ray_of_lane(arguments->ray, arguments->N, lane);                   \
            if (cross_##name(shape, &ray, &crossing))                                              \
                OF_RAY(arguments->ray, arguments->N, lane, tfar) = -INFINITY;                      \
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

/* A segment of a linear curve: the hull of the spheres around its two ends. */
struct Cone {
    double start[3], along[3];
    double start_radius, narrowing;  /* how much smaller the end's radius is */
    double squared_length, hull;     /* the latter without the square of `narrowing` */
};

static struct Cone cone_of_segment(const struct ShimCurves *curves, unsigned segment)
{
    const float *first = curves->points[curves->segments[segment]];
    const float *second = first + 4;
    struct Cone cone;
    for (int axis = 0; axis < 3; axis++) {
        cone.start[axis] = first[axis];
        cone.along[axis] = (double)second[axis] - first[axis];
    }
    cone.start_radius = first[3];
    cone.narrowing = (double)first[3] - second[3];
    cone.squared_length = dot(cone.along, cone.along);
    cone.hull = cone.squared_length - cone.narrowing * cone.narrowing;
    return cone;
}

/* Where between the ends, from 0 to 1, the sphere lies that a point of the surface belongs to; of
 * spheres inside of each other, the larger one. `position` is relative to the start. */
static double sphere_of_surface_point(const struct Cone *cone, const double position[3])
{
    if (!(cone->hull > 0.0))
        return cone->narrowing < 0.0 ? 1.0 : 0.0;
    double place = dot(cone->along, position) - cone->start_radius * cone->narrowing;
    return fmin(fmax(place / cone->hull, 0.0), 1.0);
}

/* Whether a point lies inside of a hull, by more than rounding; `point` as the ray gives it. */
static bool is_inside(const struct Cone *cone, const double point[3])
{
    double position[3];
    for (int axis = 0; axis < 3; axis++)
        position[axis] = point[axis] - cone->start[axis];
    double sphere = cone->narrowing < 0.0 ? 1.0 : 0.0;
    if (cone->hull > 0.0) {
        /* The nearest sphere lies before the point's foot, by as much as the hull's normals lean. */
        double foot = dot(cone->along, position) / cone->squared_length;
        double across = sqrt(fmax(dot(position, position) -
                                      foot * foot * cone->squared_length, 0.0));
        double lean = cone->narrowing / sqrt(cone->hull * cone->squared_length);
        sphere = fmin(fmax(foot - across * lean, 0.0), 1.0);
    }
    double radius = cone->start_radius - sphere * cone->narrowing;
    for (int axis = 0; axis < 3; axis++)
        position[axis] -= sphere * cone->along[axis];
    double inner = radius * (1.0 - 1e-7);
    return dot(position, position) < inner * inner;
}

/* Whether a point of a segment's surface, on the sphere at a place between its ends, is that of a
 * neighbour or inside of one. The sphere that two segments share is that of the second one, so that no
 * point is hit twice. */
static bool is_covered(const struct ShimCurves *curves, unsigned segment, double sphere,
                       const double point[3])
{
    const unsigned *segments = curves->segments;
    if (segment > 0 && segments[segment - 1] + 1 == segments[segment]) {
        struct Cone before = cone_of_segment(curves, segment - 1);
        if (is_inside(&before, point))
            return true;
    }
    if (segment + 1 < curves->segment_count && segments[segment + 1] == segments[segment] + 1) {
        struct Cone after = cone_of_segment(curves, segment + 1);
        return sphere >= 1.0 || is_inside(&after, point);
    }
    return false;
}

/* Widens an interval by the roots of a*t*t + 2*b*t + c that lie where the hull has this piece:
 * where `offset + t * slope` is between `low` and `high`. */
static void add_roots(double a, double b, double c, double offset, double slope, double low,
                      double high, double interval[2])
{
    double discriminant = b * b - a * c;
    if (!(discriminant >= 0.0) || a == 0.0)
        return;
    for (int side = -1; side <= 1; side += 2) {
        double root = (-b + side * sqrt(discriminant)) / a;
        double place = offset + root * slope;
        if (place >= low && place <= high) {
            interval[0] = fmin(interval[0], root);
            interval[1] = fmax(interval[1], root);
        }
    }
}

/* Hulls of two spheres are convex: the ray is inside between two distances. */
static bool cross_cone(const struct ShimCurves *curves, unsigned segment, const struct RTCRay *ray,
                       struct Crossing *crossing)
{
    struct Cone cone = cone_of_segment(curves, segment);
    double origin[3] = {ray->org_x, ray->org_y, ray->org_z};
    double direction[3] = {ray->dir_x, ray->dir_y, ray->dir_z};
    double from_start[3];
    for (int axis = 0; axis < 3; axis++)
        from_start[axis] = origin[axis] - cone.start[axis];
    /* From the ray's point nearest to the start on, distances are small and nothing cancels. */
    double squared_speed = dot(direction, direction);
    double shift = -dot(from_start, direction) / squared_speed;
    advance(from_start, direction, shift, from_start);
    double along_origin = dot(cone.along, from_start), along_speed = dot(cone.along, direction);
    double first = cone.start_radius, second = first - cone.narrowing;
    double offset = along_origin - first * cone.narrowing;
    double interval[2] = {INFINITY, -INFINITY};
    double towards = dot(from_start, direction), distance = dot(from_start, from_start);
    bool is_cone = cone.hull > 0.0;
    double low = is_cone ? 0.0 : cone.narrowing < 0.0 ? -INFINITY : INFINITY;
    double high = is_cone ? cone.hull : low;
    /* The sphere around the start, that around the end, and the cone between them. */
    add_roots(squared_speed, towards, distance - first * first, offset, along_speed, -INFINITY, low,
              interval);
    add_roots(squared_speed, towards - along_speed,
              distance - 2.0 * along_origin + cone.squared_length - second * second, offset,
              along_speed, high, INFINITY, interval);
    if (is_cone)
        add_roots(cone.hull * squared_speed - along_speed * along_speed,
                  cone.hull * towards - offset * along_speed,
                  cone.hull * (distance - first * first) - offset * offset, offset, along_speed,
                  low, high, interval);
    for (int end = 0; end < 2; end++) {
        double point[3], root = interval[end] + shift;
        if (!isfinite(root) || !accept(ray, root, crossing))
            continue;
        advance(origin, direction, root, point);
        advance(from_start, direction, interval[end], crossing->position);
        double sphere = sphere_of_surface_point(&cone, crossing->position);
        if (!is_covered(curves, segment, sphere, point))
            return true;
    }
    return false;
}

static void describe_cone(const struct ShimCurves *curves, unsigned segment,
                          const struct Crossing *crossing, struct RTCHit *hit)
{
    struct Cone cone = cone_of_segment(curves, segment);
    double sphere = sphere_of_surface_point(&cone, crossing->position);
    double normal[3];
    for (int axis = 0; axis < 3; axis++)
        normal[axis] = crossing->position[axis] - sphere * cone.along[axis];
    double scale = 1.0 / sqrt(dot(normal, normal));
    hit->Ng_x = (float)(normal[0] * scale);
    hit->Ng_y = (float)(normal[1] * scale);
    hit->Ng_z = (float)(normal[2] * scale);
    hit->u = (float)sphere;
    hit->v = 0.0f;
}

static void intersect_cone(const struct RTCIntersectFunctionNArguments *arguments)
{
    const struct ShimCurves *curves = arguments->geometryUserPtr;
    FOR_ASKED(lane, arguments)
    {
        struct Crossing crossing;
        struct RTCHit found;
        struct RTCRay ray = ray_of_lane(arguments->rayhit, arguments->N, lane);
        if (!cross_cone(curves, arguments->primID, &ray, &crossing))
            continue;
        describe_cone(curves, arguments->primID, &crossing, &found);
        store_hit(arguments, lane, crossing.distance, &found);
    }
}

static void occluded_cone(const struct RTCOccludedFunctionNArguments *arguments)
{
    const struct ShimCurves *curves = arguments->geometryUserPtr;
    FOR_ASKED(lane, arguments)
    {
        struct Crossing crossing;
        struct RTCRay ray = ray_of_lane(arguments->ray, arguments->N, lane);
        if (cross_cone(curves, arguments->primID, &ray, &crossing))
            OF_RAY(arguments->ray, arguments->N, lane, tfar) = -INFINITY;
    }
}

/* A little larger than needed: Embree's own slab tests are in single precision. */
static void cone_bounds(const struct RTCBoundsFunctionArguments *arguments)
{
    const struct ShimCurves *curves = arguments->geometryUserPtr;
    const float *first = curves->points[curves->segments[arguments->primID]];
    const float *second = first + 4;
    double low[3], high[3], reach = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = fmin((double)first[axis] - first[3], (double)second[axis] - second[3]);
        high[axis] = fmax((double)first[axis] + first[3], (double)second[axis] + second[3]);
        reach = fmax(reach, fmax(-low[axis], high[axis]));
    }
    double margin = 4.0 * FLT_EPSILON * reach;
    struct RTCBounds *box = arguments->bounds_o;
    box->lower_x = (float)(low[0] - margin);
    box->lower_y = (float)(low[1] - margin);
    box->lower_z = (float)(low[2] - margin);
    box->upper_x = (float)(high[0] + margin);
    box->upper_y = (float)(high[1] + margin);
    box->upper_z = (float)(high[2] + margin);
}

RTCGeometry shim_new_linear_curves(RTCDevice device, const struct ShimCurves *curves)
{
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    if (!geometry)
        return NULL;
    rtcSetGeometryUserPrimitiveCount(geometry, curves->segment_count);
    /* Embree takes a plain pointer and hands it back as it was: nothing writes through it. */
    rtcSetGeometryUserData(geometry, (void *)curves);
    rtcSetGeometryBoundsFunction(geometry, cone_bounds, NULL);
    rtcSetGeometryIntersectFunction(geometry, intersect_cone);
    rtcSetGeometryOccludedFunction(geometry, occluded_cone);
    return geometry;
}
