// A colour with an opacity for each vertex, over the front sides of triangles.

#if defined(VERTEX_STAGE)

in vec3 in_position;
in float in_opacity;
uniform mat4 world_to_clip;
out float vertex_opacity;

void main() {
    vertex_opacity = in_opacity;
    gl_Position = world_to_clip * vec4(in_position, 1.0);
}

#elif defined(FRAGMENT_STAGE)

in float vertex_opacity;
uniform vec3 colour;
out vec4 pixel_colour;

void main() {
    if (!gl_FrontFacing) discard;
    pixel_colour = vec4(colour, vertex_opacity);
}

#endif
