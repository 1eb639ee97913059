// Short hair: one surface, drawn LAYERS times, from the skin to the tips of its strands; each layer
// shows the strands that are as long. Values that change slowly are computed at corners.
// Source: Lengyel, Praun, Finkelstein, Hoppe 2001, "Real-time fur over arbitrary surfaces"; light
// after Kajiya, Kay 1989, "Rendering fur with three dimensional textures", with two highlights, one
// of the hair's colour, as in Scheuermann 2004, "Practical real-time hair rendering and shading".

#include "lighting.glsl"
#include "shell_layers.glsl"

#define VARYINGS vec3 diffuse; vec3 shine; vec3 colour; vec2 strand; float cosine; float layer; float dense; float facing;

uniform int layers;         // of all

#if defined(VERTEX_STAGE)

in vec3 in_position;  // on the skin, and MEAN of the way to the tips from there
in vec3 in_normal;
in vec3 in_colour;
in vec2 in_strand;  // across and along strands [mm]
in vec3 in_way;     // from their roots to the tips of the longest
in float in_dense;  // how dense they are, 0 to 1; beyond, uneven strands are whole, too
uniform mat4 model_view;
uniform mat4 projection;
uniform float gloss;
uniform int first;  // of the layers that are drawn, from the inside out
out Surface { VARYINGS } surface;

void main() {
    float layer = layer_place(float(first + gl_InstanceID), layers);
    vec4 position = model_view * vec4(in_position + (layer - MEAN) * in_way, 1.0);
    vec3 normal = normalize(mat3(model_view) * in_normal), along = mat3(model_view) * in_way;
    along -= dot(along, normal) * normal;  // as strands lie; by their tips a ring lay around whorls
    // Hair scatters light, so it is lit some way past where it turns away.
    float facing = dot(normal, to_key);
    float lit = clamp((facing + 0.3) / 1.3, 0.0, 1.0);
    float rim = max(dot(normal, TO_RIM), 0.0);
    surface.diffuse = 0.85 * key_light * lit + fill_light * max(0.8 * dot(normal, to_fill) + 0.2, 0.0)
        + hemisphere(normal) + 0.5 * rim_light * rim * rim;
    // Strands that stand up show their tips alone, which do not shine.
    float lying = smoothstep(0.3, 0.8, length(along) / max(length(mat3(model_view) * in_way), 1e-6));
    surface.shine = key_light * (lit * clamp(2.0 * facing, 0.0, 1.0) * gloss * lying);
    surface.colour = in_colour;
    surface.strand = in_strand;
    surface.layer = layer, surface.dense = in_dense;
    // Of the strands to the middle between eye and light.
    surface.cosine = dot(along / max(length(along), 1e-6), normalize(to_key + normalize(-position.xyz)));
    surface.facing = abs(dot(normal, normalize(position.xyz)));
    gl_Position = projection * position;
}

#elif defined(FRAGMENT_STAGE)

in Surface { VARYINGS } surface;
#include "surface_number.glsl"
layout(location = 0) out vec4 pixel_colour;
layout(location = 1) out vec4 pixel_surface;

const float THIN = 0.5, THICK = 2.2;     // [mm] widths of strands, and of locks of them
const float LEAN = 0.6;                  // [mm] for each one along them, between strands of locks
const float LONG = 11.0;                 // [mm] after which a strand is another one
const float TILT = 0.10, UNEVEN = 0.45;  // of the two highlights from each other, and by strands
const float SHARPNESS = 70.0, SOFTNESS = 14.0;
const vec2 SIDEWAYS = vec2(0.6, 0.85);   // facing, from which on single strands are seen
const vec2 RAGGED = vec2(0.4, 0.08);     // of density, by strands: so hems are no lines
const vec2 CRISP = vec2(1.1, 1.6);       // how abruptly hems end: where locks are seen, and single strands
const float DARK = 0.45;                 // of the light, at roots
const float COVERED = 0.7;               // layers above one, from which on it gets less light
const float SOFT = 0.22;                 // of the strands' way, over which their tips fade
const float SHARP = 0.01;                // that of outlines: layers are there or not, and no veil

// A number for each place of a grid, 0 to 1, by a hash without sine; two grids at once.
vec2 chance(vec2 column, vec2 row) {
    vec2 number = fract(column * 0.1031 + row * 0.0973);
    number *= number + 33.33;
    return fract(number * (number + number));
}

// How far the strand, and the lock of them, of a number reaches: it changes along it.
vec2 reach(vec2 number) {
    vec2 along = surface.strand.y / LONG + 7.0 * chance(number, vec2(0.5)), row = floor(along);
    return mix(chance(number, row), chance(number, row + 1.0), along - row);
}

void main() {
    // Strands that are finer than a pixel fade into their mean.
    vec2 share = clamp(1.5 - fwidth(surface.strand.x) / vec2(THIN, THICK), 0.0, 1.0);
    // Of the tips a look from the side sees lines with gaps.
    float single = smoothstep(SIDEWAYS.x, SIDEWAYS.y, surface.facing);
    float outline = outline_place(layers) + SHARP;
    if (single == 0.0 && surface.layer > outline + SHARP) discard;  // at once: it takes less time
    // Strands of a lock lean alike, over those beside it. They are smooth between neighbours.
    float lock = floor(surface.strand.x / THICK);
    float lean = LEAN * (fract(0.31831 * lock * lock) - 0.5) * surface.strand.y;
    vec2 at = vec2(surface.strand.x + lean, surface.strand.x) / vec2(THIN, THICK);
    vec2 number = floor(at), place = at - number;
    vec2 tones = share * (mix(reach(number), reach(number + 1.0), smoothstep(0.0, 1.0, place)) - 0.5);
    float seen = seen_share(surface.facing);
    vec2 apart = vec2(0.5, 0.4) * clamp(surface.dense, 0.25, 1.0);  // where hems begin no teeth
    float tall = mix(outline, 0.65 + dot(apart, tones), single);
    // Toward hems there are fewer strands, and shorter ones; where they are finer than a pixel, a veil.
    float dense = surface.dense / seen + dot(RAGGED, tones);
    float there = clamp(mix(CRISP.x, CRISP.y, share.x) * (dense - 0.5) + 0.5, 0.0, 1.0);
    float far = tall * smoothstep(0.0, mix(0.5, 1.0, single), dense);
    float cover = clamp((far - surface.layer) / mix(SHARP, SOFT, single) + 0.5, 0.0, 1.0) * there;
    if (cover < 0.08) discard;
    float uneven = 0.6 * (tones.x + tones.y);
    // Tilted toward the root and toward the tip.
    float first = surface.cosine + UNEVEN * uneven - TILT, second = first + 2.0 * TILT;
    float bright = exp2(-SHARPNESS * first * first), glow = exp2(-SOFTNESS * second * second);
    // Light gets lost below other layers, of which there are as many as the strands are tall.
    float above = (far - surface.layer) * float(layers);
    float open = mix(1.0, DARK, smoothstep(COVERED, COVERED + max(1.0, 0.5 * float(layers)), above));
    vec3 front = surface.colour * (1.0 + 1.0 * uneven) * open;
    vec3 shine = surface.shine * open * max(1.0 + 2.0 * uneven, 0.0) * (bright * (0.06 + 0.4 * front) + 0.3 * glow * front);
    // Of no depth: it is none, but several layers.
    pixel_surface = has_edge(surface.dense, surface.facing) ? vec4(surface_number(0.0), 0.0, 0.0, 1.0) : vec4(0.0);
    pixel_colour = vec4(display(front * surface.diffuse + shine), cover);
}

#endif
