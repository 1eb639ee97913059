// The number and the depth of the surface that each sample of a pixel sees, without light.
// SHELLS: the outline of short hair. PIXEL, TRANSLUCENT, SUNK, TRIANGLES: as in surface.glsl.

#if defined(SHELLS)
#include "shell_layers.glsl"
#define VARYINGS float dense; float facing; float fray;
#else
#define VARYINGS float from_cut; float rise;
#endif

#if defined(VERTEX_STAGE)

in vec3 in_position;
in vec3 in_normal;
#if defined(SHELLS)
in vec3 in_way;
in float in_dense;
in float in_fray;
uniform int layers;
#endif
uniform mat4 model_view;
uniform mat4 projection;
#if defined(SUNK) || defined(TRANSLUCENT)
uniform vec4 cut;  // plane, view space
#endif
#if defined(SUNK)
#include "sunk.glsl"
#endif
out Surface { VARYINGS } surface;

void main() {
    vec4 position = model_view * vec4(in_position, 1.0);
#if defined(SHELLS)
    position.xyz += (outline_place(layers) - MEAN) * (mat3(model_view) * in_way);
    surface.dense = in_dense;
    surface.facing = -dot(normalize(mat3(model_view) * in_normal), normalize(position.xyz));
    surface.fray = in_fray;
#else
    surface.rise = 0.0;
    surface.from_cut = 0.0;
#endif
#if defined(PIXEL)
    surface.rise = normalize(mat3(model_view) * in_normal).y;
#endif
#if defined(TRANSLUCENT)
    surface.from_cut = dot(cut, position);
#endif
    gl_Position = projection * position;
#if defined(SUNK)
    gl_Position.z = sunk_depth(position);
#endif
}

#elif defined(FRAGMENT_STAGE)

#include "surface_number.glsl"
in Surface { VARYINGS } surface;
out float sample_number;

void main() {
#if defined(SHELLS)
    if (!has_edge(surface.dense, surface.facing, surface.fray)) discard;
#elif defined(TRANSLUCENT)
    if (!gl_FrontFacing && surface.from_cut < 0.0) discard;
#endif
#if defined(SHELLS)
    sample_number = surface_number(0.0);
#else
    sample_number = surface_number(surface.rise);
#endif
}

#endif
