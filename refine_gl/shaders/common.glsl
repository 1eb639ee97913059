// Shared by all passes: the buffers, and arithmetic that rounds like the arithmetic of refine/.
//
// Eight storage buffers, as many as OpenGL 4.3 promises; no pass takes more than six. Arrays lie in
// them one after another: `faces(k)` is a macro made by tables.py for `mesh[faces_at + (k)]`.
// `precise` forbids fused and reordered sums, so sums equal those of the processor.

layout(local_size_x = GROUP) in;
layout(std430, binding = 0) readonly buffer Mesh { uint mesh[]; };  // once per mesh
layout(std430, binding = 1) readonly buffer Positions { double positions[]; };  // once per frame
layout(std430, binding = 2) buffer Fields { vec4 fields[]; };  // vectors that passes share
layout(std430, binding = 3) buffer Work { uint work[]; };  // numbers that passes share
layout(std430, binding = 4) buffer Rows { float rows[]; };  // the output
layout(std430, binding = 5) writeonly buffer Triangles { uint triangles[]; };
layout(std430, binding = 6) writeonly buffer Source { uint source[]; };
layout(std430, binding = 7) buffer Command { uint command[]; };  // the numbers of vertices and triangles

const uint NONE = 0xffffffffu;

// The work of the first `count` threads, one element each: FOR_EACH(v, vertex_count) { ... }
#define FOR_EACH(k, count) \
    void each(uint k); \
    void main() { if (gl_GlobalInvocationID.x < count) each(gl_GlobalInvocationID.x); } \
    void each(uint k)

shared uint sums[GROUP];

// The sum of the values of this thread and those before it in its group (Hillis and Steele 1986).
uint inclusive_sum(uint value) {
    uint k = gl_LocalInvocationIndex;
    sums[k] = value;
    barrier();
    for (uint reach = 1u; reach < uint(GROUP); reach <<= 1) {
        uint other = k >= reach ? sums[k - reach] : 0u;
        barrier();
        sums[k] += other;
        barrier();
    }
    return sums[k];
}

// The sum over the threads before this one in its group; its block gets the sum of the group.
uint exclusive_sum(uint count, uint first_block) {
    uint sum = inclusive_sum(count);
    if (gl_LocalInvocationIndex == GROUP - 1) blocks(first_block + gl_WorkGroupID.x) = sum;
    return sum - count;
}

dvec3 position(uint v) {
    return dvec3(positions[3u * v], positions[3u * v + 1u], positions[3u * v + 2u]);
}

// The vector from vertex a to b, rounded to single precision after the subtraction.
vec3 between(uint a, uint b) {
    precise dvec3 difference = position(b) - position(a);
    return vec3(difference);
}

float exact_dot(vec3 u, vec3 v) {
    precise float sum = u.x * v.x + u.y * v.y + u.z * v.z;
    return sum;
}

vec3 exact_cross(vec3 u, vec3 v) {
    precise vec3 product = vec3(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x);
    return product;
}

// OpenGL permits errors of two units in the last place for roots and quotients in single precision.
// Roots and quotients in double precision are correct after rounding.
float exact_root(float x) { return float(sqrt(double(x))); }
float exact_length(vec3 v) { return exact_root(exact_dot(v, v)); }

// Normalises a vector; zero stays zero.
vec3 unit(vec3 v) {
    float squared = exact_dot(v, v);
    if (1e-30 < squared && squared < 1e37) {
        precise vec3 scaled = float(1.0LF / double(exact_root(squared))) * v;
        return scaled;
    }
    precise double exact = double(v.x) * double(v.x) + double(v.y) * double(v.y) + double(v.z) * double(v.z);
    double size = sqrt(exact);  // single precision cannot represent the square
    return size == 0.0LF ? vec3(0.0) : vec3(dvec3(v) / size);
}

vec3 weighted_sum(float weight_u, vec3 u, float weight_v, vec3 v) {
    precise vec3 first = weight_u * u, second = weight_v * v, sum = first + second;
    return sum;
}

// Interpolates linearly; exact at the fractions 0 and 1.
vec3 interpolate(vec3 start, vec3 end, float fraction) {
    precise float rest = 1.0 - fraction;
    return fraction == 1.0 ? end : weighted_sum(rest, start, fraction, end);
}

vec3 row_of(uint k, uint first) {
    uint at = columns * k + first;
    return vec3(rows[at], rows[at + 1u], rows[at + 2u]);
}

void write_row(uint k, vec3 position, vec3 normal) {
    for (uint i = 0u; i < 3u; ++i) {
        rows[columns * k + i] = position[i];
        rows[columns * k + 3u + i] = normal[i];
    }
}

uint first_row(uint r) { return first_points(r) + blocks(r / uint(GROUP)); }
uint first_triangle(uint t) { return first_triangles(t) + blocks(attribute_edge_blocks + t / uint(GROUP)); }

#ifdef BLENDED
bool has_centre(uint row) { return (patterns(most_subtriangles * row) & 255u) == uint(CENTRE); }
uint first_centre(uint t) {
    return first_centres(t) + blocks(attribute_edge_blocks + face_blocks + t / uint(GROUP));
}
#endif

// Writes texture coordinates and attributes of a new point, for one side of a seam.
void place_values(uint r, uint row, float at_a, float at_b) {
    for (uint i = 0u; i < value_count; ++i) {
        precise float a = at_a * edge_values(2u * value_count * r + i);
        precise float b = at_b * edge_values(2u * value_count * r + value_count + i);
        precise float mean = a + b;
        rows[columns * row + 6u + i] = mean;
    }
}
