// Brute force in CUDA, for comparison: every camera ray is tested with every sphere, by the
// textbook formula in 32-bit floats.
//
// --variant plain:  one thread a pixel, spheres from global memory.
// --variant tricks: a block culls spheres with four planes around its 32 x 32 pixels, and lists
//                   the rest in shared memory, with the cones that they fill seen from the common
//                   origin ((C - O) / sqrt(o.o - r^2)). For each pixel a thread tests cones with
//                   three multiply-adds and a difference, four between two branches. After up to
//                   32, it solves for t, as the renderer does, for the spheres that the ray may
//                   hit. Blocks start with the middle rows.
#include "scene.h"

// Each kernel writes what the renderer writes: a colour and a depth.
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

constexpr int WIDE = 8, HIGH = 32, THREADS = WIDE * HIGH, SIDE = 32, ROWS = THREADS / SIDE, STEP = 4, BITS = 32;
constexpr int LISTED = 256, BATCH = 1 << 14, SMALL_BATCH = LISTED / 2;

__device__ float dot(float3 a, float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// The vector to the sphere's centre, in units of the distance at which rays touch it; and an offset
// for spheres that every ray meets.
__device__ float4 cone(float4 s, float3 eye) {
    float3 o = make_float3(s.x - eye.x, s.y - eye.y, s.z - eye.z);
    float oo = dot(o, o), rr = s.w * s.w, c = (oo - rr) - (oo + rr) * (1.0f / (1 << 18));
    if (!(c > 1e-30f && c < 1e30f)) return make_float4(0.0f, 0.0f, 0.0f, 3.4e38f);
    float scale = rsqrtf(c);
    return make_float4(o.x * scale, o.y * scale, o.z * scale, 0.0f);
}

__device__ float3 cross(float3 a, float3 b) {
    return make_float3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

// The unit normal of the plane through the eye along a ray and an axis of the film, towards a
// direction.
__device__ float3 plane(float3 forward, float3 offset, float3 axis, float3 towards) {
    float3 n = cross(make_float3(forward.x + offset.x, forward.y + offset.y, forward.z + offset.z), axis);
    float scale = copysignf(rsqrtf(dot(n, n)), dot(n, towards));
    return make_float3(n.x * scale, n.y * scale, n.z * scale);
}

// Whether a sphere is entirely outside one of the planes.
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

// Shifts in a bit for each of a step's cones: whether the ray misses it.
__device__ unsigned step(unsigned misses, const float4 *cones, float3 d, float length) {
#pragma unroll
    for (int k = 0; k < STEP; k++) {
        float4 h = cones[k];
        float by = fmaf(d.x, h.x, fmaf(d.y, h.y, fmaf(d.z, h.z, h.w))) - length;
        misses = __funnelshift_l(__float_as_uint(by), misses, 1);
    }
    return misses;
}

__global__ void tricks(Camera camera, int width, int height, int count, const float4 *spheres,
                       float4 *pixels) {
    __shared__ float3 around[4];
    __shared__ float rows[SIDE];
    __shared__ int listed, list[LISTED];
    __shared__ float4 near_by[LISTED], cones[LISTED];
    int middle = gridDim.y / 2, away = (blockIdx.y + 1) / 2;
    int corner_x = blockIdx.x * SIDE, corner_y = (blockIdx.y % 2 == 1 ? middle - away : middle + away) * SIDE;
    int thread = threadIdx.y * WIDE + threadIdx.x, warp = thread / 32;
    int x = corner_x + warp % 4 * WIDE + threadIdx.x, y = corner_y + warp / 4 * 4 + threadIdx.y % 4;
    if (thread < 4) {
        bool is_across = thread < 2;
        float3 along = is_across ? camera.right : camera.up;
        float left = film_x(corner_x, width), right = film_x(corner_x + SIDE - 1, width);
        float below = film_y(corner_y + SIDE - 1, height), above = film_y(corner_y, height);
        float at = is_across ? (thread == 0 ? left : right) : (thread == 2 ? below : above);
        around[thread] = plane(camera.forward, times(along, at), is_across ? camera.up : camera.right,
                               times(along, thread % 2 == 0 ? 1.0f : -1.0f));
    }
    if (thread < SIDE) rows[thread] = film_y(corner_y + thread, height);
    float across = film_x(x, width);
    if (thread == 0) listed = 0;
    bool is_continued = false;
    for (int first = 0, before = 0, batch = BATCH; first < count || !is_continued;) {
        __syncthreads();
        float3 planes[4] = {around[0], around[1], around[2], around[3]};
        int stop = min(first + batch, count);
        for (int mine = first + thread; mine < stop; mine += 2 * THREADS) {
            float4 look[2] = {spheres[mine], spheres[min(mine + THREADS, stop - 1)]};
#pragma unroll
            for (int i = 0; i < 2; i++) {
                int index = mine + i * THREADS;
                if (index >= stop || misses(planes, look[i], camera.eye)) continue;
                int place = atomicAdd(&listed, 1);
                if (place < LISTED) list[place] = index;
            }
        }
        __syncthreads();
        int due = listed;
        bool is_due = true;
        if (due > LISTED) {
            due = before, batch = max(SMALL_BATCH, batch / 4);
        } else {
            first = stop, before = due, batch = min(BATCH, batch * 2);
            is_due = due > LISTED - SMALL_BATCH || first >= count;
        }
        if (!is_due) continue;
        int padded = (due + STEP - 1) / STEP * STEP;
        for (int i = thread; i < padded; i += THREADS) {
            cones[i] = make_float4(0.0f, 0.0f, 0.0f, -3.4e38f);
            if (i >= due) continue;
            near_by[i] = spheres[list[i]];
            cones[i] = cone(near_by[i], camera.eye);
        }
        __syncthreads();
        if (thread == 0) listed = 0;
        before = 0;
#pragma unroll 1
        for (int row = y; row < corner_y + SIDE; row += ROWS) {
            if (x >= width || row >= height) continue;
            float4 *own = pixels + row * width + x;
            if (due == 0) {
                if (!is_continued) *own = pixel(3.4e38f);
                continue;
            }
            float3 d = direction(camera, across, rows[row - corner_y]);
            float length = sqrtf(dot(d, d)), end = is_continued ? own->w : 3.4e38f, nearest = end;
            int found = -1;
#pragma unroll 1
            for (int base = 0; base < due; base += BITS) {
                int until = min(padded, base + BITS);
                unsigned misses = step(~0u, cones + base, d, length);
#pragma unroll 1
                for (int i = base + STEP; i < until; i += STEP) misses = step(misses, cones + i, d, length);
                for (unsigned rest = ~misses; rest != 0;) {
                    int bit = 31 - __clz(rest), place = until - 1 - bit, index = list[place];
                    rest ^= 1u << bit;
                    float t = solve(near_by[place], camera.eye, d);
                    if (t < nearest || (t == nearest && index < found)) nearest = t, found = index;
                }
            }
            if (is_continued && !(nearest < end)) continue;
            float4 color = pixel(nearest);
            color.y = (float)found;
            *own = color;
        }
        is_continued = true;
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
    int side = with_tricks ? SIDE : 8;
    dim3 grid((width + side - 1) / side, (height + side - 1) / side);
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
