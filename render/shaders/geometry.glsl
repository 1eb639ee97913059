// The G-buffer, with one sample per pixel. BUMPS, FINE: maps of the skin, as in surface.glsl.

#define SURFACE vec3 normal; float depth; vec2 uv; vec3 position; vec2 bump_amounts; \
    vec3 u_gradient; vec3 v_gradient; float dense;

#if defined(BUMPS) || defined(FINE)
#define RELIEF
#endif

#if defined(VERTEX_STAGE)

in vec3 in_position;
in vec3 in_normal;
in vec2 in_uv;      // for the skin only
#if defined(BUMPS)
in vec2 in_bumps;
#endif
#if defined(RELIEF)
in vec3 in_u_gradient;
in vec3 in_v_gradient;
#endif
in vec3 in_way;     // for shells only
in float in_dense;
uniform mat4 model_view;
uniform mat4 projection;
out Surface { SURFACE } surface;

void main() {
    vec4 position = model_view * vec4(in_position, 1.0);
    surface.normal = mat3(model_view) * in_normal;
    surface.depth = -position.z;
    surface.uv = in_uv;
    surface.position = position.xyz;
#if defined(BUMPS)
    surface.bump_amounts = in_bumps;
#endif
#if defined(RELIEF)
    surface.u_gradient = mat3(model_view) * in_u_gradient;
    surface.v_gradient = mat3(model_view) * in_v_gradient;
#endif
    surface.dense = in_way == vec3(0.0) && in_dense == 0.0 ? 1.0 : in_dense;
    gl_Position = projection * position;
}

#elif defined(FRAGMENT_STAGE)

#if defined(RELIEF)
#include "bumps.glsl"
#endif
in Surface { SURFACE } surface;
uniform float first;  // number of the first triangle of this drawing call, counted from 1
layout(location = 0) out vec4 normal_and_depth;
layout(location = 1) out vec4 number_side_uv;

#include "shell_layers.glsl"

void main() {
    float facing = abs(dot(normalize(surface.normal), normalize(surface.position)));
    if (!is_hair(surface.dense, facing)) discard;
    float side = gl_FrontFacing ? 1.0 : -1.0;
    // Converts OpenGL's view axes to x right, y down, z away from the camera.
    vec3 normal = side * surface.normal / max(length(surface.normal), 1e-20);
#if defined(RELIEF)
    Bump bump = bump_at(surface.uv, BUMP_AMOUNTS, gl_FrontFacing);
    normal = bumped(normal, bump.slope, mat2x3(surface.u_gradient, surface.v_gradient));
#endif
    normal.yz = -normal.yz;
    normal_and_depth = vec4(normal, surface.depth);
    number_side_uv = vec4(first + float(gl_PrimitiveID), side, surface.uv);
}

#endif
