// Brute force in CUDA, for comparison: every camera ray against every sphere, the formula of a
// textbook in 32-bit floats.
//
// --variant plain:  one thread a pixel, spheres from global memory.
// --variant tricks: a block lists the spheres that four planes around its 32 x 32 pixels let pass, and keeps them in shared
//                   memory as the cones that they fill seen from the one origin (what a camera's axes make with
//                   (C - O) / sqrt(o.o - r^2)): eight pixels of a row a thread, four spheres a step; a ray that may hit solves for t
//                   as the renderer does.
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

constexpr int RAYS = 8, WIDE = 4, HIGH = 32, THREADS = WIDE * HIGH, TILE = THREADS, STEP = 32 / RAYS;
constexpr int LOOKS = 4, BATCH = LOOKS * THREADS, LISTED = BATCH + TILE;

__device__ float dot(float3 a, float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// What the camera's axes make with the sphere's centre, in units of the distance at which rays touch it.
__device__ float4 cone(float4 s, const Camera &camera) {
    float3 o = make_float3(s.x - camera.eye.x, s.y - camera.eye.y, s.z - camera.eye.z);
    float oo = dot(o, o), rr = s.w * s.w, c = (oo - rr) - (oo + rr) * (1.25f / (1 << 17));
    if (!(c > 1e-30f && c < 1e30f)) return make_float4(0.0f, 0.0f, 3.4e38f, 0.0f);
    float scale = rsqrtf(c);
    return make_float4(dot(camera.right, o) * scale, dot(camera.up, o) * scale, dot(camera.forward, o) * scale, 0.0f);
}

__device__ float3 cross(float3 a, float3 b) {
    return make_float3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

// The unit normal of the plane through the eye along a ray and an axis of the film, towards a direction.
__device__ float3 plane(float3 forward, float3 offset, float3 axis, float3 towards) {
    float3 n = cross(make_float3(forward.x + offset.x, forward.y + offset.y, forward.z + offset.z), axis);
    float scale = copysignf(rsqrtf(dot(n, n)), dot(n, towards));
    return make_float3(n.x * scale, n.y * scale, n.z * scale);
}

// Whether a sphere is beyond one of the planes.
__device__ bool misses(const float3 planes[4], float4 s, float3 eye) {
    float3 o = make_float3(s.x - eye.x, s.y - eye.y, s.z - eye.z);
    float oo = dot(o, o), rr = s.w * s.w;
    float farthest = fminf(fminf(dot(o, planes[0]), dot(o, planes[1])), fminf(dot(o, planes[2]), dot(o, planes[3])));
    return farthest < 0.0f && farthest * farthest > rr + (oo + rr) / (1 << 16);
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
    __shared__ float3 around[4];
    __shared__ int listed, list[LISTED];
    __shared__ float4 tile[TILE];
    __shared__ float nearest[RAYS][THREADS];
    __shared__ int found[RAYS][THREADS];
    int corner_x = blockIdx.x * WIDE * RAYS, corner_y = blockIdx.y * HIGH;
    int x = corner_x + threadIdx.x, y = corner_y + threadIdx.y;
    int thread = threadIdx.y * WIDE + threadIdx.x;
    if (thread < 4) {
        bool is_across = thread < 2;
        float3 along = is_across ? camera.right : camera.up;
        float left = film_x(corner_x, width), right = film_x(corner_x + WIDE * RAYS - 1, width);
        float below = film_y(corner_y + HIGH - 1, height), above = film_y(corner_y, height);
        float at = is_across ? (thread == 0 ? left : right) : (thread == 2 ? below : above);
        around[thread] = plane(camera.forward, times(along, at), is_across ? camera.up : camera.right,
                               times(along, thread % 2 == 0 ? 1.0f : -1.0f));
    }
    if (thread == 0) listed = 0;
    float across[RAYS], lengths[RAYS], up = film_y(y, height);
    float3 middle = make_float3(camera.forward.x + camera.up.x * up, camera.forward.y + camera.up.y * up,
                                camera.forward.z + camera.up.z * up);
    float mm = dot(middle, middle), mr = 2.0f * dot(middle, camera.right), rr = dot(camera.right, camera.right);
#pragma unroll
    for (int ray = 0; ray < RAYS; ray++) {
        float at = across[ray] = film_x(x + ray * WIDE, width);
        lengths[ray] = sqrtf(mm + at * (mr + at * rr));
        nearest[ray][thread] = 3.4e38f;
        found[ray][thread] = -1;
    }
    for (int first = 0; first < count;) {
        __syncthreads();
        float3 planes[4] = {around[0], around[1], around[2], around[3]};
        int looks = first + THREADS < count ? LOOKS : 1;
        float4 look[LOOKS];
#pragma unroll
        for (int i = 0; i < LOOKS; i++)
            if (i < looks) look[i] = spheres[min(first + thread + i * THREADS, count - 1)];
#pragma unroll
        for (int i = 0; i < LOOKS; i++) {
            int index = first + thread + i * THREADS;
            if (i < looks && index < count && !misses(planes, look[i], camera.eye)) list[atomicAdd(&listed, 1)] = index;
        }
        first += BATCH;
        __syncthreads();
        int due = listed > LISTED - BATCH || first >= count ? listed : 0;
        for (int base = 0; base < due; base += TILE) {
            if (base > 0) __syncthreads();
            int left = min(due - base, TILE);
            tile[thread] = thread < left ? cone(spheres[list[base + thread]], camera) : make_float4(0.0f, 0.0f, 0.0f, 0.0f);
            __syncthreads();
            for (int i = 0; i < left; i += STEP) {
                unsigned misses = 0;
#pragma unroll
                for (int k = 0; k < STEP; k++) {
                    float4 g = tile[i + k];
                    float row = fmaf(up, g.y, g.z);
#pragma unroll
                    for (int ray = 0; ray < RAYS; ray++) {
                        float by = fmaf(across[ray], g.x, row) - lengths[ray];
                        misses = __funnelshift_l(__float_as_uint(by), misses, 1);
                    }
                }
                for (unsigned rest = ~misses; rest != 0;) {
                    int at = __clz(rest), ray = at % RAYS, place = i + at / RAYS;
                    rest &= ~(0x80000000u >> at);
                    if (place >= left) continue;
                    int index = list[base + place];
                    float3 d = direction(camera, x + ray * WIDE, y, width, height);
                    float t = solve(spheres[index], camera.eye, d), before = nearest[ray][thread];
                    if (t < before || (t == before && index < found[ray][thread]))
                        nearest[ray][thread] = t, found[ray][thread] = index;
                }
            }
        }
        if (due && thread == 0) listed = 0;
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
    double seconds = median(arguments.repeat, [&] {
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
