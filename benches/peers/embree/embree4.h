// The part of Embree 4's C API that embree.cpp calls, declared here because Python wheels ship
// the library without its headers. Names, values and layouts are those of Embree 4.4, built with
// one instance level and instance arrays, which is Embree's default.
#pragma once

#include <cstddef>
#include <sys/types.h>

struct RTCDeviceTy;
struct RTCSceneTy;
struct RTCGeometryTy;
using RTCDevice = RTCDeviceTy*;
using RTCScene = RTCSceneTy*;
using RTCGeometry = RTCGeometryTy*;

constexpr unsigned RTC_INVALID_GEOMETRY_ID = ~0u;

enum RTCError : int { RTC_ERROR_NONE = 0 };
enum RTCDeviceProperty : int { RTC_DEVICE_PROPERTY_VERSION = 0 };
enum RTCFormat : int { RTC_FORMAT_FLOAT4 = 0x9004 };
enum RTCBufferType : int { RTC_BUFFER_TYPE_VERTEX = 1 };
enum RTCBuildQuality : int { RTC_BUILD_QUALITY_MEDIUM = 1 };
enum RTCGeometryType : int { RTC_GEOMETRY_TYPE_SPHERE_POINT = 50, RTC_GEOMETRY_TYPE_USER = 120 };
enum RTCFeatureFlags : int {
    RTC_FEATURE_FLAG_SPHERE_POINT = 1 << 20,
    RTC_FEATURE_FLAG_USER_GEOMETRY_CALLBACK_IN_GEOMETRY = 1 << 27,
    RTC_FEATURE_FLAG_ALL = -1,
};
enum RTCRayQueryFlags : int {
    RTC_RAY_QUERY_FLAG_INCOHERENT = 0,
    RTC_RAY_QUERY_FLAG_COHERENT = 1 << 16,
};

struct alignas(16) RTCBounds {
    float lower_x, lower_y, lower_z, align0;
    float upper_x, upper_y, upper_z, align1;
};

struct alignas(16) RTCRay {
    float org_x, org_y, org_z, tnear;
    float dir_x, dir_y, dir_z, time;
    float tfar;
    unsigned mask, id, flags;
};

struct alignas(16) RTCHit {
    float Ng_x, Ng_y, Ng_z, u, v;
    unsigned primID, geomID, instID[1], instPrimID[1];
};

struct RTCRayHit {
    RTCRay ray;
    RTCHit hit;
};

struct alignas(64) RTCRay16 {
    float org_x[16], org_y[16], org_z[16], tnear[16];
    float dir_x[16], dir_y[16], dir_z[16], time[16];
    float tfar[16];
    unsigned mask[16], id[16], flags[16];
};

struct alignas(64) RTCHit16 {
    float Ng_x[16], Ng_y[16], Ng_z[16], u[16], v[16];
    unsigned primID[16], geomID[16], instID[1][16], instPrimID[1][16];
};

struct RTCRayHit16 {
    RTCRay16 ray;
    RTCHit16 hit;
};

struct RTCRayN;
struct RTCRayHitN;
struct RTCRayQueryContext;
struct RTCFilterFunctionNArguments;

struct RTCBoundsFunctionArguments {
    void* geometryUserPtr;
    unsigned primID, timeStep;
    RTCBounds* bounds_o;
};

struct RTCIntersectFunctionNArguments {
    int* valid;
    void* geometryUserPtr;
    unsigned primID;
    RTCRayQueryContext* context;
    RTCRayHitN* rayhit;
    unsigned N, geomID;
};

struct RTCOccludedFunctionNArguments {
    int* valid;
    void* geometryUserPtr;
    unsigned primID;
    RTCRayQueryContext* context;
    RTCRayN* ray;
    unsigned N, geomID;
};

using RTCErrorFunction = void (*)(void*, RTCError, const char*);
using RTCMemoryMonitorFunction = bool (*)(void*, ssize_t bytes, bool post);
using RTCBoundsFunction = void (*)(const RTCBoundsFunctionArguments*);
using RTCFilterFunctionN = void (*)(const RTCFilterFunctionNArguments*);
using RTCIntersectFunctionN = void (*)(const RTCIntersectFunctionNArguments*);
using RTCOccludedFunctionN = void (*)(const RTCOccludedFunctionNArguments*);

struct RTCIntersectArguments {
    RTCRayQueryFlags flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
    RTCFeatureFlags feature_mask = RTC_FEATURE_FLAG_ALL;
    RTCRayQueryContext* context = nullptr;
    RTCFilterFunctionN filter = nullptr;
    RTCIntersectFunctionN intersect = nullptr;
};

struct RTCOccludedArguments {
    RTCRayQueryFlags flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
    RTCFeatureFlags feature_mask = RTC_FEATURE_FLAG_ALL;
    RTCRayQueryContext* context = nullptr;
    RTCFilterFunctionN filter = nullptr;
    RTCOccludedFunctionN occluded = nullptr;
};

extern "C" {
RTCDevice rtcNewDevice(const char* config);
RTCError rtcGetDeviceError(RTCDevice);
ssize_t rtcGetDeviceProperty(RTCDevice, RTCDeviceProperty);
void rtcSetDeviceErrorFunction(RTCDevice, RTCErrorFunction, void* user);
void rtcSetDeviceMemoryMonitorFunction(RTCDevice, RTCMemoryMonitorFunction, void* user);

RTCGeometry rtcNewGeometry(RTCDevice, RTCGeometryType);
void rtcSetGeometryBuildQuality(RTCGeometry, RTCBuildQuality);
void rtcSetSharedGeometryBuffer(RTCGeometry, RTCBufferType, unsigned slot, RTCFormat,
                                const void* data, size_t offset, size_t stride, size_t count);
void rtcSetGeometryUserData(RTCGeometry, void*);
void rtcSetGeometryUserPrimitiveCount(RTCGeometry, unsigned);
void rtcSetGeometryBoundsFunction(RTCGeometry, RTCBoundsFunction, void* user);
void rtcSetGeometryIntersectFunction(RTCGeometry, RTCIntersectFunctionN);
void rtcSetGeometryOccludedFunction(RTCGeometry, RTCOccludedFunctionN);
void rtcCommitGeometry(RTCGeometry);
void rtcReleaseGeometry(RTCGeometry);

RTCScene rtcNewScene(RTCDevice);
unsigned rtcAttachGeometry(RTCScene, RTCGeometry);
void rtcSetSceneBuildQuality(RTCScene, RTCBuildQuality);
void rtcCommitScene(RTCScene);

void rtcIntersect1(RTCScene, RTCRayHit*, RTCIntersectArguments*);
void rtcOccluded1(RTCScene, RTCRay*, RTCOccludedArguments*);
void rtcIntersect16(const int* valid, RTCScene, RTCRayHit16*, RTCIntersectArguments*);
void rtcOccluded16(const int* valid, RTCScene, RTCRay16*, RTCOccludedArguments*);
}
