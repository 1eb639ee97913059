// Bump mapping (Blinn 1978) by maps over texture coordinates, which hold slopes along u and v. FINE:
// constant fine shape. BUMPS: normals and albedo of furrows, whose two strengths are interpolated from
// vertices.
// The gradients of u and v are interpolated from vertices, too. Screen-space derivatives (M. Mikkelsen,
// "Bump mapping unparametrized surfaces on the GPU", 2010) jump from triangle to triangle, which would
// break furrows into pieces, and draw lines along edges.

#if defined(FINE)
uniform sampler2D fine_map;  // slopes along u and v
uniform float fine_slope;    // slope that the byte 255 means
uniform float fine_strength;
#endif
#if defined(BUMPS)
uniform sampler2D bumps_map;   // slopes along u and v, depth of the furrow, blend of both strengths
uniform float bumps_slope;
uniform float bumps_strength;
const vec3 FURROW = vec3(0.40, 0.50, 0.52);  // light that the deepest furrow loses; the rest is reddish
#define BUMP_AMOUNTS surface.bump_amounts
#else
#define BUMP_AMOUNTS vec2(0.0)
#endif

struct Bump {
    vec2 slope;   // slopes along u and v
    float depth;  // depth of the furrow, 0..1
};

vec2 slopes(vec2 texel, float steepest) {
    return (texel * 255.0 - 128.0) * (steepest / 127.0);
}

// Reads the maps; the inner side of a surface has no bumps.
Bump bump_at(vec2 uv, vec2 amounts, bool is_front) {
    Bump bump = Bump(vec2(0.0), 0.0);
    float share = is_front ? 1.0 : 0.0;
#if defined(FINE)
    bump.slope = share * fine_strength * slopes(texture(fine_map, uv).rg, fine_slope);
#endif
#if defined(BUMPS)
    vec4 texel = texture(bumps_map, uv);
    float amount = share * bumps_strength * max(mix(amounts.x, amounts.y, texel.a), 0.0);
    bump.slope += amount * slopes(texel.rg, bumps_slope);
    bump.depth = amount * texel.b;
#endif
    return bump;
}

// Tilts `normal`, which points out of the surface; gradients: of u and v along the surface.
vec3 bumped(vec3 normal, vec2 slope, mat2x3 gradients) {
    vec3 gradient = gradients * slope;
    return normalize(normal - gradient + dot(gradient, normal) * normal);
}
