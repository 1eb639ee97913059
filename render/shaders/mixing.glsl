// Smooths the edges of a picture whose pixels were shaded once, by samples with known surfaces
// (coverage.glsl). FIND only finds edge pixels, which lie beside another surface, and marks them in
// the depth buffer; so the mixing pass skips all other pixels on software OpenGL.
//
// A sample that sees the surface of its pixel takes the colour of this pixel. Any other sample takes
// the colour of the neighbour whose surface fits best. SAMPLES: number of samples per pixel.

#if defined(VERTEX_STAGE)

void main() {
    gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);
}

#elif defined(FRAGMENT_STAGE)

uniform sampler2D surfaces;  // surface numbers and depths of pixels, see surface_number.glsl
uniform vec2 tolerance;      // of depths on one surface: value at depth 0, and slope over depth
uniform ivec4 area;          // left, bottom, right and top pixel that may be read
out vec4 pixel_colour;

// The tolerance at a depth, always below the misfit of two surface numbers.
float allowed_at(float depth) {
    return min(tolerance.x + tolerance.y * depth, 0.5);
}

// Number and depth of the surface of a pixel.
vec2 surface_at(ivec2 at) {
    vec3 stored = texelFetch(surfaces, clamp(at, area.xy, area.zw), 0).rgb;
    return vec2(stored.r, stored.g + stored.b / 255.0);
}

// 0 if two numbers belong to one surface, else 1. Numbers from 190 belong to skin, and vary slowly.
vec4 differ(vec4 first, float second) {
    vec4 allowed = mix(vec4(0.5), vec4(12.5), step(190.0 / 255.0, min(first, second))) / 255.0;
    return step(allowed, abs(first - second));
}

#if defined(FIND)

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), x = ivec2(1, 0), y = ivec2(0, 1);
    vec2 here = surface_at(at);
    vec2 left = surface_at(at - x), right = surface_at(at + x);
    vec2 below = surface_at(at - y), above = surface_at(at + y);
    vec4 others = differ(vec4(left.x, right.x, below.x, above.x), here.x);
    vec2 bends = abs(vec2(left.y + right.y, below.y + above.y) - 2.0 * here.y);
    float allowed = allowed_at(here.y);
    bool is_one = max(max(others.x, others.y), max(others.z, others.w)) == 0.0;
    if (is_one && max(bends.x, bends.y) <= allowed) discard;
    pixel_colour = vec4(0.0);
}

#else

uniform sampler2D colours;
uniform sampler2DMS sample_numbers;
uniform sampler2DMS sample_depths;
uniform vec2 depth_range;  // as in surface_number.glsl
const ivec2 WAYS[5] = ivec2[](ivec2(0, 0), ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));

// How badly two samples fit to one surface: the difference of depths, plus 1 if the numbers differ.
float misfit(vec2 first, vec2 second) {
    return abs(first.y - second.y) + differ(vec4(first.x), second.x).x;
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec2 known[5];
    vec4 shown[5];
    for (int k = 0; k < 5; k++) {
        known[k] = surface_at(at + WAYS[k]);
        shown[k] = texelFetch(colours, clamp(at + WAYS[k], area.xy, area.zw), 0);
    }
    float allowed = allowed_at(known[0].y);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < SAMPLES; i++) {
        float depth = (texelFetch(sample_depths, at, i).r - depth_range.x) * depth_range.y;
        vec2 seen = vec2(texelFetch(sample_numbers, at, i).r, clamp(depth, 0.0, 1.0));
        float least = misfit(known[0], seen);
        if (least <= allowed) least = 0.0;
        vec4 colour = shown[0];
        for (int k = 1; k < 5; k++) {
            float off = misfit(known[k], seen);
            if (off < least) {
                least = off;
                colour = shown[k];
            }
        }
        sum += colour;
    }
    pixel_colour = sum / float(SAMPLES);
}

#endif
#endif
