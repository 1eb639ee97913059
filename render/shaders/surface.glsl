// Skin and rigid parts. These defines choose a variant:
// FLAT, GOURAUD or PIXEL: light is computed per triangle, vertex or pixel.
// WIREFRAME: outlines of triangles; adds the geometry stage.
// SPLITS: colour by a number per triangle. SPLIT_WIRES: outlines in this colour.
// COLOURED: vertex colours. TEXTURED: albedo from a texture.
// SHADOWS: shadows in the key light. AROUND: ambient light by nine coefficients.
// BUMPS, FINE: furrows and fine shape of the skin (bumps.glsl); need PIXEL.
// STRANDS: thin strands with three sides, blended by the fraction of a pixel that they cover.
// FIBRES: striation (fibres.glsl).
// TRANSLUCENT: skin that shows parts below it. SUNK: these parts, hidden where skin is opaque.
// LIPS: skin with a mouth, whose inner side is dark behind the lips.
// FADED: skin that fades by vertex. MOUTH: the fading part may overlap the mouth on the screen; needs LIPS.
// TRIANGLES: each triangle has its own surface number.
// FILLED, BEHIND: parts that get light through an opening (opening.glsl).
// FRONT_ONLY: skin of which only front faces are drawn.

#include "lighting.glsl"
#if defined(FRONT_ONLY)
#define IS_FRONT true
#else
#define IS_FRONT gl_FrontFacing
#endif
#if defined(FILLED) || defined(BEHIND) || defined(LIPS)
#include "opening.glsl"
#endif

#if defined(BUMPS) || defined(FINE)
#define RELIEF
#endif

uniform float subsurface;
uniform float gloss;
uniform float sharpness;

#if defined(PIXEL)
#define NORMAL_VARYING vec3 normal;
#define RISE surface.normal.y
#elif defined(FLAT)
#define NORMAL_VARYING flat vec3 to_eye;
#else
#define NORMAL_VARYING
#endif
#if !defined(RISE)
#define RISE 0.0
#endif
#if defined(GOURAUD)
#define LIT_VARYING vec3 key; vec3 rest; vec3 specular; vec3 inner; float facing;
#else
#define LIT_VARYING
#endif
#if defined(COLOURED)
#define COLOUR_VARYING vec3 colour;
#else
#define COLOUR_VARYING
#endif
#if defined(TEXTURED) || defined(RELIEF)
#define HAS_UV
#define TEXTURE_VARYING vec2 uv;
#else
#define TEXTURE_VARYING
#endif
#if defined(BUMPS)
#define BUMP_VARYING vec2 bump_amounts;
#else
#define BUMP_VARYING
#endif
#if defined(RELIEF)
#define RELIEF_VARYING vec3 u_gradient; vec3 v_gradient;
#else
#define RELIEF_VARYING
#endif
#if defined(SHADOWS) && !defined(COLOURED)
#define LIFTED  // for skin only: parts have so small triangles that normals fit them
#define SHADOW_VARYING vec3 light_place; vec3 lift;
#elif defined(SHADOWS)
#define SHADOW_VARYING vec3 light_place;
#else
#define SHADOW_VARYING
#endif
#if defined(STRANDS)
#define STRAND_VARYING vec2 strand;  // radius of the strand, and radius of the drawn prism [pixels]
#else
#define STRAND_VARYING
#endif
#if defined(FIBRES)
#define FIBRE_VARYING vec2 fibre;
#else
#define FIBRE_VARYING
#endif
#if defined(BEHIND)
#define OPENING_VARYING vec3 let_in;
#else
#define OPENING_VARYING
#endif
#if defined(FADED)
#define FADE_VARYING vec2 fade;
#else
#define FADE_VARYING
#endif
#define VARYINGS vec3 position; NORMAL_VARYING LIT_VARYING COLOUR_VARYING TEXTURE_VARYING \
    SHADOW_VARYING BUMP_VARYING RELIEF_VARYING STRAND_VARYING FIBRE_VARYING OPENING_VARYING FADE_VARYING

#if defined(VERTEX_STAGE)

in vec3 in_position;
in vec3 in_normal;
#if defined(COLOURED)
in vec3 in_colour;
#endif
#if defined(HAS_UV)
in vec2 in_uv;
#endif
#if defined(BUMPS)
in vec2 in_bumps;
#endif
#if defined(RELIEF)
in vec3 in_u_gradient;  // gradients of texture coordinates along the surface [1/mm]
in vec3 in_v_gradient;
#endif
#if defined(FADED)
in vec2 in_fade;  // opacity of the skin; a number that is negative where the inner side is hidden
#endif
#if defined(FIBRES)
in vec2 in_fibre;  // across and along the fibres [mm]
#endif
uniform mat4 model_view;
uniform mat4 projection;
#if defined(SHADOWS)
uniform mat4 shadow_matrix;   // from view space to the space of the shadow map
// Shadow look-ups are moved above the surface, so that it does not shadow itself: by a small offset,
// and by the height that a surface with this normal rises within the radius of the look-up.
uniform float shadow_offset;
uniform float shadow_reach;
#endif
#if defined(SUNK)
uniform vec4 cut;  // plane, view space; in front of it the skin is opaque
#include "sunk.glsl"
#endif
#if defined(STRANDS)
uniform float half_strand;  // radius of a strand
uniform float pixel_size;   // size of a pixel at distance 1
#endif
out Surface { VARYINGS } surface;

void main() {
    vec4 position = model_view * vec4(in_position, 1.0);
    vec3 normal = normalize(mat3(model_view) * in_normal);
#if defined(STRANDS)
    // A triangle contains a circle of half its radius, which is the strand and a pixel around it.
    bool is_tip = dot(in_normal, in_normal) == 0.0;
    if (is_tip) normal = vec3(0.0);
    vec3 middle = position.xyz - half_strand * normal;
    float pixel = -pixel_size * position.z, drawn = 2.0 * (half_strand + pixel);
    position.xyz = middle + drawn * normal;
    // On average over all directions, a triangle is 0.83 times as wide as the circle around it.
    surface.strand = vec2(is_tip ? 0.0 : 0.83 * half_strand, drawn) / pixel;
#endif
    surface.position = position.xyz;
#if defined(PIXEL)
    surface.normal = normal;
#elif defined(FLAT)
    surface.to_eye = normalize(-position.xyz);
#elif defined(GOURAUD)
    Lit lit = studio(normal, normalize(-position.xyz), 1.0, subsurface, gloss, sharpness, 1.0);
    surface.key = lit.key;
    surface.rest = lit.rest;
    surface.specular = lit.specular;
    surface.inner = inside(-normal);
    surface.facing = dot(normal, normalize(-position.xyz));
#endif
#if defined(COLOURED)
    surface.colour = in_colour;
#endif
#if defined(BEHIND)
    // Per vertex: parts behind lips have many vertices, of which few are visible at a time.
    surface.let_in = reddened(light_let_in(surface.position, normal));
#endif
#if defined(FADED)
    surface.fade = in_fade;
#endif
#if defined(FIBRES)
    surface.fibre = in_fibre;
#endif
#if defined(HAS_UV)
    surface.uv = in_uv;
#endif
#if defined(BUMPS)
    surface.bump_amounts = in_bumps;
#endif
#if defined(RELIEF)
    surface.u_gradient = mat3(model_view) * in_u_gradient;
    surface.v_gradient = mat3(model_view) * in_v_gradient;
#endif
#if defined(SHADOWS)
    float height = shadow_offset + shadow_reach * length(cross(normal, to_key));
    surface.light_place = (shadow_matrix * vec4(position.xyz + height * normal, 1.0)).xyz;
#endif
#if defined(LIFTED)
    surface.lift = mat3(shadow_matrix) * (height * normal);
#endif
    gl_Position = projection * position;
#if defined(STRANDS)
    vec4 own = projection * vec4(middle, 1.0);  // the depth of the strand's axis
    gl_Position.z = own.z / own.w * gl_Position.w;
#endif
#if defined(SUNK)
    gl_Position.z = sunk_depth(position);
#endif
}

#elif defined(GEOMETRY_STAGE)

// Bærentzen et al. 2006, "Single-pass wireframe rendering": each corner carries its distance in
// pixels to the opposite edge; interpolated without perspective it is exact on the screen.
layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;
in Surface { VARYINGS } corner[];
out Drawn { VARYINGS noperspective vec3 edge_distance; float wire_strength; } drawn;
uniform vec2 viewport_size;
const float FADING_HEIGHT = 7.0;  // [pixels]

void main() {
    vec2 pixel[3];
    bool is_in_front = true;
    for (int i = 0; i < 3; i++) {
        vec4 clip = gl_in[i].gl_Position;
        is_in_front = is_in_front && clip.w > 0.0;
        pixel[i] = 0.5 * viewport_size * clip.xy / clip.w;
    }
    vec2 a = pixel[2] - pixel[1], b = pixel[0] - pixel[2], c = pixel[1] - pixel[0];
    float area = abs(a.x * b.y - a.y * b.x);
    vec3 height = is_in_front
        ? area / max(vec3(length(a), length(b), length(c)), 1e-6)
        : vec3(1e6);
    // Lines fade on triangles that are so small that lines would cover them.
    float strength = clamp(min(min(height.x, height.y), height.z) / FADING_HEIGHT, 0.4, 1.0);
    for (int i = 0; i < 3; i++) {
        drawn.position = corner[i].position;
#if defined(PIXEL)
        drawn.normal = corner[i].normal;
#elif defined(FLAT)
        drawn.to_eye = corner[2].to_eye;
#elif defined(GOURAUD)
        drawn.key = corner[i].key;
        drawn.rest = corner[i].rest;
        drawn.specular = corner[i].specular;
        drawn.inner = corner[i].inner;
        drawn.facing = corner[i].facing;
#endif
#if defined(HAS_UV)
        drawn.uv = corner[i].uv;
#endif
#if defined(BUMPS)
        drawn.bump_amounts = corner[i].bump_amounts;
#endif
#if defined(RELIEF)
        drawn.u_gradient = corner[i].u_gradient;
        drawn.v_gradient = corner[i].v_gradient;
#endif
#if defined(SHADOWS)
        drawn.light_place = corner[i].light_place;
#endif
#if defined(LIFTED)
        drawn.lift = corner[i].lift;
#endif
#if defined(FADED)
        drawn.fade = corner[i].fade;
#endif
        drawn.edge_distance = vec3(0.0);
        drawn.edge_distance[i] = height[i];
        drawn.wire_strength = strength;
        gl_Position = gl_in[i].gl_Position;
        gl_PrimitiveID = gl_PrimitiveIDIn;
        EmitVertex();
    }
    EndPrimitive();
}

#elif defined(FRAGMENT_STAGE)

#if defined(WIREFRAME)
in Drawn { VARYINGS noperspective vec3 edge_distance; float wire_strength; } surface;
uniform float wire_half_width;
uniform vec4 wire_colour;
#else
in Surface { VARYINGS } surface;
#endif
#if defined(COLOURED)
uniform float least_mirrored;  // fraction of the highlight that stays where the part is black
#else
uniform vec3 inner_albedo;
#endif
#if defined(TEXTURED)
uniform sampler2D albedo_texture;
uniform sampler2D around_texture;  // mean lightness of the skin around, and its oil
uniform vec3 lightness_weights;
uniform float redness;    // median ratio of red to green light of the texture
uniform float occlusion;  // strength of the ambient occlusion in the texture's alpha, 0 or 1
#elif !defined(COLOURED)
uniform vec3 albedo;
#endif
#if defined(SPLITS) || defined(SPLIT_WIRES)
uniform usampler2D triangle_values;
uniform vec3 split_palette[6];

// Number of splits of the triangle's edges.
int split_count() {
    ivec2 texel = ivec2(gl_PrimitiveID & 1023, gl_PrimitiveID >> 10);
    return int(texelFetch(triangle_values, texel, 0).r);
}
#endif
#if defined(SHADOWS)
#include "shadowed.glsl"
#endif
#if defined(RELIEF)
#include "bumps.glsl"
#endif
#if defined(FIBRES)
#include "fibres.glsl"
#endif
#if defined(TRANSLUCENT)
uniform float opacity;
uniform vec4 cut;  // plane, view space; in front of it the skin is opaque
uniform float cut_width;
const vec3 FAT = vec3(0.78, 0.50, 0.34);  // linear light
#endif
#include "surface_number.glsl"
layout(location = 0) out vec4 pixel_colour;
layout(location = 1) out vec4 pixel_surface;

const vec3 THIN = vec3(1.06, 0.97, 0.96);  // factor on the albedo of thin skin, where muscle shows

// 1 where all ambient light arrives.
float ambient_occlusion = 1.0;

vec3 front_albedo() {
#if defined(COLOURED)
    vec3 front = surface.colour;
#elif defined(TEXTURED)
    vec4 painted = texture(albedo_texture, surface.uv);
    painted *= painted;  // the texture holds square roots, see texture.py
    vec3 front = painted.rgb;
    ambient_occlusion = mix(1.0, painted.a, occlusion);
#else
    vec3 front = albedo;
#endif
#if defined(SPLITS)
    int value = split_count();
#if defined(TEXTURED)
    const float STRENGTH = 0.8;  // brows and lips still show through the tint
#else
    const float STRENGTH = 1.0;
#endif
    if (value > 0) front = mix(front, split_palette[min(value, 6) - 1], STRENGTH);
#endif
    return front;
}

#if defined(LIPS)
// Whether a point is visible through the open lips: their outline runs clockwise around it on the
// screen. The outline is enlarged, which is safe, because lips hide points beside their opening.
bool is_in_mouth(vec3 place) {
    const float GROWTH = 1.4;
    vec3 middle = vec3(0.0);
    for (int i = 0; i < RIM_POINTS; i++) middle += rim[i] / float(RIM_POINTS);
    if (place.z > middle.z) return false;
    vec2 at = place.xy / place.z;
    int turns = 0;
    vec3 last = mix(middle, rim[RIM_POINTS - 1], GROWTH);
    vec2 from = last.xy / min(last.z, -1e-6);
    for (int i = 0; i < RIM_POINTS; i++) {
        vec3 next = mix(middle, rim[i], GROWTH);
        vec2 to = next.xy / min(next.z, -1e-6);
        if ((from.y > at.y) != (to.y > at.y)) {
            float x = mix(from.x, to.x, (at.y - from.y) / (to.y - from.y));
            if (x > at.x) turns += to.y < from.y ? 1 : -1;
        }
        from = to;
    }
    return turns > 0;
}
#endif

#if !defined(GOURAUD)
// The unit normal toward the viewer, on either side of the surface.
vec3 shading_normal() {
#if defined(FLAT)
    return normalize(cross(dFdx(surface.position), dFdy(surface.position)));
#elif defined(COLOURED)
    return normalize(surface.normal);
#else
    return normalize(IS_FRONT ? surface.normal : -surface.normal);
#endif
}
#endif

void main() {
    vec3 front = front_albedo();
    float solid = 1.0;
#if defined(TEXTURED)
    vec2 skin_around = texture(around_texture, surface.uv).rg;
    float around = skin_around.r, oil = skin_around.g;
#else
    const float oil = 1.0;
#endif
#if defined(FADED)
    solid = smoothstep(0.0, 1.0, surface.fade.x);
    // The inner side of the neck is hidden, else a view from below would show it. A chin that moves
    // down may pull the front of the neck in front of the mouth, where it would leave a hole.
    // Only MOUTH discards, because discarding disables early depth tests.
    bool is_hidden = !IS_FRONT && (solid < 1.0 || surface.fade.y < 0.0);
#if defined(MOUTH)
    bool in_mouth = (is_hidden || solid < 1.0) && is_in_mouth(surface.position);
    if (in_mouth && IS_FRONT) discard;
    if (in_mouth) solid = 1.0;
    is_hidden = is_hidden && !in_mouth;
#endif
    if (is_hidden) solid = 0.0;
#endif
#if defined(GOURAUD)
    Lit lit = Lit(surface.key, surface.rest, surface.specular);
    vec3 inner = surface.inner;
    float facing = abs(surface.facing);
#else
#if defined(FLAT)
    vec3 to_eye = surface.to_eye;  // constant on a triangle
#else
    vec3 to_eye = normalize(-surface.position);
#endif
    vec3 normal = shading_normal();
#if defined(RELIEF)
    Bump bump = bump_at(surface.uv, BUMP_AMOUNTS, IS_FRONT);
    normal = bumped(normal, bump.slope, mat2x3(surface.u_gradient, surface.v_gradient));
#endif
#if defined(FIBRES)
    Strand strand = strand_at(surface.fibre);
    normal = stranded(normal, surface.position, surface.fibre.x, strand.slope);
#endif
#if defined(BUMPS)
    // Amounts are negative where a shut lid stretches its skin, which is then thin and unfolded.
    float stretched = max(-max(surface.bump_amounts.x, surface.bump_amounts.y), 0.0);
    ambient_occlusion = mix(ambient_occlusion, 1.0, stretched);
    front *= mix(vec3(1.0), THIN, stretched);
#endif
    float shade = ambient_occlusion * ambient_occlusion;
    Lit lit = studio(normal, to_eye, shade * shade * shade, subsurface, gloss, sharpness, oil);
    vec3 inner = inside(normal);
    float facing = dot(normal, to_eye);
#endif
#if defined(TEXTURED)
    // Lips are redder than the skin around them, and moist. The threshold, chosen by eye, leaves out
    // red cheeks.
    float excess = front.r / (max(front.g, 1e-3) * redness);
    lit.specular *= 1.0 + 1.8 * clamp(5.0 * excess - 6.0, 0.0, 1.0);
    // Pores and hairs, which are darker than the skin around them, weaken the highlight, and so do
    // hollows. Without this, dark skin would show nothing but a smooth highlight.
    float shown_here = dot(front, lightness_weights);
    float relief = clamp(shown_here / max(around, 1e-3), 0.5, 1.1);
    lit.specular *= relief * relief * relief * mix(0.36, 1.0, sqrt(min(around * 2.2, 1.0))) * ambient_occlusion * oil;
#endif
#if defined(BUMPS)
    front *= 1.0 - bump.depth * FURROW;
#endif
#if defined(FIBRES)
    front *= strand.tone;
#endif
#if defined(SHADOWS)
#if defined(LIFTED)
    float lightness = key_lightness(above_triangle(surface.light_place, surface.lift));
#else
    float lightness = key_lightness(surface.light_place);
#endif
#else
    float lightness = 1.0;
#endif
#if defined(COLOURED)
    // Deep in a mouth, where little light arrives, vertex colours are dark; so highlights are weaker.
    lit.specular *= max(front.r, least_mirrored);
    // Lids and lips are thin, so light of a large lamp reaches around them.
    lightness = mix(0.6, 1.0, lightness);
#endif
    vec3 light = lit_colour(lit, front, lightness, subsurface, ambient_occlusion);
#if defined(FILLED)
    light *= reddened(light_let_in(surface.position));
#elif defined(BEHIND)
    light *= surface.let_in;
#endif
#if defined(COLOURED)
    light *= 0.96;  // less light reaches parts in sockets and mouths
#elif !defined(FRONT_ONLY)
    // Back faces that are nearly edge-on lie on the outline, where front and back have equal depths.
    // They get the light of the front, else dark specks of the inner side would show there.
    float inwardness = IS_FRONT ? 0.0 : clamp(5.0 * facing - 0.75, 0.0, 1.0);
#if defined(LIPS)
    // Inside, cheeks and lips get as little light as the gums beside them.
    if (!IS_FRONT && is_in_mouth(surface.position)) {
        inner *= reddened(light_let_in(surface.position, vec3(0.0)));
        inwardness = 1.0;
    }
#endif
    light = mix(light, inner_albedo * inner, inwardness);
#endif
    vec3 shown = display(light);
#if defined(STRANDS)
    pixel_surface = vec4(0.0);  // transparent, so the number of the surface behind stays
#else
    pixel_surface = surface_and_depth(RISE);
#endif
#if defined(WIREFRAME)
    vec3 edge = surface.edge_distance;
    float nearest = min(min(edge.x, edge.y), edge.z);
    float coverage = clamp(wire_half_width + 0.5 - nearest, 0.0, 1.0);
    vec4 wire = wire_colour;
#if defined(SPLIT_WIRES)
    int split = split_count();
    if (split > 0) wire = vec4(sqrt(split_palette[min(split, 6) - 1]), 1.0);
#endif
    shown = mix(shown, wire.rgb, wire.a * surface.wire_strength * coverage);
#endif
#if defined(STRANDS)
    // The normal is a position in the strand's cross-section, and changes only across the strand.
    // Coverage falls off over a pixel (Gupta, Sproull 1981, "Filtering edges for gray-scale displays").
    vec3 n = surface.normal, by_x = dFdx(n), by_y = dFdy(n), change = by_x * by_x + by_y * by_y;
    vec2 across = change.x > change.y ? vec2(by_x.x, by_y.x) : vec2(by_x.y, by_y.y);
    if (change.z > max(change.x, change.y)) across = vec2(by_x.z, by_y.z);
    float aside = abs(dot(n.xy, across)) * surface.strand.y / max(length(across), 1e-9), wide = surface.strand.x;
    float cover = min(2.0 * wide, 1.0) * clamp(max(wide, 0.5) + 0.5 - aside, 0.0, 1.0);
    pixel_colour = vec4(shown, solid * cover);
#elif defined(TRANSLUCENT)
    // Skin is more opaque where it is seen from the side, so the outline of the face shows.
    float from_cut = dot(cut, vec4(surface.position, 1.0));
    if (!IS_FRONT && from_cut < 0.0) discard;
    float grazing = 1.0 - clamp(facing, 0.0, 1.0);
    float veil = grazing * grazing * min(3.0 * opacity, 1.0);
    float shown_share = from_cut > 0.0 ? 1.0 : mix(opacity, 1.0, veil);
    // Skin near the cut shows fat, as wide as skin is thick.
    if (from_cut > 0.0) shown = mix(display(FAT * (0.35 + 0.65 * light)), shown, smoothstep(0.7, 1.0, from_cut / cut_width));
    pixel_colour = vec4(shown, solid * shown_share);
#else
    pixel_colour = vec4(shown, solid);
#endif
}

#endif
