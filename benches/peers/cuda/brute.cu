// Brute force in CUDA, for comparison: every camera ray against every sphere, the formula of a
// textbook in 32-bit floats.
//
// --variant plain:  one thread a pixel, spheres from global memory.
// --variant tricks: spheres in tiles of shared memory, with what they share of the one origin worked out
//                   once a tile (o = C - O and o.o - r^2), directions of unit length, four pixels a thread,
//                   eight spheres a step; a ray that may hit one of the eight solves for t.
#include "scene.h"

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

constexpr int TILE = 256, RAYS = 4, SIDE = 8, STEP = 8;

// With d of unit length.
__device__ void solve(float b, float discriminant, float &nearest) {
    if (discriminant >= 0.0f) {
        float root = sqrtf(discriminant);
        float t = b - root;
        if (t < 1e-30f) t = b + root;
        if (t >= 1e-30f && t < nearest) nearest = t;
    }
}

__global__ void tricks(Camera camera, int width, int height, int count, const float4 *spheres,
                       float4 *pixels) {
    __shared__ float4 tile[TILE];
    int x = blockIdx.x * SIDE + threadIdx.x, y = blockIdx.y * SIDE * RAYS + threadIdx.y;
    int thread = threadIdx.y * SIDE + threadIdx.x;
    float3 d[RAYS];
    float inverse[RAYS], nearest[RAYS];
#pragma unroll
    for (int ray = 0; ray < RAYS; ray++) {
        d[ray] = direction(camera, x, y + ray * SIDE, width, height);
        inverse[ray] = rsqrtf(d[ray].x * d[ray].x + d[ray].y * d[ray].y + d[ray].z * d[ray].z);
        d[ray] = make_float3(d[ray].x * inverse[ray], d[ray].y * inverse[ray], d[ray].z * inverse[ray]);
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
        int last = min(TILE, count - first);
        for (int i = 0; i < last; i += STEP) {
            float4 o[STEP];
#pragma unroll
            for (int k = 0; k < STEP; k++) o[k] = tile[i + k];
#pragma unroll
            for (int ray = 0; ray < RAYS; ray++) {
                float b[STEP], discriminant[STEP], largest = -1.0f;
#pragma unroll
                for (int k = 0; k < STEP; k++) {
                    b[k] = o[k].x * d[ray].x + o[k].y * d[ray].y + o[k].z * d[ray].z;
                    discriminant[k] = b[k] * b[k] - o[k].w;
                    largest = fmaxf(largest, discriminant[k]);
                }
                if (largest >= 0.0f) {
#pragma unroll
                    for (int k = 0; k < STEP; k++) solve(b[k], discriminant[k], nearest[ray]);
                }
            }
        }
    }
#pragma unroll
    for (int ray = 0; ray < RAYS; ray++) {
        bool is_hit = nearest[ray] < 1e30f;
        if (x < width && y + ray * SIDE < height)
            pixels[(y + ray * SIDE) * width + x] = pixel(is_hit ? nearest[ray] * inverse[ray] : nearest[ray]);
    }
}

int main(int argc, char **argv) {
    Arguments arguments(argc, argv);
    bool with_tricks = arguments.variant == "tricks";
    if (!with_tricks && arguments.variant != "plain") die("--variant is plain or tricks");
    Scene scene(arguments.folder);
    if (scene.spheres.size() > 100000) die("brute force is not tried on more than 100,000 spheres");
    int width = scene.width, height = scene.height, count = (int)scene.spheres.size();
    float4 *spheres = upload(scene.spheres);
    float4 *pixels = upload(std::vector<float4>((size_t)width * height));
    dim3 block(SIDE, SIDE);
    int rows = SIDE * (with_tricks ? RAYS : 1);
    dim3 grid((width + SIDE - 1) / SIDE, (height + rows - 1) / rows);
    double seconds = fastest(arguments.repeat, [&] {
        if (with_tricks) tricks<<<grid, block>>>(scene.camera, width, height, count, spheres, pixels);
        else plain<<<grid, block>>>(scene.camera, width, height, count, spheres, pixels);
    });
    std::vector<uint32_t> mask;
    size_t hits = 0;
    for (float4 p : download(pixels, (size_t)width * height)) {
        mask.push_back(p.w < 1e30f);
        hits += mask.back();
    }
    if (!arguments.hits.empty()) write_all(arguments.hits + "/primary.mask", mask);
    report("cuda-brute-" + arguments.variant, scene, scene.spheres.size() * sizeof(float4),
           kind_line("primary", seconds, hits));
}
