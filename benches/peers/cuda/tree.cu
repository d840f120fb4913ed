// spherule's walk through its tree of boxes in CUDA, for comparison: the same nodes, in the same order,
// with the same bounds and the same formula for a sphere (kernel/src/tree.rs, kernel/src/precision/robust.rs).
// What differs is the language and its compiler.
#include "scene.h"

struct Ray {
    float3 origin;
    float t_min;
    float3 direction;
    float t_max;
};

struct Hit {
    float t;
    uint32_t sphere;
};

struct Node {
    uint4 grid, links, low_xy, low_z_high_x, high_yz;
};

constexpr float U = 1.0f / (1 << 24), NONE_T = 3.402823466e38f;
constexpr uint32_t NONE = 0xffffffff, ROOT = 1;
constexpr int MAX_DEPTH = 20;

__device__ float3 operator+(float3 a, float3 b) { return make_float3(a.x + b.x, a.y + b.y, a.z + b.z); }
__device__ float3 operator-(float3 a, float3 b) { return make_float3(a.x - b.x, a.y - b.y, a.z - b.z); }
__device__ float3 operator*(float3 a, float3 b) { return make_float3(a.x * b.x, a.y * b.y, a.z * b.z); }
__device__ float3 operator*(float3 a, float b) { return make_float3(a.x * b, a.y * b, a.z * b); }
__device__ float dot(float3 a, float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
__device__ float3 abs3(float3 a) { return make_float3(fabsf(a.x), fabsf(a.y), fabsf(a.z)); }
__device__ float3 corner(uint4 bits) {
    return make_float3(__uint_as_float(bits.x), __uint_as_float(bits.y), __uint_as_float(bits.z));
}

__device__ float reciprocal(float x) {
    const float largest = 18446744073709551616.0f;  // 2^64
    if (fabsf(x) > 1.0f / largest) return 1.0f / x;
    return x < 0.0f ? -largest : largest;
}

__device__ float choose(float near, float far, const Ray &ray) {
    float t = NONE_T;
    if (far >= ray.t_min && far < ray.t_max) t = far;
    if (near >= ray.t_min && near < ray.t_max) t = near;
    return t;
}

__device__ float robust(float4 s, const Ray &ray) {
    float3 o = ray.origin - make_float3(s.x, s.y, s.z), d = ray.direction;
    float a = dot(d, d), b = dot(o, d);
    float inverse = 1.0f / a;
    float3 foot = o - d * (b * inverse);
    float rr = s.w * s.w;
    float discriminant = rr - dot(foot, foot);
    if (!(discriminant >= 0.0f)) return NONE_T;
    float c = dot(o, o) - rr;
    float size = fabsf(b) + sqrtf(a * discriminant);
    if (size > NONE_T) return NONE_T;
    float outer = size / a, inner = size > 0.0f ? c / size : 0.0f;
    return b < 0.0f ? choose(inner, outer, ray) : choose(-outer, -inner, ray);
}

struct Slabs {
    float3 origin, inverse, widening;
    float unit, start;
    uint32_t octant;

    __device__ Slabs(const Ray &ray, const Node *nodes) : origin(ray.origin) {
        float3 d = ray.direction;
        float largest = fmaxf(fmaxf(fabsf(d.x), fabsf(d.y)), fmaxf(fabsf(d.z), 1.17549435e-38f));
        uint32_t exponent = __float_as_uint(largest) & 0x7f800000;
        unit = __uint_as_float(exponent);
        d = d * __uint_as_float(0x7f000000 - exponent);
        inverse = make_float3(reciprocal(d.x), reciprocal(d.y), reciprocal(d.z));
        float3 low = abs3(corner(nodes[0].grid) - origin), high = abs3(corner(nodes[0].links) - origin);
        float distance = fmaxf(low.x, high.x) + fmaxf(low.y, high.y) + fmaxf(low.z, high.z);
        widening = abs3(inverse) * (distance * (32.0f * U));
        start = ray.t_min * unit;
        octant = (d.x < 0.0f ? 0 : 1) | (d.y < 0.0f ? 0 : 2) | (d.z < 0.0f ? 0 : 4);
    }

    __device__ uint32_t meets(const Node &node, float end) const {
        uint32_t exponents = node.grid.w;
        float3 step = make_float3(__uint_as_float((exponents & 0xff) << 23),
                                  __uint_as_float((exponents & 0xff00) << 15),
                                  __uint_as_float((exponents & 0xff0000) << 7)) *
                      inverse;
        float3 offset = (corner(node.grid) - origin) * inverse;
        float3 slack = (abs3(offset) + abs3(step) * 256.0f) * (16.0f * U) + widening;
        float3 near = offset - slack, far = offset + slack;
        end += fabsf(end) * (16.0f * U);
        uint2 near_x = make_uint2(node.low_xy.x, node.low_xy.y), near_y = make_uint2(node.low_xy.z, node.low_xy.w);
        uint2 near_z = make_uint2(node.low_z_high_x.x, node.low_z_high_x.y);
        uint2 far_x = make_uint2(node.low_z_high_x.z, node.low_z_high_x.w);
        uint2 far_y = make_uint2(node.high_yz.x, node.high_yz.y), far_z = make_uint2(node.high_yz.z, node.high_yz.w);
        auto swap = [](uint2 &a, uint2 &b) { uint2 c = a; a = b; b = c; };
        if (inverse.x < 0.0f) swap(near_x, far_x);
        if (inverse.y < 0.0f) swap(near_y, far_y);
        if (inverse.z < 0.0f) swap(near_z, far_z);
        uint32_t met = 0;
#pragma unroll
        for (int child = 0; child < 8; child++) {
            auto plane = [&](uint2 bytes, float step, float first) {
                uint32_t word = child < 4 ? bytes.x : bytes.y;
                return (float)((word >> (child % 4 * 8)) & 0xff) * step + first;
            };
            float first = fmaxf(fmaxf(plane(near_x, step.x, near.x), plane(near_y, step.y, near.y)),
                                fmaxf(plane(near_z, step.z, near.z), start));
            float last = fminf(fminf(plane(far_x, step.x, far.x), plane(far_y, step.y, far.y)),
                               fminf(plane(far_z, step.z, far.z), end));
            met |= (first <= last ? 1u : 0u) << child;
        }
        return met;
    }

    __device__ uint32_t in_order(uint32_t bits) const {
        if (octant & 1) bits = ((bits & 0x55) << 1) | ((bits >> 1) & 0x55);
        if (octant & 2) bits = ((bits & 0x33) << 2) | ((bits >> 2) & 0x33);
        if (octant & 4) bits = ((bits & 0x0f) << 4) | (bits >> 4);
        return bits;
    }
};

__device__ uint32_t sum_of_nibbles(uint32_t nibbles) {
    return ((nibbles & 0x0f0f0f0f) + ((nibbles >> 4) & 0x0f0f0f0f)) * 0x01010101 >> 24;
}

template <bool ANY>
__device__ Hit walk(Ray ray, const Node *__restrict__ nodes, const float4 *__restrict__ spheres) {
    Slabs slabs(ray, nodes);
    float end = ray.t_max * slabs.unit;
    Hit hit = {NONE_T, NONE};
    uint2 stack[MAX_DEPTH];
    int height = 0;
    uint32_t first = ROOT, group = 0x80000000;
    for (;;) {
        int bit = 31 - __clz(group);
        group ^= 1u << bit;
        if (group > 0xffffff) stack[height++] = make_uint2(first, group);
        uint32_t place = (uint32_t)(bit - 24) ^ slabs.octant;
        const Node node = nodes[first + __popc(group & 0xff & ((1u << place) - 1))];
        uint32_t met = slabs.meets(node, end), inner = node.grid.w >> 24, counts = node.links.z;
        for (uint32_t leaves = met & ~inner; leaves; leaves &= leaves - 1) {
            int child = __ffs(leaves) - 1;
            uint32_t index = node.links.y + sum_of_nibbles(counts & ((1u << (4 * child)) - 1));
            uint32_t last = index + ((counts >> (4 * child)) & 15);
            for (; index < last; index++) {
                float t = robust(spheres[index], ray);
                if (t < ray.t_max) {
                    if (ANY) return {t, index};
                    if (t < hit.t || index < hit.sphere) hit = {t, index};
                    ray.t_max = nextafterf(t, NONE_T);
                    end = ray.t_max * slabs.unit;
                }
            }
        }
        first = node.links.x;
        group = slabs.in_order(met & inner) << 24 | inner;
        if ((met & inner) == 0) {
            if (height == 0) return hit;
            uint2 next = stack[--height];
            first = next.x, group = next.y;
        }
    }
}

// A colour's room and a depth's, as the renderer writes them; the first two hold the hit.
__global__ void primary(Camera camera, int width, int height, const Node *nodes, const float4 *spheres,
                        float4 *pixels) {
    int x = blockIdx.x * blockDim.x + threadIdx.x, y = blockIdx.y * blockDim.y + threadIdx.y;
    if (x >= width || y >= height) return;
    Ray ray = {camera.eye, 1.17549435e-38f, direction(camera, x, y, width, height), NONE_T};
    Hit hit = walk<false>(ray, nodes, spheres);
    pixels[y * width + x] = make_float4(hit.t, __uint_as_float(hit.sphere), 0.0f, hit.t);
}

template <bool ANY>
__global__ void each(size_t count, const Ray *rays, const Node *nodes, const float4 *spheres, Hit *hits) {
    size_t index = (size_t)blockIdx.x * blockDim.x + threadIdx.x;
    if (index < count) hits[index] = walk<ANY>(rays[index], nodes, spheres);
}

int main(int argc, char **argv) {
    Arguments arguments(argc, argv);
    Scene scene(arguments.folder);
    auto nodes_of = read_all<Node>(scene.folder + "/nodes.u32");
    auto order = read_all<uint32_t>(scene.folder + "/order.u32");
    if (nodes_of.size() < 2 || order.size() != scene.spheres.size()) die("the scene was exported without a tree");
    std::vector<float4> sorted;
    for (uint32_t index : order) sorted.push_back(scene.spheres[index]);
    Node *nodes = upload(nodes_of);
    float4 *spheres = upload(sorted);
    std::string kinds;
    for (std::string kind : {"primary", "shadow", "ambient", "incoherent"}) {
        bool is_primary = kind == "primary", any = kind == "shadow" || kind == "ambient";
        auto given = is_primary ? std::vector<Ray>() : read_all<Ray>(scene.folder + "/" + kind + ".f32");
        size_t count = is_primary ? (size_t)scene.width * scene.height : given.size();
        Ray *rays = upload(given);
        Hit *hits = upload(std::vector<Hit>(is_primary ? 0 : count));
        float4 *pixels = upload(std::vector<float4>(is_primary ? count : 0));
        dim3 block(8, 8), grid((scene.width + 7) / 8, (scene.height + 7) / 8);
        unsigned groups = (unsigned)((count + 63) / 64);
        double seconds = fastest(arguments.repeat, [&] {
            if (is_primary) primary<<<grid, block>>>(scene.camera, scene.width, scene.height, nodes, spheres, pixels);
            else if (any) each<true><<<groups, 64>>>(count, rays, nodes, spheres, hits);
            else each<false><<<groups, 64>>>(count, rays, nodes, spheres, hits);
        });
        std::vector<Hit> found;
        if (is_primary)
            for (float4 p : download(pixels, count)) {
                Hit hit = {p.x, 0};
                std::memcpy(&hit.sphere, &p.y, sizeof hit.sphere);
                found.push_back(hit);
            }
        else found = download(hits, count);
        size_t number = 0;
        std::vector<uint32_t> bits;
        for (Hit &hit : found) {
            bool is_hit = hit.sphere != NONE;
            number += is_hit;
            bits.push_back(is_hit);
            if (is_hit) hit.sphere = order[hit.sphere];
        }
        std::string path = arguments.hits + "/" + kind + ".hits";
        if (!arguments.hits.empty() && any) write_all(path, bits);
        else if (!arguments.hits.empty()) write_all(path, found);
        kinds += (kinds.empty() ? "" : ",") + kind_line(kind, seconds, number);
        CHECK(cudaFree(rays));
        CHECK(cudaFree(hits));
        CHECK(cudaFree(pixels));
    }
    size_t bytes = nodes_of.size() * sizeof(Node) + sorted.size() * sizeof(float4);
    report("cuda-tree", scene, bytes, kinds);
}
