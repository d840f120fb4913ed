/* Answers hard rays with Embree 3.13.5's sphere points: apt-get install libembree-dev.
 *
 * cc -std=c99 -O2 -o embree embree.c -lembree3 -lm
 * ./embree hard-rays.txt [robust] > ANSWERS.txt
 *
 * Each ray gets a scene with its sphere. `robust` sets RTC_SCENE_FLAG_ROBUST. A ray of Embree
 * begins at zero at the earliest, so that one with a negative t_min is not asked.
 */

#include "rays.h"

#include <embree3/rtcore.h>

int main(int count, char **arguments)
{
    int is_robust = count == 3 && !strcmp(arguments[2], "robust");
    if (count != 2 && !is_robust) {
        fprintf(stderr, "usage: %s hard-rays.txt [robust]\n", arguments[0]);
        return 2;
    }
    struct rays rays = rays_open(arguments[1]);
    struct ray ray;
    RTCDevice device = rtcNewDevice("threads=1");
    if (!device) {
        fprintf(stderr, "Embree does not start: error %d\n", rtcGetDeviceError(NULL));
        return 1;
    }
    while (rays_next(&rays, &ray)) {
        if (ray.t_min < 0) {
            puts("-");
            continue;
        }
        RTCScene scene = rtcNewScene(device);
        if (is_robust)
            rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
        RTCGeometry sphere = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
        float *at = rtcSetNewGeometryBuffer(sphere, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                                            4 * sizeof(float), 1);
        memcpy(at, ray.center, sizeof ray.center);
        at[3] = ray.radius;
        rtcCommitGeometry(sphere);
        rtcAttachGeometry(scene, sphere);
        rtcReleaseGeometry(sphere);
        rtcCommitScene(scene);
        struct RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        struct RTCRayHit it;
        memset(&it, 0, sizeof it);
        it.ray.org_x = ray.origin[0], it.ray.org_y = ray.origin[1], it.ray.org_z = ray.origin[2];
        it.ray.dir_x = ray.direction[0], it.ray.dir_y = ray.direction[1];
        it.ray.dir_z = ray.direction[2];
        it.ray.tnear = ray.t_min, it.ray.tfar = ray.t_max;
        it.ray.mask = 0xffffffffu;
        it.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene, &context, &it);
        if (it.hit.geomID == RTC_INVALID_GEOMETRY_ID)
            puts("miss");
        else
            printf("%a\n", it.ray.tfar);
        rtcReleaseScene(scene);
    }
    rtcReleaseDevice(device);
    return 0;
}
