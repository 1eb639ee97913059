// Light on strands after Kajiya, Kay 1989, "Rendering fur with three dimensional textures". There are
// two highlights, one of them in the hair's colour, as in Scheuermann 2004, "Practical real-time hair
// rendering and shading".

#include "lighting.glsl"

const float TILT = 0.10;  // shifts of both highlights
const float SHARPNESS = 70.0, SOFTNESS = 14.0;  // exponents of the white and the coloured highlight

const float SHEEN_OF_DARK = 0.02;  // part of the coloured highlight that black hair also has

struct HairLight {
    vec3 diffuse;  // diffuse light; multiply by the hair's colour
    vec3 shine;    // light of highlights; multiply by the result of `highlights`
    float cosine;  // between strand and half vector (between the directions to eye and light)
};

// along: direction of strands, tangent to the skin, of any length. lying: 0 for strands that stand up,
// which show only their tips and do not shine, to 1. position: in view space.
HairLight hair_light(vec3 normal, vec3 along, float lying, vec3 position, float gloss) {
    HairLight light;
    // Hair scatters light, so it is also lit a little beyond the terminator.
    float facing = dot(normal, to_key);
    float lit = clamp((facing + 0.3) / 1.3, 0.0, 1.0);
    float rim = max(dot(normal, TO_RIM), 0.0);
    light.diffuse = 0.85 * key_light * lit + fill_light * max(0.8 * dot(normal, to_fill) + 0.2, 0.0)
        + hemisphere(normal) + 0.5 * rim_light * rim * rim;
    light.shine = key_light * (lit * clamp(2.0 * facing, 0.0, 1.0) * gloss * lying);
    light.cosine = dot(along / max(length(along), 1e-6), normalize(to_key + normalize(-position)));
    return light;
}

// The colour of both highlights; one is shifted toward the root, the other toward the tip. shift: random
// shift of the strand. front: colour of the strand.
vec3 highlights(float cosine, float shift, vec3 front) {
    float first = cosine + shift - TILT, second = first + 2.0 * TILT;
    float bright = exp2(-SHARPNESS * first * first), glow = exp2(-SOFTNESS * second * second);
    return bright * (0.06 + 0.4 * front) + 0.3 * glow * (front + SHEEN_OF_DARK);
}
