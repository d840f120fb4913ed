// Shared by the CUDA peers: reading the folder that `spherule bench --export` writes, and the
// report.
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#define CHECK(call)                                                                        \
    do {                                                                                   \
        cudaError_t error = (call);                                                        \
        if (error != cudaSuccess) die(std::string(#call ": ") + cudaGetErrorString(error)); \
    } while (0)

[[noreturn]] inline void die(const std::string &why) {
    std::fprintf(stderr, "%s\n", why.c_str());
    std::exit(1);
}

struct Camera {
    float3 eye, forward, right, up;
};

__host__ __device__ inline float3 times(float3 v, float by) { return make_float3(v.x * by, v.y * by, v.z * by); }

// The position of a pixel's middle on the film: from -1 on the left to 1 on the right, and from 1 at
// the top to -1 at the bottom.
__device__ inline float film_x(int x, int width) { return (2 * x + 1 - width) / (float)width; }
__device__ inline float film_y(int y, int height) { return (height - 2 * y - 1) / (float)height; }

// The direction through a point of the film, not of unit length.
__device__ inline float3 direction(const Camera &camera, float u, float v) {
    return make_float3(camera.forward.x + camera.right.x * u + camera.up.x * v,
                       camera.forward.y + camera.right.y * u + camera.up.y * v,
                       camera.forward.z + camera.right.z * u + camera.up.z * v);
}

// The direction through a pixel's middle.
__device__ inline float3 direction(const Camera &camera, int x, int y, int width, int height) {
    return direction(camera, film_x(x, width), film_y(y, height));
}

template <class T>
std::vector<T> read_all(const std::string &path) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) die(path + " cannot be read");
    std::vector<T> values((size_t)file.tellg() / sizeof(T));
    file.seekg(0).read(reinterpret_cast<char *>(values.data()), (std::streamsize)(values.size() * sizeof(T)));
    return values;
}

template <class T>
void write_all(const std::string &path, const std::vector<T> &values) {
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char *>(values.data()), (std::streamsize)(values.size() * sizeof(T)));
    if (!file) die(path + " cannot be written");
}

template <class T>
T *upload(const std::vector<T> &values) {
    T *device;
    CHECK(cudaMalloc(&device, std::max<size_t>(values.size(), 1) * sizeof(T)));
    CHECK(cudaMemcpy(device, values.data(), values.size() * sizeof(T), cudaMemcpyHostToDevice));
    return device;
}

template <class T>
std::vector<T> download(const T *device, size_t count) {
    std::vector<T> values(count);
    CHECK(cudaMemcpy(values.data(), device, count * sizeof(T), cudaMemcpyDeviceToHost));
    return values;
}

struct Scene {
    std::string folder, name;
    int width, height;
    Camera camera;
    std::vector<float4> spheres;

    explicit Scene(const std::string &folder) : folder(folder) {
        std::ifstream file(folder + "/meta.json");
        std::string meta((std::istreambuf_iterator<char>(file)), {});
        // The numbers after a key.
        auto numbers = [&](const std::string &key) {
            size_t at = meta.find("\"" + key + "\":");
            if (at == std::string::npos) die(folder + "/meta.json has no " + key);
            at += key.size() + 3;
            float values[3] = {};
            const char *from = meta.c_str() + at + (meta[at] == '[');
            for (float &value : values) {
                char *end;
                value = std::strtof(from, &end);
                if (*end != ',') break;
                from = end + 1;
            }
            return make_float3(values[0], values[1], values[2]);
        };
        width = (int)numbers("width").x, height = (int)numbers("height").x;
        size_t at = meta.find("\"scene\":\"");
        name = at == std::string::npos ? "" : meta.substr(at + 9, meta.find('"', at + 9) - at - 9);
        float half = numbers("half_height").x;
        camera.eye = numbers("eye"), camera.forward = numbers("forward");
        camera.right = times(numbers("right"), half * (float)width / (float)height);
        camera.up = times(numbers("up"), half);
        spheres = read_all<float4>(folder + "/spheres.f32");
    }
};

// The arguments of every peer: DIR [--variant NAME] [--threads N] [--repeat N] [--hits FOLDER].
struct Arguments {
    std::string folder, variant, hits;
    int repeat = 3;

    Arguments(int argc, char **argv) {
        for (int i = 1; i < argc; i++) {
            std::string word = argv[i];
            if (word.rfind("--", 0) != 0) {
                folder = word;
                continue;
            }
            if (++i == argc) die(word + " needs a value");
            if (word == "--variant") variant = argv[i];
            else if (word == "--hits") hits = argv[i];
            else if (word == "--repeat") repeat = std::max(1, std::atoi(argv[i]));
            else if (word != "--threads") die("unknown option " + word);
        }
        if (folder.empty()) die("usage: PEER DIR [--variant NAME] [--repeat N] [--hits FOLDER]");
    }
};

// The median of `repeat` launches in seconds, after enough of them to bring the clock up.
template <class Launch>
double median(int repeat, const Launch &launch) {
    cudaEvent_t start, end;
    CHECK(cudaEventCreate(&start));
    CHECK(cudaEventCreate(&end));
    std::vector<double> times;
    double warm = 0;
    while ((int)times.size() < repeat) {
        CHECK(cudaEventRecord(start));
        launch();
        CHECK(cudaGetLastError());
        CHECK(cudaEventRecord(end));
        CHECK(cudaEventSynchronize(end));
        float milliseconds;
        CHECK(cudaEventElapsedTime(&milliseconds, start, end));
        if (warm > 1.0) times.push_back(milliseconds * 1e-3);
        warm += milliseconds * 1e-3;
    }
    std::sort(times.begin(), times.end());
    return times[times.size() / 2];
}

inline std::string kind_line(const std::string &kind, double seconds, size_t hits) {
    std::ostringstream line;
    line << "\"" << kind << "\":{\"seconds\":" << seconds << ",\"hits\":" << hits << "}";
    return line.str();
}

inline void report(const std::string &peer, const Scene &scene, size_t bytes, const std::string &kinds) {
    cudaDeviceProp device;
    int version;
    CHECK(cudaGetDeviceProperties(&device, 0));
    CHECK(cudaRuntimeGetVersion(&version));
    std::printf("{\"peer\":\"%s\",\"version\":\"CUDA %d.%d, %s\",\"scene\":\"%s\",\"bytes\":%zu,\"kinds\":{%s}}\n",
                peer.c_str(), version / 1000, version % 1000 / 10, device.name, scene.name.c_str(), bytes,
                kinds.c_str());
}
