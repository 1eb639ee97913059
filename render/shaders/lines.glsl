// Polylines of constant width in pixels; each segment becomes a quad with soft edges.
// (Wide GL lines do not exist in a forward-compatible core profile.)

#if defined(VERTEX_STAGE)

in vec3 in_position;
in vec3 in_colour;
uniform mat4 world_to_clip;
out vec3 vertex_colour;

void main() {
    vertex_colour = in_colour;
    gl_Position = world_to_clip * vec4(in_position, 1.0);
}

#elif defined(GEOMETRY_STAGE)

layout(lines) in;
layout(triangle_strip, max_vertices = 4) out;
in vec3 vertex_colour[];
uniform vec2 viewport_size;
uniform float half_width;
out vec3 colour;
noperspective out float across;  // [pixels] from the centre line

void main() {
    vec4 from = gl_in[0].gl_Position, to = gl_in[1].gl_Position;
    if (from.w <= 0.0 || to.w <= 0.0) return;
    vec2 along = (to.xy / to.w - from.xy / from.w) * viewport_size;
    float pixels = length(along);
    along = pixels > 1e-6 ? along / pixels : vec2(1.0, 0.0);
    float reach = half_width + 0.5;
    vec2 side = vec2(-along.y, along.x) * reach * 2.0 / viewport_size;
    for (int i = 0; i < 4; i++) {
        float sign = (i & 1) == 0 ? -1.0 : 1.0;
        vec4 end = i < 2 ? from : to;
        colour = vertex_colour[i < 2 ? 0 : 1];
        across = sign * reach;
        gl_Position = end + vec4(sign * side * end.w, 0.0, 0.0);
        EmitVertex();
    }
    EndPrimitive();
}

#elif defined(FRAGMENT_STAGE)

in vec3 colour;
noperspective in float across;
uniform float half_width;
uniform float opacity;
out vec4 pixel_colour;

void main() {
    float coverage = clamp(half_width + 0.5 - abs(across), 0.0, 1.0);
    pixel_colour = vec4(colour, opacity * coverage);
}

#endif
