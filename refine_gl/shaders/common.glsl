// Shared by all passes: the buffers, and arithmetic that rounds as that of refine/ does.
//
// Eight storage buffers, as many as OpenGL 4.3 promises; no pass takes more than six. Arrays lie in
// them one behind the other: `faces(k)` is a macro made by tables.py for `mesh[faces_at + (k)]`.
// `precise` forbids fused and reordered sums, so that a sum is the one that the processor makes.

layout(local_size_x = GROUP) in;
layout(std430, binding = 0) readonly buffer Mesh { uint mesh[]; };  // once per mesh
layout(std430, binding = 1) readonly buffer Positions { double positions[]; };  // once per frame
layout(std430, binding = 2) buffer Fields { vec4 fields[]; };  // vectors that passes hand on
layout(std430, binding = 3) buffer Work { uint work[]; };  // numbers that passes hand on
layout(std430, binding = 4) buffer Rows { float rows[]; };  // the output
layout(std430, binding = 5) writeonly buffer Triangles { uint triangles[]; };
layout(std430, binding = 6) writeonly buffer Source { uint source[]; };
layout(std430, binding = 7) buffer Command { uint command[]; };  // how much of it there is

const uint NONE = 0xffffffffu;

// The work of a thread, where it has one of `count`: FOR_EACH(v, vertex_count) { ... }
#define FOR_EACH(k, count) \
    void each(uint k); \
    void main() { if (gl_GlobalInvocationID.x < count) each(gl_GlobalInvocationID.x); } \
    void each(uint k)

shared uint sums[GROUP];

// The sum of the values of this thread and those before it in its group (Hillis and Steele 1986).
uint scanned(uint value) {
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
uint counted_before(uint count, uint first_block) {
    uint sum = scanned(count);
    if (gl_LocalInvocationIndex == GROUP - 1) blocks(first_block + gl_WorkGroupID.x) = sum;
    return sum - count;
}

dvec3 position(uint v) {
    return dvec3(positions[3u * v], positions[3u * v + 1u], positions[3u * v + 2u]);
}

// From vertex a to b, rounded when it has been taken.
vec3 between(uint a, uint b) {
    precise dvec3 way = position(b) - position(a);
    return vec3(way);
}

float dotted(vec3 u, vec3 v) {
    precise float sum = u.x * v.x + u.y * v.y + u.z * v.z;
    return sum;
}

vec3 crossed(vec3 u, vec3 v) {
    precise vec3 product = vec3(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x);
    return product;
}

// OpenGL lets a driver's single square root and quotient be off by two units in the last place;
// those of double precision, rounded, are not.
float root_of(float x) { return float(sqrt(double(x))); }
float length_of(vec3 v) { return root_of(dotted(v, v)); }

// Length one; zero stays zero.
vec3 unit(vec3 v) {
    float squared = dotted(v, v);
    if (1e-30 < squared && squared < 1e37) {
        precise vec3 scaled = float(1.0LF / double(root_of(squared))) * v;
        return scaled;
    }
    precise double exact = double(v.x) * double(v.x) + double(v.y) * double(v.y) + double(v.z) * double(v.z);
    double size = sqrt(exact);  // single precision does not hold the square
    return size == 0.0LF ? vec3(0.0) : vec3(dvec3(v) / size);
}

vec3 weighed(float of_u, vec3 u, float of_v, vec3 v) {
    precise vec3 first = of_u * u, second = of_v * v, both = first + second;
    return both;
}

// A share of the way; to the last bit one of the two at 0 and at 1.
vec3 mixed(vec3 start, vec3 end, float share) {
    precise float rest = 1.0 - share;
    return share == 1.0 ? end : weighed(rest, start, share, end);
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

// Texture coordinates and attributes of a new point, of its own side of a seam.
void place_values(uint r, uint row, float at_a, float at_b) {
    for (uint i = 0u; i < value_count; ++i) {
        precise float a = at_a * edge_values(2u * value_count * r + i);
        precise float b = at_b * edge_values(2u * value_count * r + value_count + i);
        precise float mean = a + b;
        rows[columns * row + 6u + i] = mean;
    }
}
