// Hair as shells: one surface is drawn once for each layer, from the skin to the tips of strands. A
// layer shows the strands that reach its height. Slowly changing values are computed per vertex.
// Source: Lengyel, Praun, Finkelstein, Hoppe 2001, "Real-time fur over arbitrary surfaces".

#include "hair_light.glsl"
#include "shell_layers.glsl"

#define VARYINGS vec3 diffuse; vec3 shine; vec3 colour; vec2 strand; float cosine; float layer; float dense; float fray; float facing; float pixel;

uniform int layers;         // number of all layers

#if defined(VERTEX_STAGE)

in vec3 in_position;  // at the fraction MEAN of the longest strands, from the root
in vec3 in_normal;
in vec3 in_colour;
in vec2 in_strand;  // across and along strands [mm]
in vec3 in_way;     // vector from the root to the tip of the longest strand
in float in_dense;  // density, 0 to 1; above 1, uneven strands are whole, too
in float in_fray;   // 0 where outlines are smooth, to 1 where they fray; to -1 for loose hair
uniform mat4 model_view;
uniform mat4 projection;
uniform float gloss;
uniform float pixel_size;  // size of a pixel at distance 1
uniform int first;  // number of the first layer to draw; layers count from the inside out
out Surface { VARYINGS } surface;

void main() {
    float layer = layer_place(float(first + gl_InstanceID), layers);
    vec4 position = model_view * vec4(in_position + (layer - MEAN) * in_way, 1.0);
    vec3 normal = normalize(mat3(model_view) * in_normal), along = mat3(model_view) * in_way;
    along -= dot(along, normal) * normal;  // tangent to the skin, else a bright ring surrounds whorls
    // Strands that stand up show only their tips, which do not shine.
    float lying = smoothstep(0.3, 0.8, length(along) / max(length(mat3(model_view) * in_way), 1e-6));
    HairLight light = hair_light(normal, along, lying, position.xyz, gloss);
    surface.diffuse = light.diffuse;
    surface.shine = light.shine;
    surface.cosine = light.cosine;
    surface.colour = in_colour;
    surface.strand = in_strand;
    surface.layer = layer, surface.dense = in_dense, surface.fray = in_fray;
    surface.facing = -dot(normal, normalize(position.xyz));
    surface.pixel = -pixel_size * position.z;
    gl_Position = projection * position;
}

#elif defined(FRAGMENT_STAGE)

in Surface { VARYINGS } surface;
#include "surface_number.glsl"
layout(location = 0) out vec4 pixel_colour;
layout(location = 1) out vec4 pixel_surface;

const float THIN = 0.5, THICK = 2.2;     // [mm] widths of strands, and of locks
const float LEAN = 0.6;                  // [mm/mm] sideways shift of locks along their strands
const float LONG = 11.0;                 // [mm] along a strand over which its random length changes
const float UNEVEN = 0.45;               // random shift of highlights by strand
const vec2 SIDEWAYS = vec2(0.6, 0.85);   // facing at which single strands begin to show, and show fully
const vec2 RAGGED = vec2(0.4, 0.08);     // random change of density by strand and lock, for uneven hems
const vec2 CRISP = vec2(1.1, 1.6);       // steepness of hems where locks show, and where strands show
const vec2 RAGGED_LOOSE = vec2(0.45, 0.3);  // RAGGED for loose hair, whose locks differ in length
const float CRISP_LOOSE = 3.0;           // CRISP for loose hair, in which each lock ends by itself
const float LEAST_COVER = 0.08;          // cover below which a pixel stays clear
const float LEAST_HIDING = 0.85;         // the same for layers of loose hair that hide what is behind
const float FRAYED = 2.4;                // [mm] from the outline over which strands end
const vec2 UNEVENLY = vec2(2.0, 1.5);    // [mm] random change of this distance by strand and lock
const float FRAYED_PIXELS = 3.0;         // least number of pixels of this distance
const float DARK = 0.45;                 // fraction of light at roots
const float COVERED = 0.7;               // number of layers above a layer that take no light from it
const float SOFT = 0.22;                 // fraction of a strand's length over which its tip fades
const float SHARP = 0.01;                // the same at outlines, where layers end at once

// Random numbers, 0 to 1, for the cells of two grids at once, by a hash without sine.
vec2 chance(vec2 column, vec2 row) {
    vec2 number = fract(column * 0.1031 + row * 0.0973);
    number *= number + 33.33;
    return fract(number * (number + number));
}

// Random heights, 0 to 1, of a strand and a lock with these numbers; they change along the strand.
vec2 reach(vec2 number) {
    vec2 along = surface.strand.y / LONG + 7.0 * chance(number, vec2(0.5)), row = floor(along);
    return mix(chance(number, row), chance(number, row + 1.0), along - row);
}

void main() {
    float facing = abs(surface.facing);
    float slope = length(vec2(dFdx(surface.facing), dFdy(surface.facing)));
    // Strands and locks finer than a pixel fade into their mean.
    vec2 share = clamp(1.5 - 1.25 * fwidth(surface.strand.x) / vec2(THIN, THICK), 0.0, 1.0);
    // Seen from the side, single tips would look like dashed lines.
    float single = smoothstep(SIDEWAYS.x, SIDEWAYS.y, facing);
    float outline = outline_place(layers) + SHARP;
    if (single == 0.0 && surface.layer > outline + SHARP) discard;  // early, to save time
    // Strands of one lock lean alike, and cross those of the next. Heights vary smoothly between them.
    float lock = floor(surface.strand.x / THICK);
    float lean = LEAN * (fract(0.31831 * lock * lock) - 0.5) * surface.strand.y;
    vec2 at = vec2(surface.strand.x + lean, surface.strand.x) / vec2(THIN, THICK);
    vec2 number = floor(at), place = at - number;
    vec2 tones = share * (mix(reach(number), reach(number + 1.0), smoothstep(0.0, 1.0, place)) - 0.5);
    float loose = max(-surface.fray, 0.0);
    // Where loose hair curls inward, a line of sight along it meets only its thin hem.
    float seen = mix(seen_share(facing), 1.0, loose);
    vec2 apart = vec2(0.5, 0.4) * clamp(surface.dense, 0.25, 1.0);  // less at hems, else they have teeth
    float tall = mix(outline, 0.65 + dot(apart, tones), single);
    // Toward hems strands are fewer and shorter; where they are finer than a pixel, hair turns clear.
    vec2 ragged = mix(RAGGED, RAGGED_LOOSE, loose);
    float dense = surface.dense / seen + dot(ragged, tones);
    float crisp = mix(mix(CRISP.x, CRISP.y, share.x), CRISP_LOOSE, loose);
    float there = clamp(crisp * (dense - 0.5) + 0.5, 0.0, 1.0);
    // The first hairs of a hem are sparse from any side, else it has a torn edge seen from the side.
    there *= clamp(4.0 * (surface.dense + dot(ragged, tones)), 0.0, 1.0);
    // Outer layers of loose hair reach as far down as inner ones, and soften their ends.
    float far = tall * smoothstep(0.0, mix(mix(0.5, 1.0, single), 0.3, loose), dense);
    float cover = clamp((far - surface.layer) / mix(SHARP, SOFT, single) + 0.5, 0.0, 1.0) * there;
    // Strands end one by one before the outline of all layers but the lowest.
    if (surface.layer > layer_place(0.5, layers) && surface.fray > 0.0 && facing < SIDEWAYS.x) {
        // At least some pixels wide, else the outline has steps.
        float frayed = surface.fray * max(FRAYED + dot(UNEVENLY, tones), FRAYED_PIXELS * surface.pixel);
        float inside = max(surface.facing, 0.0) * surface.pixel / max(slope, 1e-6);
        cover *= clamp((inside + 0.01) / (frayed + 0.01), 0.0, 1.0);
    }
    // Clear pixels that write depths would hide all hair behind a hem: a bright line.
    bool hides = surface.layer < layer_place(float((layers + 1) / 2) - 0.5, layers);
    if (cover < (hides ? mix(LEAST_COVER, LEAST_HIDING, loose) : LEAST_COVER)) discard;
    float uneven = 0.6 * (tones.x + tones.y);
    // Layers above absorb light; their number is the height of the strand above this layer.
    float above = (far - surface.layer) * float(layers);
    float open = mix(1.0, DARK, smoothstep(COVERED, COVERED + max(1.0, 0.5 * float(layers)), above));
    vec3 front = surface.colour * (1.0 + 1.0 * uneven) * open;
    vec3 shine = surface.shine * open * max(1.0 + 2.0 * uneven, 0.0) * highlights(surface.cosine, UNEVEN * uneven, front);
    // Hair of several layers has no single depth, so the depth is 0.
    pixel_surface = has_edge(surface.dense, surface.facing, surface.fray) ? vec4(surface_number(0.0), 0.0, 0.0, 1.0) : vec4(0.0);
    pixel_colour = vec4(display(front * surface.diffuse + shine), cover);
}

#endif
