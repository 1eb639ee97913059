// Bump mapping (Blinn 1978) by maps over texture coordinates, which hold slopes along u and v. FINE:
// constant fine shape. BUMPS: normals and albedo of furrows, whose two strengths are interpolated from
// vertices.
// For fine shape, the gradients of u and v are screen-space derivatives: M. Mikkelsen, "Bump mapping
// unparametrized surfaces on the GPU", 2010. Where skin is compressed, these derivatives jump from
// triangle to triangle, which would break furrows into pieces. So furrows take the gradients of u and v
// from vertices.

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
#define GRADIENTS mat2x3(surface.u_gradient, surface.v_gradient)
#else
#define BUMP_AMOUNTS vec2(0.0)
#define GRADIENTS mat2x3(0.0)
#endif

struct Bump {
    vec2 fine_slope;  // slopes of fine shape along u and v
    vec2 slope;       // slopes of furrows along u and v
    float depth;      // depth of the furrow, 0..1
};

vec2 slopes(vec2 texel, float steepest) {
    return (texel * 255.0 - 128.0) * (steepest / 127.0);
}

// Reads the maps; the inner side of a surface has no bumps.
Bump bump_at(vec2 uv, vec2 amounts, bool is_front) {
    Bump bump = Bump(vec2(0.0), vec2(0.0), 0.0);
    float share = is_front ? 1.0 : 0.0;
#if defined(FINE)
    bump.fine_slope = share * fine_strength * slopes(texture(fine_map, uv).rg, fine_slope);
#endif
#if defined(BUMPS)
    vec4 texel = texture(bumps_map, uv);
    float amount = share * bumps_strength * max(mix(amounts.x, amounts.y, texel.a), 0.0);
    bump.slope = amount * slopes(texel.rg, bumps_slope);
    bump.depth = amount * texel.b;
#endif
    return bump;
}

// Tilts `normal`, which points out of the surface; gradients: of u and v along the surface.
vec3 bumped(vec3 normal, vec3 position, vec2 uv, Bump bump, mat2x3 gradients) {
    vec3 along_x = dFdx(position), along_y = dFdy(position);
    float rise_x = dot(bump.fine_slope, dFdx(uv)), rise_y = dot(bump.fine_slope, dFdy(uv));
    vec3 first = cross(along_y, normal), second = cross(normal, along_x);
    float area = dot(along_x, first);
    vec3 gradient = (rise_x * first + rise_y * second) / (abs(area) < 1e-12 ? 1e-12 : area);
    vec3 furrow = gradients * bump.slope;
    gradient += furrow - dot(furrow, normal) * normal;
    return normalize(normal - gradient);
}
