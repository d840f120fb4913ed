/* Answers hard rays with Embree 3's sphere points: apt-get install libembree-dev.
 *
 * cc -std=c99 -O2 -o embree embree.c -lembree3 -lm
 * ./embree hard-rays.txt [robust] > ANSWERS.txt
 *
 * Each ray gets a scene with its sphere. `robust` sets RTC_SCENE_FLAG_ROBUST. A ray of Embree begins
 * at zero at the earliest.
 */

#include <embree3/rtcore.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int main(int count, char **arguments)
{
    if (count < 2) {
        fprintf(stderr, "usage: %s hard-rays.txt [robust]\n", arguments[0]);
        return 2;
    }
    FILE *rays = fopen(arguments[1], "r");
    if (!rays) {
        perror(arguments[1]);
        return 2;
    }
    int is_robust = count > 2 && !strcmp(arguments[2], "robust");
    RTCDevice device = rtcNewDevice("threads=1");
    char line[1024];
    while (fgets(line, sizeof line, rays)) {
        if (line[0] == '#')
            continue;
        float x[12];
        char *rest = line;
        (void)strtol(rest, &rest, 10);
        for (int index = 0; index < 12; index++)
            x[index] = strtof(rest, &rest);
        RTCScene scene = rtcNewScene(device);
        if (is_robust)
            rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
        RTCGeometry sphere = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
        float *at = rtcSetNewGeometryBuffer(sphere, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                                            4 * sizeof(float), 1);
        memcpy(at, x + 8, 4 * sizeof(float));
        rtcCommitGeometry(sphere);
        rtcAttachGeometry(scene, sphere);
        rtcReleaseGeometry(sphere);
        rtcCommitScene(scene);
        struct RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        struct RTCRayHit it;
        memset(&it, 0, sizeof it);
        it.ray.org_x = x[0], it.ray.org_y = x[1], it.ray.org_z = x[2];
        it.ray.dir_x = x[3], it.ray.dir_y = x[4], it.ray.dir_z = x[5];
        it.ray.tnear = fmaxf(x[6], 0.0f), it.ray.tfar = x[7];
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
