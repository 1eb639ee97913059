// Depths only: of all surfaces, seen from the key light; with SHELLS of dense hair, seen from the camera.

#if defined(VERTEX_STAGE)

in vec3 in_position;
uniform mat4 to_clip;
#if defined(SHELLS)
#include "shell_layers.glsl"
in vec3 in_way;
uniform int layers;
const float BELOW = 0.9;  // fraction of the lowest layer's height, so that this layer is not hidden
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
out vec4 pixel_colour;  // ignored by the blend function

void main() {
    pixel_colour = vec4(0.0);
}
#else
void main() {}
#endif

#endif
