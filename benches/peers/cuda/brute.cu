// Brute force in CUDA, for comparison: every camera ray against every sphere, the formula of a
// textbook in 32-bit floats.
//
// --variant plain:  one thread a pixel, spheres from global memory.
// --variant tricks: spheres in tiles of shared memory, as the cones that they fill seen from the one origin (what a
//                   camera's axes make with (C - O) / sqrt(o.o - r^2)), eight pixels of a row a thread, 16 spheres a
//                   step, two operations a test; a ray that may hit solves for t as the renderer does.
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

constexpr int TILE = 256, RAYS = 8, WIDE = 8, HIGH = 16, THREADS = WIDE * HIGH, STEP = 16, FEW = 32 / RAYS;

__device__ float dot(float3 a, float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// What the camera's axes make with the sphere's centre, in units of the distance at which rays touch it.
__device__ float4 cone(float4 s, const Camera &camera) {
    float3 o = make_float3(s.x - camera.eye.x, s.y - camera.eye.y, s.z - camera.eye.z);
    float oo = dot(o, o), rr = s.w * s.w, c = (oo - rr) - (oo + rr) / (1 << 17);
    if (!(c > 1e-30f && c < 1e30f)) return make_float4(0.0f, 0.0f, 3.4e38f, 0.0f);
    float scale = rsqrtf(c);
    return make_float4(dot(camera.right, o) * scale, dot(camera.up, o) * scale, dot(camera.forward, o) * scale, 0.0f);
}

// The first hit, by the foot of the perpendicular.
__device__ float solve(float4 s, float3 eye, float3 d) {
    float3 o = make_float3(eye.x - s.x, eye.y - s.y, eye.z - s.z);
    float a = dot(d, d), b = dot(o, d), inverse = 1.0f / a, along = b * inverse;
    float3 foot = make_float3(o.x - d.x * along, o.y - d.y * along, o.z - d.z * along);
    float rr = s.w * s.w, discriminant = rr - dot(foot, foot), c = dot(o, o) - rr;
    float size = fabsf(b) + sqrtf(a * discriminant), outer = size / a, inner = c / size;
    float near = b < 0.0f ? inner : -outer, far = b < 0.0f ? outer : -inner;
    float t = near >= 1e-30f ? near : far;
    return discriminant >= 0.0f && t >= 1e-30f ? t : 3.4e38f;
}

__global__ void tricks(Camera camera, int width, int height, int count, const float4 *spheres,
                       float4 *pixels) {
    __shared__ float4 tile[TILE];
    __shared__ float nearest[RAYS][THREADS];
    __shared__ int found[RAYS][THREADS];
    int x = blockIdx.x * WIDE * RAYS + threadIdx.x, y = blockIdx.y * HIGH + threadIdx.y;
    int thread = threadIdx.y * WIDE + threadIdx.x;
    float across[RAYS], lengths[RAYS], up = (height - 2 * y - 1) / (float)height;
#pragma unroll
    for (int ray = 0; ray < RAYS; ray++) {
        across[ray] = (2 * (x + ray * WIDE) + 1 - width) / (float)width;
        float3 d = direction(camera, x + ray * WIDE, y, width, height);
        lengths[ray] = sqrtf(dot(d, d));
        nearest[ray][thread] = 3.4e38f;
        found[ray][thread] = -1;
    }
    for (int first = 0; first < count; first += TILE) {
        __syncthreads();
        for (int i = thread; i < TILE; i += THREADS)
            tile[i] = first + i < count ? cone(spheres[first + i], camera) : make_float4(0.0f, 0.0f, 0.0f, 0.0f);
        __syncthreads();
        int last = min(TILE, count - first);
        for (int i = 0; i < last; i += STEP) {
            // As integers, of which three are compared by one instruction.
            int farthest[RAYS];
#pragma unroll
            for (int k = 0; k < STEP; k += 2) {
                float4 g = tile[i + k], h = tile[i + k + 1];
                float row_g = fmaf(up, g.y, g.z), row_h = fmaf(up, h.y, h.z);
#pragma unroll
                for (int ray = 0; ray < RAYS; ray++) {
                    int a = __float_as_int(fmaf(across[ray], g.x, row_g));
                    int b = __float_as_int(fmaf(across[ray], h.x, row_h));
                    farthest[ray] = k == 0 ? max(a, b) : max(max(farthest[ray], a), b);
                }
            }
            bool may_hit = false;
#pragma unroll
            for (int ray = 0; ray < RAYS; ray++) may_hit |= farthest[ray] >= __float_as_int(lengths[ray]);
            if (!may_hit) continue;
#pragma unroll 1
            for (int few = i; few < i + STEP; few += FEW) {
                unsigned misses = 0;
#pragma unroll
                for (int k = 0; k < FEW; k++) {
                    float4 g = tile[few + k];
                    float row = fmaf(up, g.y, g.z);
#pragma unroll
                    for (int ray = 0; ray < RAYS; ray++)
                        misses = __funnelshift_l(__float_as_uint(fmaf(across[ray], g.x, row) - lengths[ray]), misses, 1);
                }
                for (unsigned left = ~misses; left != 0;) {
                    int at = __clz(left), ray = at % RAYS, index = first + few + at / RAYS;
                    left &= ~(0x80000000u >> at);
                    float3 d = direction(camera, x + ray * WIDE, y, width, height);
                    float t = solve(spheres[index], camera.eye, d);
                    if (t < nearest[ray][thread]) nearest[ray][thread] = t, found[ray][thread] = index;
                }
            }
        }
    }
#pragma unroll
    for (int ray = 0; ray < RAYS; ray++)
        if (x + ray * WIDE < width && y < height) {
            float4 color = pixel(nearest[ray][thread]);
            color.y = (float)found[ray][thread];
            pixels[y * width + x + ray * WIDE] = color;
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
    dim3 block = with_tricks ? dim3(WIDE, HIGH) : dim3(8, 8);
    int columns = block.x * (with_tricks ? RAYS : 1);
    dim3 grid((width + columns - 1) / columns, (height + block.y - 1) / block.y);
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
