// Embree 4, or Embree 3 with -DEMBREE3: spheres as Embree's own sphere points, or as user geometry
// with the callbacks below.
//
//     embree4 DIR --geometry points|callback [--threads N] [--repeat 3] [--hits FOLDER]
//
// Reads the scene in DIR, prints one line of JSON. Each kind of rays is traced ray by ray, in
// packets of 16, and in packets of 16 flagged as coherent; the fastest counts.

#ifdef EMBREE3
#include <embree3/rtcore.h>
#else
#include "embree4.h"
#endif

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

#include <xmmintrin.h>

namespace {

constexpr uint32_t NONE = ~0u;

[[noreturn]] void die(const std::string& message) {
    std::fprintf(stderr, "embree: %s\n", message.c_str());
    std::exit(1);
}

double now() {
    using namespace std::chrono;
    return duration<double>(steady_clock::now().time_since_epoch()).count();
}

// The scene on disk.

struct Sphere {
    float x, y, z, r;
};

struct Ray {
    float org[3], t_min, dir[3], t_max;
};

struct Hit {
    float t;
    uint32_t id;
};

template <class T>
std::vector<T> read_all(const std::string& path) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) die("cannot read " + path);
    std::vector<T> items(size_t(file.tellg()) / sizeof(T));
    file.seekg(0);
    file.read(reinterpret_cast<char*>(items.data()), std::streamsize(items.size() * sizeof(T)));
    return items;
}

template <class T>
void write_all(const std::string& path, const std::vector<T>& items) {
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(items.data()), std::streamsize(items.size() * sizeof(T)));
    if (!file) die("cannot write " + path);
}

// meta.json is always written by the same program in the same form; a full parser is not worth a
// dependency.
std::string meta_value(const std::string& meta, const std::string& key) {
    size_t at = meta.find('"' + key + '"');
    if (at == std::string::npos) die("no " + key + " in meta.json");
    at = meta.find_first_not_of(" :\t\r\n\"", at + key.size() + 2);
    return meta.substr(at, meta.find_first_of(",}\"", at) - at);
}

// Sphere callbacks.

// Embree lays N rays out as arrays of N floats: origin, tnear, direction, time, tfar. Writes t and
// returns whether any of the valid rays meets the sphere, with `met` saying which.
template <int N>
inline bool meet(const Sphere& sphere, const float* ray, const int* valid, float* t, int* met) {
    const float *ox = ray, *oy = ox + N, *oz = oy + N, *tnear = oz + N;
    const float *dx = tnear + N, *dy = dx + N, *dz = dy + N, *tfar = dz + 2 * N;
    float aa[N], bb[N], delta[N];
    int any = 0;
    for (int i = 0; i < N; i++) {
        float cx = sphere.x - ox[i], cy = sphere.y - oy[i], cz = sphere.z - oz[i];
        float kx = cy * dz[i] - cz * dy[i];
        float ky = cz * dx[i] - cx * dz[i];
        float kz = cx * dy[i] - cy * dx[i];
        aa[i] = dx[i] * dx[i] + dy[i] * dy[i] + dz[i] * dz[i];
        bb[i] = cx * dx[i] + cy * dy[i] + cz * dz[i];
        delta[i] = aa[i] * (sphere.r * sphere.r) - (kx * kx + ky * ky + kz * kz);
        met[i] = valid[i] & -int(delta[i] >= 0);
        any |= met[i];
    }
    if (!any) return false;
    any = 0;
    for (int i = 0; i < N; i++) {
        float root = std::sqrt(delta[i]), over = 1 / aa[i];
        float near = (bb[i] - root) * over, far = (bb[i] + root) * over;
        t[i] = near >= tnear[i] ? near : far;
        met[i] &= -int(t[i] >= tnear[i]) & -int(t[i] < tfar[i]);
        any |= met[i];
    }
    return any != 0;
}

template <int N>
void intersect_n(const RTCIntersectFunctionNArguments* args) {
    float* ray = reinterpret_cast<float*>(args->rayhit);
    auto* hit = reinterpret_cast<uint32_t*>(ray + 12 * N);
    const auto* spheres = static_cast<const Sphere*>(args->geometryUserPtr);
    alignas(64) float t[N];
    alignas(64) int met[N];
    if (!meet<N>(spheres[args->primID], ray, args->valid, t, met)) return;
    float* tfar = ray + 8 * N;
    uint32_t *prim = hit + 5 * N, *geom = hit + 6 * N;
    for (int i = 0; i < N; i++) {
        tfar[i] = met[i] ? t[i] : tfar[i];
        prim[i] = met[i] ? args->primID : prim[i];
        geom[i] = met[i] ? args->geomID : geom[i];
    }
}

template <int N>
void occluded_n(const RTCOccludedFunctionNArguments* args) {
    float* ray = reinterpret_cast<float*>(args->ray);
    const auto* spheres = static_cast<const Sphere*>(args->geometryUserPtr);
    alignas(64) float t[N];
    alignas(64) int met[N];
    if (!meet<N>(spheres[args->primID], ray, args->valid, t, met)) return;
    float* tfar = ray + 8 * N;
    for (int i = 0; i < N; i++)
        tfar[i] = met[i] ? -std::numeric_limits<float>::infinity() : tfar[i];
}

void intersect(const RTCIntersectFunctionNArguments* args) {
    switch (args->N) {
        case 1: return intersect_n<1>(args);
        case 4: return intersect_n<4>(args);
        case 8: return intersect_n<8>(args);
        case 16: return intersect_n<16>(args);
        default: die("a packet of unexpected size");
    }
}

void occluded(const RTCOccludedFunctionNArguments* args) {
    switch (args->N) {
        case 1: return occluded_n<1>(args);
        case 4: return occluded_n<4>(args);
        case 8: return occluded_n<8>(args);
        case 16: return occluded_n<16>(args);
        default: die("a packet of unexpected size");
    }
}

void bounds(const RTCBoundsFunctionArguments* args) {
    const Sphere& s = static_cast<const Sphere*>(args->geometryUserPtr)[args->primID];
    RTCBounds& b = *args->bounds_o;
    b.lower_x = s.x - s.r, b.lower_y = s.y - s.r, b.lower_z = s.z - s.r;
    b.upper_x = s.x + s.r, b.upper_y = s.y + s.r, b.upper_z = s.z + s.r;
}

// The differences between the two versions of the API.

#ifdef EMBREE3
struct Query {
    RTCIntersectContext context;
    explicit Query(bool coherent, bool) {
        rtcInitIntersectContext(&context);
        context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    }
    void nearest(RTCScene scene, RTCRayHit* ray) { rtcIntersect1(scene, &context, ray); }
    void any(RTCScene scene, RTCRay* ray) { rtcOccluded1(scene, &context, ray); }
    void nearest(const int* valid, RTCScene scene, RTCRayHit16* rays) { rtcIntersect16(valid, scene, &context, rays); }
    void any(const int* valid, RTCScene scene, RTCRay16* rays) { rtcOccluded16(valid, scene, &context, rays); }
};
#else
struct Query {
    RTCIntersectArguments nearest_args;
    RTCOccludedArguments any_args;
    Query(bool coherent, bool points) {
        nearest_args.flags = any_args.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
        nearest_args.feature_mask = any_args.feature_mask =
            points ? RTC_FEATURE_FLAG_SPHERE_POINT : RTC_FEATURE_FLAG_USER_GEOMETRY_CALLBACK_IN_GEOMETRY;
    }
    void nearest(RTCScene scene, RTCRayHit* ray) { rtcIntersect1(scene, ray, &nearest_args); }
    void any(RTCScene scene, RTCRay* ray) { rtcOccluded1(scene, ray, &any_args); }
    void nearest(const int* valid, RTCScene scene, RTCRayHit16* rays) { rtcIntersect16(valid, scene, rays, &nearest_args); }
    void any(const int* valid, RTCScene scene, RTCRay16* rays) { rtcOccluded16(valid, scene, rays, &any_args); }
};
#endif

// Tracing.

// 16 rays in the layout of Embree's fields, and where their answers go.
struct alignas(64) Packet {
    float org_tnear[4][16], dir[3][16], tfar[16];
    int valid[16];
    uint32_t index[16];
};

// `order` lists rays, NONE for a lane without one; its length is a multiple of 16.
std::vector<Packet> pack(const std::vector<Ray>& rays, const std::vector<uint32_t>& order) {
    std::vector<Packet> packets(order.size() / 16);
    for (size_t k = 0; k < order.size(); k++) {
        Packet& p = packets[k / 16];
        size_t lane = k % 16;
        p.index[lane] = order[k];
        p.valid[lane] = order[k] == NONE ? 0 : -1;
        const Ray& ray = rays[order[k] == NONE ? 0 : order[k]];
        for (int axis = 0; axis < 3; axis++) {
            p.org_tnear[axis][lane] = ray.org[axis];
            p.dir[axis][lane] = ray.dir[axis];
        }
        p.org_tnear[3][lane] = ray.t_min;
        p.tfar[lane] = ray.t_max;
    }
    return packets;
}

std::vector<uint32_t> consecutive(size_t count) {
    std::vector<uint32_t> order((count + 15) / 16 * 16, NONE);
    for (size_t i = 0; i < count; i++) order[i] = uint32_t(i);
    return order;
}

std::vector<uint32_t> tiles(size_t width, size_t height) {
    std::vector<uint32_t> order;
    for (size_t y0 = 0; y0 < height; y0 += 4)
        for (size_t x0 = 0; x0 < width; x0 += 4)
            for (size_t lane = 0; lane < 16; lane++) {
                size_t x = x0 + lane % 4, y = y0 + lane / 4;
                order.push_back(x < width && y < height ? uint32_t(y * width + x) : NONE);
            }
    return order;
}

void load(RTCRay16& to, const Packet& from) {
    std::memcpy(&to.org_x, from.org_tnear, sizeof from.org_tnear);
    std::memcpy(&to.dir_x, from.dir, sizeof from.dir);
    std::memset(&to.time, 0, sizeof to.time);
    std::memcpy(&to.tfar, from.tfar, sizeof from.tfar);
    std::memset(&to.mask, -1, sizeof to.mask);
    std::memset(&to.id, 0, sizeof to.id);
    std::memset(&to.flags, 0, sizeof to.flags);
}

RTCRay load(const Ray& ray) {
    return {ray.org[0], ray.org[1], ray.org[2], ray.t_min, ray.dir[0], ray.dir[1], ray.dir[2], 0, ray.t_max, ~0u, 0, 0};
}

// Runs work(first, last) over [0, count) in pieces on all threads and returns the seconds.
template <class Work>
double parallel(unsigned threads, size_t count, size_t piece, const Work& work) {
    std::atomic<size_t> next{0};
    auto loop = [&] {
        _mm_setcsr(_mm_getcsr() | 0x8040);  // as Embree asks: flush denormals, treat them as zero
        for (size_t first; (first = next.fetch_add(piece)) < count;) work(first, std::min(first + piece, count));
    };
    double start = now();
    std::vector<std::thread> others;
    for (unsigned i = 1; i < threads; i++) others.emplace_back(loop);
    loop();
    for (auto& thread : others) thread.join();
    return now() - start;
}

struct Tracer {
    RTCScene scene;
    bool points;
    unsigned threads;

    double nearest_single(const std::vector<Ray>& rays, std::vector<Hit>& hits) const {
        return parallel(threads, rays.size(), 1024, [&](size_t first, size_t last) {
            Query query(false, points);
            RTCRayHit rh;
            for (size_t i = first; i < last; i++) {
                rh.ray = load(rays[i]);
                rh.hit.geomID = rh.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
                query.nearest(scene, &rh);
                hits[i] = {rh.ray.tfar, rh.hit.geomID == RTC_INVALID_GEOMETRY_ID ? NONE : rh.hit.primID};
            }
        });
    }

    double any_single(const std::vector<Ray>& rays, std::vector<uint32_t>& hits) const {
        return parallel(threads, rays.size(), 1024, [&](size_t first, size_t last) {
            Query query(false, points);
            for (size_t i = first; i < last; i++) {
                RTCRay ray = load(rays[i]);
                query.any(scene, &ray);
                hits[i] = ray.tfar < 0;
            }
        });
    }

    double nearest_packets(const std::vector<Packet>& packets, bool coherent, std::vector<Hit>& hits) const {
        return parallel(threads, packets.size(), 64, [&](size_t first, size_t last) {
            Query query(coherent, points);
            RTCRayHit16 rh;
            for (size_t k = first; k < last; k++) {
                const Packet& packet = packets[k];
                load(rh.ray, packet);
                std::memset(&rh.hit.geomID, -1, sizeof rh.hit.geomID);
                std::memset(&rh.hit.instID, -1, sizeof rh.hit.instID);
                query.nearest(packet.valid, scene, &rh);
                for (int i = 0; i < 16; i++) {
                    if (packet.index[i] == NONE) continue;
                    bool none = rh.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID;
                    hits[packet.index[i]] = {rh.ray.tfar[i], none ? NONE : rh.hit.primID[i]};
                }
            }
        });
    }

    double any_packets(const std::vector<Packet>& packets, bool coherent, std::vector<uint32_t>& hits) const {
        return parallel(threads, packets.size(), 64, [&](size_t first, size_t last) {
            Query query(coherent, points);
            RTCRay16 rays;
            for (size_t k = first; k < last; k++) {
                const Packet& packet = packets[k];
                load(rays, packet);
                query.any(packet.valid, scene, &rays);
                for (int i = 0; i < 16; i++)
                    if (packet.index[i] != NONE) hits[packet.index[i]] = rays.tfar[i] < 0;
            }
        });
    }
};

// The best of several repetitions of three ways to trace; the answers are those of the best way.
template <class Answer, class Single, class Packets>
std::string best(int repeat, size_t count, std::vector<Answer>& answers, const Single& single, const Packets& packets) {
    const char* names[] = {"single", "packet16", "packet16 coherent"};
    double seconds = INFINITY;
    int way = 0;
    std::vector<Answer> tried(count);
    for (int w = 0; w < 3; w++)
        for (int k = 0; k < repeat; k++) {
            double s = w == 0 ? single(tried) : packets(w == 2, tried);
            if (s >= seconds) continue;
            seconds = s;
            way = w;
            answers = tried;
        }
    size_t hits = 0;
    for (const Answer& a : answers)
        if constexpr (std::is_same_v<Answer, Hit>) hits += a.id != NONE;
        else hits += a;
    std::ostringstream json;
    json << "{\"seconds\":" << seconds << ",\"hits\":" << hits << ",\"way\":\"" << names[way] << "\"}";
    return json.str();
}

}  // namespace

int main(int argc, char** argv) {
    std::string dir, geometry = "points", out;
    unsigned threads = std::max(1u, std::thread::hardware_concurrency());
    int repeat = 3;
    for (int i = 1; i < argc; i++) {
        std::string word = argv[i];
        if (word.rfind("--", 0) != 0) {
            dir = word;
            continue;
        }
        if (++i == argc) die(word + " needs a value");
        if (word == "--geometry") geometry = argv[i];
        else if (word == "--threads") threads = unsigned(std::max(1, std::atoi(argv[i])));
        else if (word == "--repeat") repeat = std::max(1, std::atoi(argv[i]));
        else if (word == "--hits") out = argv[i];
        else die("unknown option " + word);
    }
    if (dir.empty()) die("usage: embree DIR --geometry points|callback [--threads N] [--repeat N] [--hits FOLDER]");
    bool points = geometry == "points";
    if (!points && geometry != "callback") die("--geometry is points or callback");

    std::ifstream meta_file(dir + "/meta.json");
    std::string meta((std::istreambuf_iterator<char>(meta_file)), {});
    auto spheres = read_all<Sphere>(dir + "/spheres.f32");

    RTCDevice device = rtcNewDevice(("threads=" + std::to_string(threads)).c_str());
    if (!device) die("no device: error " + std::to_string(rtcGetDeviceError(nullptr)));
    rtcSetDeviceErrorFunction(device, [](void*, RTCError, const char* text) { die(text); }, nullptr);
    std::atomic<ssize_t> bytes{0};
    rtcSetDeviceMemoryMonitorFunction(
        device, [](void* sum, ssize_t n, bool) { return *static_cast<std::atomic<ssize_t>*>(sum) += n, true; }, &bytes);

    double start = now();
    RTCGeometry geom = rtcNewGeometry(device, points ? RTC_GEOMETRY_TYPE_SPHERE_POINT : RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryBuildQuality(geom, RTC_BUILD_QUALITY_MEDIUM);
    if (points) {
        rtcSetSharedGeometryBuffer(geom, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, spheres.data(), 0,
                                   sizeof(Sphere), spheres.size());
    } else {
        rtcSetGeometryUserPrimitiveCount(geom, unsigned(spheres.size()));
        rtcSetGeometryUserData(geom, spheres.data());
        rtcSetGeometryBoundsFunction(geom, bounds, nullptr);
        rtcSetGeometryIntersectFunction(geom, intersect);
        rtcSetGeometryOccludedFunction(geom, occluded);
    }
    rtcCommitGeometry(geom);
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
    rtcAttachGeometry(scene, geom);
    rtcReleaseGeometry(geom);
    rtcCommitScene(scene);
    double build = now() - start;

    Tracer tracer{scene, points, threads};
    std::string kinds;
    for (std::string kind : {"primary", "shadow", "ambient", "incoherent"}) {
        auto rays = read_all<Ray>(dir + "/" + kind + ".f32");
        auto packets = pack(rays, kind == "primary" ? tiles(std::stoul(meta_value(meta, "width")), std::stoul(meta_value(meta, "height")))
                                                    : consecutive(rays.size()));
        std::string json;
        if (kind == "primary" || kind == "incoherent") {
            std::vector<Hit> hits;
            json = best<Hit>(
                repeat, rays.size(), hits, [&](auto& to) { return tracer.nearest_single(rays, to); },
                [&](bool coherent, auto& to) { return tracer.nearest_packets(packets, coherent, to); });
            if (!out.empty()) write_all(out + "/" + kind + ".hits", hits);
        } else {
            std::vector<uint32_t> hits;
            json = best<uint32_t>(
                repeat, rays.size(), hits, [&](auto& to) { return tracer.any_single(rays, to); },
                [&](bool coherent, auto& to) { return tracer.any_packets(packets, coherent, to); });
            if (!out.empty()) write_all(out + "/" + kind + ".hits", hits);
        }
        kinds += (kinds.empty() ? "\"" : ",\"") + kind + "\":" + json;
    }

    ssize_t version = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION);
    char name[32];
    std::snprintf(name, sizeof name, "%zd.%zd.%zd", version / 10000, version / 100 % 100, version % 100);
    std::printf("{\"peer\":\"embree%c-%s\",\"version\":\"%s\",\"scene\":\"%s\",\"threads\":%u,\"build_s\":%.6f,\"bytes\":%zu,\"kinds\":{%s}}\n",
                name[0], geometry.c_str(), name, meta_value(meta, "scene").c_str(), threads, build,
                size_t(bytes) + spheres.size() * sizeof(Sphere), kinds.c_str());
}
