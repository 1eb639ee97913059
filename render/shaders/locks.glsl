// Locks of hair: ribbons that face the camera, over the layers of shells.glsl. Locks are thin, so light
// is computed per vertex. Coverage falls off over a pixel (Gupta, Sproull 1981, "Filtering edges for
// gray-scale displays").

#include "hair_light.glsl"

#define VARYINGS vec3 shown; float across; float half_width; float opacity;

#if defined(VERTEX_STAGE)

in vec3 in_position;
in vec3 in_normal;    // normal of the skin below
in vec3 in_colour;
in vec3 in_along;     // unit vector from the root to the tip
in float in_half;     // half the lock's width [mm]; the sign is the side of the vertex
in float in_opacity;
uniform mat4 model_view;
uniform mat4 projection;
uniform float gloss;
uniform float pixel_size;  // size of a pixel at distance 1
out Surface { VARYINGS } surface;

const float UNEVEN = 0.5;   // random shift of highlights by lock
const float BEHIND = -0.5;  // z of the normal in view space, below which the head hides locks

void main() {
    vec3 normal = normalize(mat3(model_view) * in_normal), along = mat3(model_view) * in_along;
    vec3 middle = (model_view * vec4(in_position - in_half * cross(in_normal, in_along), 1.0)).xyz;
    float pixel = -pixel_size * middle.z, drawn = abs(in_half) + pixel;
    vec3 aside = cross(along, normalize(middle));
    aside *= sign(in_half) * drawn / max(length(aside), 1e-3);
    vec3 flat_along = along - dot(along, normal) * normal;
    HairLight light = hair_light(normal, flat_along, 1.0, middle, gloss);
    // All vertices of a lock have the same normal, which serves as its random seed.
    float shift = UNEVEN * (fract(dot(in_normal, vec3(157.3, 311.7, 71.9))) - 0.5);
    vec3 shine = light.shine * highlights(light.cosine, shift, in_colour);
    surface.shown = display(in_colour * light.diffuse + shine);
    surface.across = sign(in_half) * drawn / pixel;
    surface.half_width = abs(in_half) / pixel;
    surface.opacity = in_opacity;
    gl_Position = projection * vec4(middle + aside, 1.0);
    if (normal.z < BEHIND) gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
}

#elif defined(FRAGMENT_STAGE)

in Surface { VARYINGS } surface;
layout(location = 0) out vec4 pixel_colour;
layout(location = 1) out vec4 pixel_surface;

void main() {
    float wide = surface.half_width;
    float cover = min(2.0 * wide, 1.0) * clamp(max(wide, 0.5) + 0.5 - abs(surface.across), 0.0, 1.0);
    pixel_surface = vec4(0.0);  // transparent, so the number of the surface behind stays
    pixel_colour = vec4(surface.shown, surface.opacity * cover);
}

#endif
