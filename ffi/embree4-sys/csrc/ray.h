/* How rays are handed to Embree. For the C files of this crate alone. */
#ifndef LUMIFLOW_EMBREE_RAY_H
#define LUMIFLOW_EMBREE_RAY_H

#include "shim.h"

#include <string.h>

/* 16 bytes that are written at once: what is read in larger pieces than it was written in has to
 * wait until it has left for the cache. */
typedef float Four __attribute__((vector_size(16), aligned(4), may_alias));

/* The bits of a number as a part of a Four. */
static inline float as_float(unsigned bits)
{
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline void set_ray(struct RTCRay *ray, Four origin_near, Four direction_time, float far)
{
    *(Four *)&ray->org_x = origin_near;
    *(Four *)&ray->dir_x = direction_time;
    ray->tfar = far;
    ray->mask = 0xFFFFFFFFu;
    ray->id = 0;
    ray->flags = 0;
}

#endif
