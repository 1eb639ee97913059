// Cards of strands, as hair is drawn: striped along them, with highlights across. SHADOWS: of the
// key. What changes slowly over a card is worked out at its corners: a picture of long hair is
// mostly cards.
// Source: Kajiya, Kay 1989, "Rendering fur with three dimensional textures"; two highlights, one of
// the hair's colour, as in Scheuermann 2004, "Practical real-time hair rendering and shading".

#include "lighting.glsl"

#define VARYINGS vec3 diffuse; vec3 shine; vec3 colour; vec2 strand; float cosine;

#if defined(VERTEX_STAGE)

in vec3 in_position;
in vec3 in_normal;
in vec3 in_colour;
in vec2 in_strand;  // across and along strands [mm]
in vec3 in_along;   // the way they run
uniform mat4 model_view;
uniform mat4 projection;
uniform float gloss;
#if defined(SHADOWS)
#include "shadowed.glsl"
uniform mat4 shadow_matrix;
uniform float shadow_offset;
uniform float shadow_reach;
#endif
out Surface { VARYINGS } surface;

void main() {
    vec4 position = model_view * vec4(in_position, 1.0);
    vec3 normal = normalize(mat3(model_view) * in_normal), along = mat3(model_view) * in_along;
    float lightness = 1.0;
#if defined(SHADOWS)
    // Toward the light, not off the card: what is as far over it shades it, its neighbours do not.
    vec3 above = position.xyz + (shadow_offset + shadow_reach) * to_key;
    lightness = key_lightness((shadow_matrix * vec4(above, 1.0)).xyz);
#endif
    // Hair scatters light, so it is lit some way past where it turns away.
    float facing = dot(normal, to_key);
    float lit = clamp((facing + 0.3) / 1.3, 0.0, 1.0) * mix(0.5, 1.0, lightness);
    float rim = max(dot(normal, TO_RIM), 0.0);
    surface.diffuse = 0.85 * key_light * lit + fill_light * max(0.8 * dot(normal, to_fill) + 0.2, 0.0)
        + hemisphere(normal) + 0.5 * rim_light * rim * rim;
    surface.shine = key_light * (lit * clamp(2.0 * facing, 0.0, 1.0) * lightness * gloss);
    surface.colour = in_colour;
    surface.strand = in_strand;
    // Of the strands to the middle between eye and light.
    surface.cosine = dot(along, normalize(to_key + normalize(-position.xyz)));
    gl_Position = projection * position;
}

#elif defined(FRAGMENT_STAGE)

in Surface { VARYINGS } surface;
out vec4 pixel_colour;

const float THIN = 0.4, THICK = 1.2;     // [mm] widths of strands
const float TILT = 0.10, UNEVEN = 0.22;  // of the two highlights from each other, and by strands
const float SHARPNESS = 70.0, SOFTNESS = 14.0;

// A number for each strand, 0 to 1, by a hash without sine.
vec2 chance(vec2 number) {
    number = fract(number * 0.1031);
    number *= number + 33.33;
    return fract(number * (number + number));
}

void main() {
    // Tones of strands, which change along them; those finer than a pixel fade into their mean.
    vec2 at = surface.strand.x / vec2(THIN, THICK), cell = floor(at), place = at - cell;
    vec2 own = chance(cell + 0.5), next = chance(cell + 1.5);
    vec2 tones = mix(own, next, place * place * (3.0 - 2.0 * place)) - 0.5;
    vec2 share = clamp(1.5 - fwidth(surface.strand.x) / vec2(THIN, THICK), 0.0, 1.0);
    float drift = 0.75 + 0.5 * abs(2.0 * fract(surface.strand.y * 0.021 + own.y) - 1.0);
    float uneven = drift * dot(tones, share);
    // Tilted toward the root and toward the tip.
    float cosine = surface.cosine + UNEVEN * uneven;
    float first = cosine - TILT, second = cosine + TILT;
    float bright = exp2(-SHARPNESS * first * first), glow = exp2(-SOFTNESS * second * second);
    vec3 front = surface.colour * (1.0 + 0.4 * uneven);
    vec3 shine = surface.shine * (bright * (0.06 + 0.4 * front) + 0.3 * glow * front);
    pixel_colour = vec4(display(front * surface.diffuse + shine), 1.0);
}

#endif
