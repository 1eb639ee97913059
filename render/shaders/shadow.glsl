// Depth only, seen from the key light; SHELLS: of dense hair, seen from the eye.

#if defined(VERTEX_STAGE)

in vec3 in_position;
uniform mat4 to_clip;
#if defined(SHELLS)
#include "shell_layers.glsl"
in vec3 in_way;
uniform int layers;
const float BELOW = 0.9;  // of the way to the lowest layer, which will be drawn above this depth
#endif

void main() {
    vec3 position = in_position;
#if defined(SHELLS)
    position += (BELOW * layer_place(0.0, layers) - MEAN) * in_way;
#endif
    gl_Position = to_clip * vec4(position, 1.0);
}

#elif defined(FRAGMENT_STAGE)

#if defined(SHELLS)
out vec4 pixel_colour;  // blended by nothing

void main() {
    pixel_colour = vec4(0.0);
}
#else
void main() {}
#endif

#endif
