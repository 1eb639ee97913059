// The inner side of the skin where it faces the eye: what surface.glsl comes to there with shading
// by pixels, and no more than that.

#if defined(VERTEX_STAGE)

in vec3 in_position;
in vec3 in_normal;
uniform mat4 model_view;
uniform mat4 projection;
out vec3 outward;

void main() {
    vec4 position = model_view * vec4(in_position, 1.0);
    outward = normalize(mat3(model_view) * in_normal);
    gl_Position = projection * position;
}

#elif defined(FRAGMENT_STAGE)

#include "lighting.glsl"
in vec3 outward;
uniform vec3 inner_albedo;
out vec4 pixel_colour;

void main() {
    pixel_colour = vec4(display(inner_albedo * inside(-normalize(outward))), 1.0);
}

#endif
