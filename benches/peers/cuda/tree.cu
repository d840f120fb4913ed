// spherule's walk through its tree of boxes in CUDA, for comparison: the same nodes, in the same
// order, with the same bounds and the same formula for a sphere (kernel/src/accel/walk.rs,
// kernel/src/precision/robust.rs). The differences are the language and its compiler, and that
// spheres are tested one at a time for the nearest hit: two at a time, as in spherule, is slower
// here, and so is the formula without its branch.
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
    uint4 sides[6], corner, links;
};

constexpr float U = 1.0f / (1 << 24), NONE_T = 3.402823466e38f;
constexpr uint32_t NONE = 0xffffffff, ROOT = 1, FIRST_OF_FOUR = 0x11111111;
constexpr int MAX_DEPTH = 20;

__device__ float3 operator+(float3 a, float3 b) { return make_float3(a.x + b.x, a.y + b.y, a.z + b.z); }
__device__ float3 operator-(float3 a, float3 b) { return make_float3(a.x - b.x, a.y - b.y, a.z - b.z); }
__device__ float3 operator*(float3 a, float3 b) { return make_float3(a.x * b.x, a.y * b.y, a.z * b.z); }
__device__ float3 operator*(float3 a, float b) { return make_float3(a.x * b, a.y * b, a.z * b); }
__device__ float dot(float3 a, float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
__device__ float3 abs3(float3 a) { return make_float3(fabsf(a.x), fabsf(a.y), fabsf(a.z)); }
__device__ float3 point(uint4 bits) {
    return make_float3(__uint_as_float(bits.x), __uint_as_float(bits.y), __uint_as_float(bits.z));
}

__device__ float reciprocal(float x) {
    const float largest = 18446744073709551616.0f;  // 2^64
    if (fabsf(x) > 1.0f / largest) return 1.0f / x;
    return x < 0.0f ? -largest : largest;
}

__device__ float power_of_two_under(float3 d) {
    float largest = fmaxf(fmaxf(fabsf(d.x), fabsf(d.y)), fmaxf(fabsf(d.z), 1.17549435e-38f));
    return __uint_as_float(0x7f000000 - (__float_as_uint(largest) & 0x7f800000));
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
    float outer = size / a, inner = c / size;
    float near = b < 0.0f ? inner : -outer, far = b < 0.0f ? outer : -inner;
    float t = near >= ray.t_min ? near : far;
    bool hits = discriminant >= 0.0f && size <= NONE_T && t >= ray.t_min && t < ray.t_max;
    return hits ? t : NONE_T;
}

// Whether any rung may find a hit.
struct Line {
    float3 origin, direction;
    float a;

    __device__ explicit Line(const Ray &ray) : origin(ray.origin) {
        direction = ray.direction * power_of_two_under(ray.direction);
        a = dot(direction, direction);
    }

    __device__ bool may_hit(float4 s) const {
        float3 o = make_float3(s.x, s.y, s.z) - origin;
        float oo = dot(o, o), rr = s.w * s.w, b = dot(o, direction);
        return !(b * b - a * ((oo - rr) - 64.0f * U * (oo + rr)) < -1e-36f);
    }
};

struct Slabs {
    float3 inverse, near, far;
    uint3 near_rows;
    float unit, start;
    uint32_t octant;

    __device__ Slabs(const Ray &ray, const Node *nodes) {
        float scale = power_of_two_under(ray.direction);
        unit = __uint_as_float(0x7f000000 - __float_as_uint(scale));
        float3 d = ray.direction * scale, origin = ray.origin;
        inverse = make_float3(reciprocal(d.x), reciprocal(d.y), reciprocal(d.z));
        float3 low = point(nodes[0].corner), high = point(nodes[0].links);
        float3 below = abs3(low - origin), above = abs3(high - origin);
        float distance = fmaxf(below.x, above.x) + fmaxf(below.y, above.y) + fmaxf(below.z, above.z);
        low = abs3(low), below = abs3(high);
        float3 size = make_float3(fmaxf(low.x, below.x), fmaxf(low.y, below.y), fmaxf(low.z, below.z));
        size = size + abs3(origin) + (high - point(nodes[0].corner)) * 2.0f;
        float wider = distance * (32.0f * U);
        start = ray.t_min * unit;
        float later = fabsf(start) * (16.0f * U);
        float3 slack = (size * (16.0f * U) + make_float3(wider, wider, wider)) * abs3(inverse);
        slack = slack + make_float3(later, later, later);
        float3 first = origin * inverse * -1.0f - make_float3(start, start, start);
        near = first - slack, far = first + slack;
        near_rows = make_uint3(d.x < 0.0f ? 3 : 0, d.y < 0.0f ? 4 : 1, d.z < 0.0f ? 5 : 2);
        octant = (d.x < 0.0f ? 0 : 4) | (d.y < 0.0f ? 0 : 8) | (d.z < 0.0f ? 0 : 16);
    }

    // Bit 4c where the ray may meet child c before `end`.
    __device__ uint32_t meets(float3 corner, const uint4 *sides, float end) const {
        float3 near = corner * inverse + this->near, far = corner * inverse + this->far;
        end += fabsf(end) * (16.0f * U);
        uint4 rows[6] = {sides[near_rows.x],     sides[near_rows.y],     sides[near_rows.z],
                         sides[3 - near_rows.x], sides[5 - near_rows.y], sides[7 - near_rows.z]};
        uint32_t gaps = 0;
#pragma unroll
        for (int child = 7; child >= 0; child--) {
            auto side = [&](const uint4 &row) {
                uint32_t word = child % 4 == 0 ? row.x : child % 4 == 1 ? row.y : child % 4 == 2 ? row.z : row.w;
                return __uint_as_float(child < 4 ? word << 16 : word);
            };
            auto bits = [](float x) { return __float_as_int(x); };
            int first = max(max(bits(side(rows[0]) * inverse.x + near.x), bits(side(rows[1]) * inverse.y + near.y)),
                            max(bits(side(rows[2]) * inverse.z + near.z), 0));
            int last = min(min(bits(side(rows[3]) * inverse.x + far.x), bits(side(rows[4]) * inverse.y + far.y)),
                           min(bits(side(rows[5]) * inverse.z + far.z), bits(end)));
            float gap = __int_as_float(last) - __int_as_float(first);
            gaps = gaps << 4 | __float_as_uint(gap) >> 28;
        }
        return ~gaps >> 3 & FIRST_OF_FOUR;
    }

    __device__ uint32_t in_order(uint32_t bits) const {
        if (octant & 4) bits = ((bits & 0x01010101) << 4) | ((bits >> 4) & 0x01010101);
        if (octant & 8) bits = ((bits & 0x00110011) << 8) | ((bits >> 8) & 0x00110011);
        if (octant & 16) bits = bits << 16 | bits >> 16;
        return bits;
    }
};

template <bool ANY>
__device__ Hit walk(Ray ray, const Node *__restrict__ nodes, const float4 *__restrict__ spheres) {
    Slabs slabs(ray, nodes);
    Line line(ray);
    float nearest = ray.t_max;
    uint32_t hit = 0;
    uint2 stack[MAX_DEPTH + 1];
    stack[0] = make_uint2(0, 0);
    int height = 1;
    uint32_t first = ROOT, group = 0x10000000;
    do {
        int bit = 31 - __clz(group & FIRST_OF_FOUR);
        group ^= 1u << bit;
        if (group & FIRST_OF_FOUR) stack[height++] = make_uint2(first, group);
        uint32_t before = group & ~FIRST_OF_FOUR & ((1u << (bit ^ slabs.octant)) - 1);
        const Node &node = nodes[first + __popc(before)];
        const uint4 corner = node.corner, links = node.links;
        float end = nearest * slabs.unit - slabs.start;
        uint32_t met = slabs.meets(point(corner), node.sides, end), inner = corner.w;
        uint32_t candidates = (met * 15) & links.z;
        met &= inner >> 1;
        // The index of the lowest bit's sphere, which is removed if there are others.
        auto take = [&](uint32_t &bits, int &bit) {
            bit = __ffs(bits) - 1;
            uint32_t rest = bits & (bits - 1);
            if (rest) bits = rest;
            return links.y + __popc(links.z & ((1u << bit) - 1));
        };
        auto ask = [&](uint32_t index, float t) {
            if (t < nearest || (t == nearest && index < hit)) nearest = t, hit = index;
        };
        if (ANY) {
            uint32_t leaves = candidates;
            candidates = 0;
            while (leaves) {
                int one, two;
                uint32_t rest = leaves & (leaves - 1);
                float4 first = spheres[take(leaves, one)], second = spheres[take(leaves, two)];
                leaves = rest & (rest - 1);
                candidates |= (uint32_t)line.may_hit(first) << one | (uint32_t)line.may_hit(second) << two;
            }
            while (candidates && nearest == ray.t_max) {
                int one;
                uint32_t rest = candidates & (candidates - 1), index = take(candidates, one);
                candidates = rest;
                ask(index, robust(spheres[index], ray));
            }
            if (nearest < ray.t_max) met = 0, height = 1;
        } else {
            while (candidates) {
                int one;
                uint32_t rest = candidates & (candidates - 1), index = take(candidates, one);
                candidates = rest;
                ask(index, robust(spheres[index], ray));
            }
        }
        first = links.x;
        group = slabs.in_order(met) | inner;
        if (met == 0) {
            uint2 next = stack[--height];
            first = next.x, group = next.y;
        }
    } while (group & FIRST_OF_FOUR);
    return nearest < ray.t_max ? Hit{nearest, hit} : Hit{NONE_T, NONE};
}

// Room for a colour and a depth, as the renderer writes them; the first two numbers hold the hit.
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
        double seconds = median(arguments.repeat, [&] {
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
