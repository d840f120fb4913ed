// Brute force in CUDA, for comparison: every camera ray against every sphere, the formula of a
// textbook in 32-bit floats.
//
//   brute DIR    reads DIR/meta.txt and DIR/spheres.f32; prints one JSON line a kernel
//
// plain:  one thread a pixel, spheres from global memory.
// tricks: spheres in tiles of shared memory, with what they share of the one origin worked out once
//         a tile (o = C - O and o.o - r^2), four pixels a thread, four spheres a step; a ray that may
//         hit one of the four solves for t.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#define CHECK(call)                                                                        \
    do {                                                                                   \
        cudaError_t error = (call);                                                        \
        if (error != cudaSuccess) {                                                        \
            std::fprintf(stderr, "%s: %s\n", #call, cudaGetErrorString(error));            \
            std::exit(1);                                                                  \
        }                                                                                  \
    } while (0)

struct Camera {
    float3 eye, forward, right, up;
};

__device__ float3 direction(const Camera &camera, int x, int y, int width, int height) {
    float u = (2 * x + 1 - width) / (float)width;
    float v = (height - 2 * y - 1) / (float)height;
    return make_float3(camera.forward.x + camera.right.x * u + camera.up.x * v,
                       camera.forward.y + camera.right.y * u + camera.up.y * v,
                       camera.forward.z + camera.right.z * u + camera.up.z * v);
}

// Each kernel writes what the renderer it is compared with writes: a colour and a depth.
__device__ float4 pixel(float t) { return make_float4(t < 1e30f, 0.0f, 0.0f, t); }

__global__ void plain(Camera camera, int width, int height, int count, const float4 *spheres,
                      float4 *pixels) {
    int x = blockIdx.x * blockDim.x + threadIdx.x, y = blockIdx.y * blockDim.y + threadIdx.y;
    if (x >= width || y >= height) return;
    float3 d = direction(camera, x, y, width, height);
    float a = d.x * d.x + d.y * d.y + d.z * d.z;
    float nearest = 3.4e38f;
    for (int i = 0; i < count; i++) {
        float4 s = spheres[i];
        float ox = camera.eye.x - s.x, oy = camera.eye.y - s.y, oz = camera.eye.z - s.z;
        float b = ox * d.x + oy * d.y + oz * d.z;
        float c = ox * ox + oy * oy + oz * oz - s.w * s.w;
        float discriminant = b * b - a * c;
        if (discriminant >= 0.0f) {
            float root = sqrtf(discriminant);
            float t = (-b - root) / a;
            if (t < 1e-30f) t = (-b + root) / a;
            if (t >= 1e-30f && t < nearest) nearest = t;
        }
    }
    pixels[y * width + x] = pixel(nearest);
}

constexpr int TILE = 256, RAYS = 4, SIDE = 8;

__device__ void solve(float4 o, float b, float a, float discriminant, float &nearest) {
    if (discriminant >= 0.0f) {
        float root = sqrtf(discriminant);
        float t = (b - root) / a;
        if (t < 1e-30f) t = (b + root) / a;
        if (t >= 1e-30f && t < nearest) nearest = t;
    }
}

__global__ void tricks(Camera camera, int width, int height, int count, const float4 *spheres,
                       float4 *pixels) {
    __shared__ float4 tile[TILE];
    int x = blockIdx.x * SIDE + threadIdx.x, y = blockIdx.y * SIDE * RAYS + threadIdx.y;
    int thread = threadIdx.y * SIDE + threadIdx.x;
    float3 d[RAYS];
    float a[RAYS], nearest[RAYS];
#pragma unroll
    for (int ray = 0; ray < RAYS; ray++) {
        d[ray] = direction(camera, x, y + ray * SIDE, width, height);
        a[ray] = d[ray].x * d[ray].x + d[ray].y * d[ray].y + d[ray].z * d[ray].z;
        nearest[ray] = 3.4e38f;
    }
    for (int first = 0; first < count; first += TILE) {
        __syncthreads();
        for (int i = thread; i < TILE; i += SIDE * SIDE) {
            float4 o = make_float4(0.0f, 0.0f, 0.0f, 3.4e38f);
            if (first + i < count) {
                float4 s = spheres[first + i];
                o = make_float4(s.x - camera.eye.x, s.y - camera.eye.y, s.z - camera.eye.z, 0.0f);
                o.w = o.x * o.x + o.y * o.y + o.z * o.z - s.w * s.w;
            }
            tile[i] = o;
        }
        __syncthreads();
        for (int i = 0; i < TILE; i += 4) {
            float4 o0 = tile[i], o1 = tile[i + 1], o2 = tile[i + 2], o3 = tile[i + 3];
#pragma unroll
            for (int ray = 0; ray < RAYS; ray++) {
                float b0 = o0.x * d[ray].x + o0.y * d[ray].y + o0.z * d[ray].z;
                float b1 = o1.x * d[ray].x + o1.y * d[ray].y + o1.z * d[ray].z;
                float b2 = o2.x * d[ray].x + o2.y * d[ray].y + o2.z * d[ray].z;
                float b3 = o3.x * d[ray].x + o3.y * d[ray].y + o3.z * d[ray].z;
                float d0 = b0 * b0 - a[ray] * o0.w, d1 = b1 * b1 - a[ray] * o1.w;
                float d2 = b2 * b2 - a[ray] * o2.w, d3 = b3 * b3 - a[ray] * o3.w;
                if (fmaxf(fmaxf(d0, d1), fmaxf(d2, d3)) >= 0.0f) {
                    solve(o0, b0, a[ray], d0, nearest[ray]);
                    solve(o1, b1, a[ray], d1, nearest[ray]);
                    solve(o2, b2, a[ray], d2, nearest[ray]);
                    solve(o3, b3, a[ray], d3, nearest[ray]);
                }
            }
        }
    }
#pragma unroll
    for (int ray = 0; ray < RAYS; ray++) {
        if (x < width && y + ray * SIDE < height)
            pixels[(y + ray * SIDE) * width + x] = pixel(nearest[ray]);
    }
}

int main(int argc, char **argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: brute DIR\n");
        return 2;
    }
    std::string dir = argv[1];
    FILE *meta = std::fopen((dir + "/meta.txt").c_str(), "r");
    int width, height, count;
    Camera camera;
    float3 *parts[] = {&camera.eye, &camera.forward, &camera.right, &camera.up};
    bool is_read = meta && std::fscanf(meta, "%d %d %d", &width, &height, &count) == 3;
    for (float3 *part : parts)
        is_read = is_read && std::fscanf(meta, "%f %f %f", &part->x, &part->y, &part->z) == 3;
    FILE *file = std::fopen((dir + "/spheres.f32").c_str(), "rb");
    std::vector<float4> world(is_read ? count : 0);
    if (!is_read || !file || std::fread(world.data(), sizeof(float4), count, file) != (size_t)count) {
        std::fprintf(stderr, "%s: meta.txt or spheres.f32 cannot be read\n", dir.c_str());
        return 1;
    }
    float4 *spheres, *pixels;
    size_t bytes = (size_t)width * height * sizeof(float4);
    CHECK(cudaMalloc(&spheres, world.size() * sizeof(float4)));
    CHECK(cudaMalloc(&pixels, bytes));
    CHECK(cudaMemcpy(spheres, world.data(), world.size() * sizeof(float4), cudaMemcpyHostToDevice));
    cudaEvent_t start, end;
    CHECK(cudaEventCreate(&start));
    CHECK(cudaEventCreate(&end));
    std::vector<float4> image((size_t)width * height);
    for (int kernel = 0; kernel < 2; kernel++) {
        std::vector<float> times;
        // The first launches bring the clock up.
        for (int round = 0; round < 27; round++) {
            CHECK(cudaEventRecord(start));
            dim3 block(SIDE, SIDE);
            int rows = SIDE * (kernel ? RAYS : 1);
            dim3 grid((width + SIDE - 1) / SIDE, (height + rows - 1) / rows);
            if (kernel)
                tricks<<<grid, block>>>(camera, width, height, count, spheres, pixels);
            else
                plain<<<grid, block>>>(camera, width, height, count, spheres, pixels);
            CHECK(cudaGetLastError());
            CHECK(cudaEventRecord(end));
            CHECK(cudaEventSynchronize(end));
            float milliseconds;
            CHECK(cudaEventElapsedTime(&milliseconds, start, end));
            if (round >= 20) times.push_back(milliseconds);
        }
        CHECK(cudaMemcpy(image.data(), pixels, bytes, cudaMemcpyDeviceToHost));
        long hits = 0;
        for (float4 &p : image) hits += p.w < 1e30f;
        std::sort(times.begin(), times.end());
        double seconds = times[times.size() / 2] * 1e-3;
        double spread = (times.back() - times.front()) * 0.5e-3 / seconds;
        double tests = (double)width * height * count;
        std::printf("{\"peer\": \"cuda-brute-%s\", \"spheres\": %d, \"hits\": %ld, \"seconds\": %g, \"spread\": %g, "
                    "\"gtests_per_s\": %.1f}\n",
                    kernel ? "tricks" : "plain", count, hits, seconds, spread, tests / seconds * 1e-9);
    }
    return 0;
}
